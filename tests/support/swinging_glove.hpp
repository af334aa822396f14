#pragma once
// A glove all of whose sensors read the same, and go to and fro.

#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <nendo/driver/sample.hpp>

namespace nendo::test {

inline constexpr HostClock::duration swinging_period = std::chrono::nanoseconds(11'111'111);

inline GloveSample swinging_sample(HostTime now, double count) {
  GloveSample sample;
  sample.present = sensors_22;
  sample.has_device_time = true;
  sample.measured = sample.arrival = now;
  sample.raw.fill(RawCount{static_cast<std::uint16_t>(std::lround(count))});
  return sample;
}

/// Calls push(count) for each sample of so many swings between two counts, of 90 samples each.
template <class Push>
void swing_between(double low, double high, int times, Push&& push) {
  for (int n = 0; n < 90 * times; ++n)
    push(low + (high - low) * (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * n / 90.0)));
}

} // namespace nendo::test
