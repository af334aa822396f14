#include "gloves/count_rate.hpp"

#include <algorithm>
#include <chrono>

namespace nendo::gloves {

void CountRate::add(std::uint64_t count, HostTime latest) {
  if (!points_.empty() && latest < points_.back().time) points_.clear();
  if (!points_.empty() && latest == points_.back().time) {
    points_.back().count = std::max(points_.back().count, count);
    return;
  }
  points_.push_back({count, latest});
  while (points_.size() > 2 && points_[1].time + std::chrono::seconds(1) <= latest)
    points_.pop_front();
}

double CountRate::per_s() const noexcept {
  if (points_.size() < 2) return 0.0;
  const Point& first = points_.front();
  const Point& last = points_.back();
  return static_cast<double>(last.count - first.count) / seconds_between(first.time, last.time);
}

} // namespace nendo::gloves
