#pragma once
// A second thread that gets its work within a microsecond. It spins between jobs, so it keeps a
// core busy as long as it lives.

#include <thread>

#include <nendo/base/job_offer.hpp>
#include <nendo/base/relax.hpp>

namespace nendo::deform {

class SpinWorker {
public:
  struct Job {
    void (*function)(void* context) noexcept = nullptr;
    void* context = nullptr;
  };

  SpinWorker() : thread_([this] { work(); }) {}
  ~SpinWorker() {
    offer_.offer({});
    thread_.join(); // the thread takes this last job as soon as it runs
  }
  SpinWorker(const SpinWorker&) = delete;
  SpinWorker& operator=(const SpinWorker&) = delete;

  /// Offers the job to the other thread. Wait-free. Call end() before the next run().
  void run(const Job& job) noexcept { offer_.offer(job); }
  /// Withdraws the job if the other thread, which may have no core, has not begun it. Otherwise
  /// spins until the job is done.
  void end() noexcept {
    if (offer_.withdraw()) return;
    while (!offer_.is_done())
      relax();
  }

private:
  void work() noexcept {
    for (Job job;;) {
      // If fewer cores are free than there are threads, this thread must leave its core to one that
      // has work.
      for (int turn = 0; !offer_.take(job); ++turn) {
        relax();
        if (turn % patience == patience - 1) std::this_thread::yield();
      }
      if (job.function == nullptr) return;
      job.function(job.context);
      offer_.done();
    }
  }

  static constexpr int patience = 4096;

  JobOffer<Job> offer_;
  std::thread thread_;
};

} // namespace nendo::deform
