#pragma once
// A second thread that is handed its work within a microsecond: it spins between jobs, and keeps a
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
    thread_.join(); // which takes this last job, whenever it comes to run
  }
  SpinWorker(const SpinWorker&) = delete;
  SpinWorker& operator=(const SpinWorker&) = delete;

  /// Offers the job to the other thread. Wait-free; end() must come before the next one.
  void run(const Job& job) noexcept { offer_.offer(job); }
  /// Withdraws the job if the other thread has not begun it (it may not be on a core), otherwise
  /// spins until it is done.
  void end() noexcept {
    if (offer_.withdraw()) return;
    while (!offer_.is_done())
      relax();
  }

private:
  void work() noexcept {
    for (Job job;;) {
      // On a machine with fewer free cores than threads, whoever has work must get one.
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
