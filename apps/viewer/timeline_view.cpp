#include "viewer/timeline_view.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::viewer {

double DopeSheet::span_px() const noexcept {
  return std::max(1.0, width_ - left - right);
}

void DopeSheet::fit(double width, double duration_s) noexcept {
  const bool all = first_s_ <= 0.0 && last_s_ >= duration_s_;
  width_ = width;
  duration_s_ = std::max(0.0, duration_s);
  show(first_s_, all ? duration_s_ : last_s_);
}

// Within the timeline, and neither too close nor of no length.
void DopeSheet::show(double first_s, double last_s) noexcept {
  const double all_s = std::max(duration_s_, closest);
  const double length_s = std::clamp(last_s - first_s, std::min(closest, all_s), all_s);
  first_s_ = std::clamp(first_s, 0.0, all_s - length_s);
  last_s_ = first_s_ + length_s;
}

double DopeSheet::x_of(double time_s) const noexcept {
  return left + (time_s - first_s_) / (last_s_ - first_s_) * span_px();
}

double DopeSheet::time_at(double x) const noexcept {
  const double time_s = first_s_ + (x - left) / span_px() * (last_s_ - first_s_);
  return std::clamp(time_s, 0.0, duration_s_);
}

double DopeSheet::middle_of(std::size_t number) noexcept {
  return ruler + pictures + lane * (static_cast<double>(number) + 0.5);
}

void DopeSheet::zoom(double x, double steps) noexcept {
  const double part = std::clamp((x - left) / span_px(), 0.0, 1.0);
  const double at_s = first_s_ + part * (last_s_ - first_s_);
  const double length_s = (last_s_ - first_s_) * std::pow(0.8, std::clamp(steps, -20.0, 20.0));
  const double min_s = std::min(closest, std::max(duration_s_, closest));
  const double kept_s = std::clamp(length_s, min_s, std::max(duration_s_, closest));
  show(at_s - part * kept_s, at_s + (1.0 - part) * kept_s);
}

void DopeSheet::pan(double dx) noexcept {
  const double by_s = -dx / span_px() * (last_s_ - first_s_);
  show(first_s_ + by_s, last_s_ + by_s);
}

void DopeSheet::follow(double time_s) noexcept {
  if (time_s >= first_s_ && time_s <= last_s_) return;
  show(time_s, time_s + (last_s_ - first_s_));
}

std::optional<StripKey> DopeSheet::key_at(std::span<const StripLane> lanes, double x,
                                          double y) const {
  constexpr double top = ruler + pictures;
  if (y < top) return std::nullopt;
  const auto number = static_cast<std::size_t>((y - top) / lane);
  if (number >= lanes.size()) return std::nullopt;
  const auto& keys_s = lanes[number].keys_s;
  const double time_s = first_s_ + (x - left) / span_px() * (last_s_ - first_s_);
  const auto after = std::lower_bound(keys_s.begin(), keys_s.end(), time_s);
  std::optional<StripKey> found;
  double nearest = reach;
  for (auto key = after == keys_s.begin() ? after : after - 1; key != keys_s.end() && key <= after;
       ++key) {
    const double distance = std::abs(x_of(*key) - x);
    if (!(distance <= nearest)) continue;
    nearest = distance;
    found = StripKey{number, static_cast<std::size_t>(key - keys_s.begin())};
  }
  return found;
}

std::optional<std::size_t> DopeSheet::mark_at(std::span<const StripMark> marks, std::size_t lanes,
                                              double x, double y) const {
  if (std::abs(y - middle_of(lanes)) > lane / 2) return std::nullopt;
  std::optional<std::size_t> found;
  double nearest = reach;
  for (std::size_t mark = 0; mark < marks.size(); ++mark) {
    const double distance = std::abs(x_of(marks[mark].time_s) - x);
    if (!(distance < nearest)) continue;
    nearest = distance;
    found = mark;
  }
  return found;
}

std::vector<StripPicture> DopeSheet::cells() const {
  const double narrowest_s = narrowest / span_px() * (last_s_ - first_s_);
  const double length_s = std::exp2(std::ceil(std::log2(narrowest_s)));
  std::vector<StripPicture> cells;
  for (double number = std::floor(first_s_ / length_s);; number += 1.0) {
    const double from_s = number * length_s;
    if (from_s >= std::min(last_s_, duration_s_) && !cells.empty()) return cells;
    cells.push_back({from_s, std::min(from_s + length_s, duration_s_)});
  }
}

double DopeSheet::ruler_step_s() const noexcept {
  constexpr double min_px = 64.0;
  const double min_s = min_px / span_px() * (last_s_ - first_s_);
  const double power = std::pow(10.0, std::floor(std::log10(min_s)));
  for (const double times : {1.0, 2.0, 5.0})
    if (times * power >= min_s) return times * power;
  return 10.0 * power;
}

} // namespace nendo::viewer
