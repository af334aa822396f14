#include "stream/device_clock.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::driver {
namespace {

using std::chrono::duration_cast;
using std::chrono::nanoseconds;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t block_length = second;
constexpr std::int64_t window = 64 * second;
constexpr std::int64_t new_clock = 10 * second; ///< longer than any stall that buffers survive
/// Below it, what is left of the delay in the minima would pass for drift.
constexpr std::int64_t min_baseline = 4 * second;
constexpr double max_slope = 500e-6; ///< no quartz or resonator is as wrong
constexpr std::int64_t absurd = std::int64_t{1} << 61U;

} // namespace

nanoseconds TickUnwrapper::unwrap(std::uint32_t ticks) noexcept {
  total_ticks_ += static_cast<std::uint32_t>(ticks - static_cast<std::uint32_t>(total_ticks_));
  return nanoseconds(
      static_cast<std::int64_t>(total_ticks_ / 9 * 78125 + total_ticks_ % 9 * 78125 / 9));
}

HostTime DeviceClock::to_host(nanoseconds device_time, HostTime arrival) noexcept {
  const Nanoseconds device = device_time.count();
  const Nanoseconds host = duration_cast<nanoseconds>(arrival.time_since_epoch()).count();
  if (std::max(device, host) > absurd || std::min(device, host) < -absurd) return arrival;

  const Point point{device, host - device};
  if (count_ > 0) {
    const double late = static_cast<double>(point.offset - base_.offset) - line_at(device);
    if (device < last_device_ || std::abs(late) > static_cast<double>(new_clock)) reset();
  }
  add(point);
  last_device_ = device;
  Nanoseconds result =
      device + base_.offset + static_cast<Nanoseconds>(std::floor(line_at(device)));
  result = std::min(std::max(result, last_result_), host);
  last_result_ = result;
  return HostTime(duration_cast<HostClock::duration>(nanoseconds(result)));
}

void DeviceClock::reset() noexcept {
  const Nanoseconds last_result = last_result_;
  *this = {};
  last_result_ = last_result; // the host's time continues
}

/// Relative to base_.offset.
double DeviceClock::line_at(Nanoseconds device) const noexcept {
  return intercept_ + slope_ * static_cast<double>(device - base_.device);
}

void DeviceClock::add(const Point& point) noexcept {
  const bool begins = count_ == 0 || point.device - block_begin_ >= block_length;
  if (begins) {
    while (count_ > 0 && (count_ == max_blocks || point.device - block(0).device > window)) {
      oldest_ = (oldest_ + 1) % max_blocks;
      --count_;
    }
    blocks_[(oldest_ + count_++) % max_blocks] = point;
    block_begin_ = point.device;
    fit();
    return;
  }
  Point& least = blocks_[(oldest_ + count_ - 1) % max_blocks];
  const double late = static_cast<double>(point.offset - base_.offset) - line_at(point.device);
  // Soonest as the line goes, not by the bare offset, which the drift changes within a block.
  const double before = static_cast<double>(least.offset - base_.offset) - line_at(least.device);
  if (late >= before) return;
  least = point;
  if (late < 0.0) fit();
}

/// The line that stays below all points and is nearest to them on average.
void DeviceClock::fit() noexcept {
  const Nanoseconds baseline = block(count_ - 1).device - block(0).device;
  base_ = block(count_ - 1);
  if (baseline >= min_baseline) {
    const double slope = hull_slope();
    // Beyond it the clock jumped, or the older records were all late: the slope learnt before
    // holds.
    if (std::abs(slope) <= max_slope) slope_ = slope;
  }
  intercept_ = 0.0;
  for (std::size_t k = 0; k < count_; ++k) {
    const Point& point = block(k);
    const double above = static_cast<double>(point.offset - base_.offset) -
                         slope_ * static_cast<double>(point.device - base_.device);
    intercept_ = std::min(intercept_, above);
  }
}

/// Of the edge of the lower convex hull under the points' mean device time.
double DeviceClock::hull_slope() const noexcept {
  struct Corner {
    double device, offset;
  };
  std::array<Corner, max_blocks> hull{};
  std::size_t corners = 0;
  double mean = 0.0;
  const auto slope = [](const Corner& a, const Corner& b) {
    return (b.offset - a.offset) / (b.device - a.device);
  };
  for (std::size_t k = 0; k < count_; ++k) {
    const Corner corner{static_cast<double>(block(k).device - base_.device),
                        static_cast<double>(block(k).offset - base_.offset)};
    mean += corner.device / static_cast<double>(count_);
    while (corners >= 2 &&
           slope(hull[corners - 2], hull[corners - 1]) >= slope(hull[corners - 2], corner)) {
      --corners;
    }
    hull[corners++] = corner;
  }
  std::size_t right = 1;
  while (right + 1 < corners && hull[right].device < mean)
    ++right;
  return slope(hull[right - 1], hull[right]);
}

} // namespace nendo::driver
