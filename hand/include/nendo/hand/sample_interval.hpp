#pragma once
// The time between a glove's samples, for what moves a little with each of them.

#include <algorithm>

#include <nendo/driver/sample.hpp>

namespace nendo::hand {

class SampleInterval {
public:
  /// A pause is no time in which anything moves: it would jump.
  static constexpr double longest_s = 0.1;

  /// Takes the next sample in time, and returns the seconds since the previous one, at most
  /// `longest_s`; 0 of the first. Wait-free, no allocation.
  double push(const GloveSample& sample) noexcept {
    const HostTime time = sample.time();
    const double interval_s =
        begun_ ? std::clamp(seconds_between(last_, time), 0.0, longest_s) : 0.0;
    last_ = time;
    begun_ = true;
    return interval_s;
  }

private:
  HostTime last_{};
  bool begun_ = false; ///< last_ is one
};

} // namespace nendo::hand
