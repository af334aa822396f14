#pragma once
// Waiting for what another thread does, no longer than it takes.

#include <chrono>
#include <thread>

namespace nendo::test {

/// Looks every millisecond.
template <class Condition>
bool within(std::chrono::milliseconds time, Condition&& condition) {
  using Clock = std::chrono::steady_clock;
  for (const auto end = Clock::now() + time; Clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return condition();
}

} // namespace nendo::test
