#include <nendo/hand/swing_finder.hpp>

#include <algorithm>

namespace nendo::hand {

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
