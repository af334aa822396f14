#pragma once
// Waits for what another thread or program does, no longer than it takes.

#include <chrono>
#include <thread>

namespace nendo::test {

/// Returns true as soon as the condition is true, which it checks every millisecond. The time limit
/// suits a busy machine; only a test that fails waits so long.
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
