#include "motions/touch_score.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace nendo::motions {
namespace {

// Of a stroke that is held so long, its corners are extremes.
constexpr double long_hold_s = 1.5;

double within_period(double time_s, double period_s) noexcept {
  return time_s - period_s * std::floor(time_s / period_s);
}

} // namespace

double min_jerk(double part) noexcept {
  const double x = std::clamp(part, 0.0, 1.0);
  return x * x * x * (10.0 + x * (6.0 * x - 15.0));
}

TouchScore::TouchScore(Side side, std::uint32_t seed) {
  // The standard's distributions differ between libraries; the engine itself does not.
  std::mt19937 random(2 * seed + (side == Side::left ? 1 : 0));
  const auto between = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  const double beat_s = between(0.93, 1.07); // about a second: a hand's tempo
  double now_s = 0.0;
  const auto one_by_one = [&](double depth, double stroke_s) {
    const std::size_t first = random() % hand::finger_count;
    for (std::size_t n = 0; n < hand::finger_count; ++n) {
      const double time_s = beat_s * stroke_s * between(0.9, 1.1);
      strokes_[(first + n) % hand::finger_count].push_back(
          {now_s, 0.4 * time_s, 0.2 * time_s, 0.4 * time_s, depth * between(0.75, 1.0)});
      now_s += 0.8 * time_s; // the next one begins before this one has ended
    }
    now_s += 0.5 * beat_s;
  };
  const auto together = [&](double depth, double stroke_s) {
    const double time_s = beat_s * stroke_s * between(0.9, 1.1);
    for (Strokes& strokes : strokes_) {
      const double late_s = 0.1 * time_s * between(0.0, 1.0);
      strokes.push_back({now_s + late_s, 0.35 * time_s, 0.2 * time_s, 0.35 * time_s, depth});
    }
    now_s += time_s + 0.2 * beat_s;
  };
  const auto glide = [&](double from, double to) {
    const double time_s = beat_s * 1.6 * std::max(std::abs(to - from), 0.5);
    glides_.push_back({now_s, time_s, from, to});
    now_s += time_s + 0.2 * beat_s;
  };
  // Far out, for so long that a run that ends after ten seconds shows it in its picture.
  const auto pull_far = [&](double begin_s) {
    now_s = std::max(now_s, begin_s);
    for (Strokes& strokes : strokes_)
      strokes.push_back({now_s + 0.1 * between(0.0, 1.0), 1.5, 2.4, 1.3, -1.0});
    now_s += 5.4;
  };
  now_s = beat_s * between(0.4, 0.8);
  one_by_one(1.0, 1.0);
  glide(0.0, 0.5);
  pull_far(7.2);
  together(1.0, 2.0);
  together(0.7, 1.4);
  glide(0.5, 1.0);
  one_by_one(-0.25, 1.0);
  glide(1.0, 0.0);
  together(1.0, 2.4);
  period_s_ = now_s;
}

double TouchScore::depth(hand::Finger finger, double time_s) const noexcept {
  const double at_s = within_period(time_s, period_s_);
  double depth = 0.0;
  for (const TouchStroke& stroke : strokes_[static_cast<std::size_t>(finger)]) {
    if (at_s <= stroke.begin_s || at_s >= stroke.end_s()) continue;
    const double rise = min_jerk((at_s - stroke.begin_s) / stroke.rise_s);
    const double fall = min_jerk((stroke.end_s() - at_s) / stroke.fall_s);
    depth += stroke.depth * std::min(rise, fall);
  }
  return depth;
}

double TouchScore::way(double time_s) const noexcept {
  const double at_s = within_period(time_s, period_s_);
  double way = 0.0;
  for (const TouchGlide& glide : glides_) {
    if (at_s < glide.begin_s) break;
    way = glide.from + (glide.to - glide.from) * min_jerk((at_s - glide.begin_s) / glide.length_s);
  }
  return way;
}

std::vector<double> TouchScore::extremes_s() const {
  std::vector<double> times_s{0.0};
  for (const Strokes& strokes : strokes_) {
    for (const TouchStroke& stroke : strokes) {
      times_s.push_back(stroke.apex_s());
      if (stroke.hold_s < long_hold_s) continue;
      const double held_s = stroke.begin_s + stroke.rise_s;
      times_s.insert(times_s.end(),
                     {stroke.begin_s, held_s, held_s + stroke.hold_s, stroke.end_s()});
    }
  }
  for (const TouchGlide& glide : glides_)
    times_s.push_back(glide.begin_s + glide.length_s);
  std::sort(times_s.begin(), times_s.end());
  return times_s;
}

} // namespace nendo::motions
