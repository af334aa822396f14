#pragma once
// A second thread that is handed its work within a microsecond: it spins between jobs, and keeps a
// core busy as long as it lives.

#include <atomic>
#include <thread>

#include <nendo/base/relax.hpp>

namespace nendo::deform {

class SpinWorker {
public:
  using Job = void (*)(void* context) noexcept;

  SpinWorker() : thread_([this] { work(); }) {}
  ~SpinWorker() {
    run(nullptr, nullptr);
    thread_.join(); // which takes this last job, whenever it comes to run
  }
  SpinWorker(const SpinWorker&) = delete;
  SpinWorker& operator=(const SpinWorker&) = delete;

  /// Offers the job to the other thread. Wait-free; end() must come before the next one.
  void run(Job job, void* context) noexcept {
    job_ = job;
    context_ = context;
    state_.store(State::given, std::memory_order_release);
  }
  /// Withdraws the job if the other thread has not begun it (it may not be on a core), otherwise
  /// spins until it is done.
  void end() noexcept {
    State expected = State::given;
    if (state_.compare_exchange_strong(expected, State::idle, std::memory_order_acq_rel)) return;
    while (state_.load(std::memory_order_acquire) != State::idle)
      relax();
  }

private:
  enum class State { idle, given, taken };

  bool take() noexcept {
    State expected = State::given;
    return state_.load(std::memory_order_relaxed) == State::given &&
           state_.compare_exchange_strong(expected, State::taken, std::memory_order_acq_rel);
  }

  void work() noexcept {
    for (;;) {
      // On a machine with fewer free cores than threads, whoever has work must get one.
      for (int turn = 0; !take(); ++turn) {
        relax();
        if (turn % patience == patience - 1) std::this_thread::yield();
      }
      if (job_ == nullptr) return;
      job_(context_);
      state_.store(State::idle, std::memory_order_release);
    }
  }

  static constexpr int patience = 4096;

  alignas(128) std::atomic<State> state_{State::idle};
  Job job_ = nullptr;
  void* context_ = nullptr;
  std::thread thread_;
};

} // namespace nendo::deform
