#include <nendo/hand/range_capture.hpp>

#include <algorithm>

namespace nendo::hand {

void CountRanges::widen(Sensor sensor, double counts) noexcept {
  const auto slot = index_of(sensor);
  const bool first = !present.has(sensor);
  present.add(sensor);
  low_counts[slot] = first ? counts : std::min(low_counts[slot], counts);
  high_counts[slot] = first ? counts : std::max(high_counts[slot], counts);
}

void RangeCapture::push(const GloveSample& sample) noexcept {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    Last& last = last_[slot];
    if (!sample.present.has(sensor)) {
      last.known = 0;
      continue;
    }
    const double now = sample.raw[slot].value;
    const auto [earlier, before] = last.counts;
    last.counts = {before, now};
    if (last.known < 2) {
      ++last.known;
      continue;
    }
    seen_.widen(sensor,
                std::max(std::min(earlier, before), std::min(std::max(earlier, before), now)));
  }
}

std::optional<double> SwingFinder::median(std::uint16_t count) noexcept {
  recent_[seen_ % window] = count;
  ++seen_;
  if (seen_ < window) return std::nullopt;
  auto sorted = recent_;
  std::nth_element(sorted.begin(), sorted.begin() + window / 2, sorted.end());
  return sorted[window / 2];
}

std::optional<SwingFinder::End> SwingFinder::push(std::uint16_t count, double min_swing) noexcept {
  const std::optional<double> now = median(count);
  if (!now) return std::nullopt;
  if (seen_ == window) { // the first since it began again
    rises_ = falls_ = false;
    top_ = bottom_ = *now;
  }
  if (!falls_) top_ = std::max(top_, *now);
  if (!rises_) bottom_ = std::min(bottom_, *now);
  std::optional<End> end;
  if (!falls_ && *now <= top_ - min_swing) {
    if (rises_) end = {top_, top_ - bottom_, true};
    falls_ = true;
    rises_ = false;
    bottom_ = *now;
  } else if (!rises_ && *now >= bottom_ + min_swing) {
    if (falls_) end = {bottom_, top_ - bottom_, false};
    rises_ = true;
    falls_ = false;
    top_ = *now;
  }
  return end;
}

} // namespace nendo::hand
