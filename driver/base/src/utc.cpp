#include <nendo/base/utc.hpp>

#include <chrono>

namespace nendo {

std::int64_t utc_ns(HostTime time) noexcept {
  using std::chrono::nanoseconds;
  using SystemClock = std::chrono::system_clock;
  HostClock::duration min_passed = HostClock::duration::max();
  nanoseconds utc{};
  for (int attempt = 0; attempt < 3; ++attempt) {
    const HostTime before = HostClock::now();
    const auto now = SystemClock::now().time_since_epoch();
    const HostClock::duration passed = HostClock::now() - before;
    if (passed >= min_passed) continue;
    min_passed = passed;
    utc = now + (time - (before + passed / 2));
  }
  return utc.count();
}

} // namespace nendo
