#include "support/parked.hpp"

#include <cassert>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>
#include <pthread.h>
#include <utility>

namespace nendo::test {
namespace {

constexpr int park_signal = SIGUSR1;

// Lock-free, so that a signal handler may touch them.
std::atomic<bool> wanted{false};
std::atomic<bool> parked{false};
static_assert(std::atomic<bool>::is_always_lock_free);

/// Sleeps, because the other thread may need this core; nanosleep() is one of the few calls that a
/// handler may make.
void stand_still(int) {
  const int interrupted = errno;
  const timespec moment{0, 10'000};
  parked = true;
  while (wanted)
    nanosleep(&moment, nullptr);
  parked = false;
  errno = interrupted;
}

/// Sleeps between looks: on a busy machine one who only yields waits for everybody else's turn.
template <class Condition>
void wait_until(const Condition& holds) {
  while (!holds())
    std::this_thread::sleep_for(std::chrono::microseconds(20));
}

} // namespace

ParkedPeer::ParkedPeer(std::function<void()> work) {
  struct sigaction action{};
  action.sa_handler = stand_still;
  [[maybe_unused]] const int failed = sigaction(park_signal, &action, nullptr);
  assert(failed == 0);
  thread_ = std::thread([this, work = std::move(work)] {
    while (!done_) {
      work();
      rounds_.fetch_add(1, std::memory_order_relaxed);
    }
  });
}

ParkedPeer::~ParkedPeer() {
  done_ = true;
  thread_.join();
}

void ParkedPeer::park() {
  const unsigned before = rounds_;
  wait_until([&] { return rounds_ != before; });
  wanted = true;
  pthread_kill(thread_.native_handle(), park_signal);
  wait_until([] { return parked.load(); });
}

void ParkedPeer::resume() {
  wanted = false;
  wait_until([] { return !parked; });
}

} // namespace nendo::test
