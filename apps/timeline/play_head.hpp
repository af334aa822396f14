#pragma once
// The play head of a timeline. It has the present time, and whether and how fast it moves on.

#include <algorithm>
#include <cmath>

namespace nendo::timeline {

class PlayHead {
public:
  static constexpr double min_speed = 0.1;
  static constexpr double max_speed = 4.0;

  double time_s() const noexcept { return time_s_; } ///< within 0 and the duration
  bool is_playing() const noexcept { return playing_; }
  bool loops() const noexcept { return loops_; }
  double speed() const noexcept { return speed_; }

  void set_loops(bool loops) noexcept { loops_ = loops; }
  /// Sets the speed in times real time, limited to min_speed and max_speed.
  void set_speed(double speed) noexcept {
    if (std::isfinite(speed)) speed_ = std::clamp(speed, min_speed, max_speed);
  }
  /// Starts or pauses. At the end it starts from the beginning.
  void toggle(double duration_s) noexcept {
    if (!playing_ && time_s_ >= duration_s) time_s_ = 0.0;
    playing_ = !playing_;
  }
  void pause() noexcept { playing_ = false; }
  void seek(double time_s, double duration_s) noexcept {
    if (std::isfinite(time_s)) time_s_ = std::clamp(time_s, 0.0, duration_s);
  }
  /// Moves on by the time that has passed. At the end it starts again or pauses.
  void advance(double elapsed_s, double duration_s) noexcept {
    time_s_ = std::clamp(time_s_, 0.0, duration_s); // it may have become shorter
    if (!playing_) return;
    time_s_ += speed_ * elapsed_s;
    if (time_s_ < duration_s) return;
    playing_ = loops_ && duration_s > 0.0;
    time_s_ = playing_ ? std::fmod(time_s_, duration_s) : duration_s;
  }

private:
  double time_s_ = 0.0;
  double speed_ = 1.0;
  bool playing_ = false;
  bool loops_ = false;
};

} // namespace nendo::timeline
