#pragma once
// Waiting for what another thread or program does, no longer than it takes.

#include <chrono>
#include <thread>

namespace nendo::test {

/// Looks every millisecond; its patience is that of a busy machine, and costs only a test that
/// fails.
template <class Condition>
bool eventually(Condition&& condition) {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + std::chrono::seconds(30); Clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return condition();
}

} // namespace nendo::test
