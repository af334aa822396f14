#pragma once
// The rate at which a count increases.

#include <cstdint>
#include <deque>

#include <nendo/base/units.hpp>

namespace nendo::gloves {

/// The rate over the last second or two in which the count increased.
class CountRate {
public:
  /// Takes the count, and the time of the latest event that it counts. If this time steps back, the
  /// rate begins again.
  void add(std::uint64_t count, HostTime latest);
  /// Returns 0 until there are events of two times.
  double per_s() const noexcept;

private:
  struct Point {
    std::uint64_t count = 0;
    HostTime time{};
  };
  std::deque<Point> points_; ///< in order of time; at most two are older than a second
};

} // namespace nendo::gloves
