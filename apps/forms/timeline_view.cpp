#include "forms/timeline_view.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::forms {

double DopeSheet::span_px() const noexcept {
  return std::max(1.0, width_ - left - right);
}

void DopeSheet::fit(double width, double duration_s) noexcept {
  const bool all = first_s_ <= 0.0 && last_s_ >= duration_s_;
  width_ = width;
  duration_s_ = std::max(0.0, duration_s);
  show(first_s_, all ? duration_s_ : last_s_);
}

// Neither too close nor of no length.
double DopeSheet::length_within(double length_s) const noexcept {
  return std::clamp(length_s, closest, std::max(duration_s_, closest));
}

void DopeSheet::show(double first_s, double last_s) noexcept {
  const double length_s = length_within(last_s - first_s);
  first_s_ = std::clamp(first_s, 0.0, std::max(duration_s_, closest) - length_s);
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
  const double length_s =
      length_within((last_s_ - first_s_) * std::pow(0.8, std::clamp(steps, -20.0, 20.0)));
  show(at_s - part * length_s, at_s + (1.0 - part) * length_s);
}

void DopeSheet::pan(double dx) noexcept {
  const double by_s = -dx / span_px() * (last_s_ - first_s_);
  show(first_s_ + by_s, last_s_ + by_s);
}

void DopeSheet::follow(double time_s) noexcept {
  if (time_s >= first_s_ && time_s <= last_s_) return;
  show(time_s, time_s + (last_s_ - first_s_));
}

namespace {

/// Returns the number of the nearest one within reach; `x_of` returns where one is.
template <class Ones, class XOf>
std::optional<std::size_t> nearest_of(const Ones& ones, double x, const XOf& x_of) {
  std::optional<std::size_t> found;
  double nearest = DopeSheet::reach;
  for (std::size_t at = 0; at < ones.size(); ++at) {
    const double distance = std::abs(x_of(ones[at]) - x);
    if (!(distance <= nearest)) continue;
    nearest = distance;
    found = at;
  }
  return found;
}

} // namespace

std::optional<StripKey> DopeSheet::key_at(std::span<const StripLane> lanes, double x,
                                          double y) const {
  const double lane_at = (y - ruler - pictures) / lane;
  if (!(lane_at >= 0.0 && lane_at < static_cast<double>(lanes.size()))) return std::nullopt;
  const auto number = static_cast<std::size_t>(lane_at);
  const auto key =
      nearest_of(lanes[number].keys_s, x, [this](double time_s) { return x_of(time_s); });
  return key ? std::optional(StripKey{number, *key}) : std::nullopt;
}

std::optional<std::size_t> DopeSheet::mark_at(std::span<const StripMark> marks, std::size_t lanes,
                                              double x, double y) const {
  if (std::abs(y - middle_of(lanes)) > lane / 2) return std::nullopt;
  return nearest_of(marks, x, [this](const StripMark& mark) { return x_of(mark.time_s); });
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

} // namespace nendo::forms
