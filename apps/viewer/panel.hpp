#pragma once
// The contents of the live window's panel.

#include <array>
#include <cstddef>

#include "viewer/live_window.hpp"

namespace nendo::viewer {

/// The latest values of a quantity, for a strip chart.
class Strip {
public:
  void add(float value) noexcept {
    values_[next_] = value;
    next_ = (next_ + 1) % values_.size();
  }
  const float* data() const noexcept { return values_.data(); }
  int size() const noexcept { return static_cast<int>(values_.size()); }
  int oldest() const noexcept { return static_cast<int>(next_); }
  float most() const noexcept;

private:
  std::array<float, 240> values_{};
  std::size_t next_ = 0;
};

struct LiveWindow::Panel {
  flow::LoopSettings in_force, wanted;
  Strip late_ms, gap_ms, pictures_ms;
  std::uint64_t last_tick = 0;
  bool keys_shown = false;
  bool one_radius = true;
  bool reset_asked = false; ///< the question whether to reset is open

  void follow(const flow::Frame& frame, double rate_hz);
  void buttons(const flow::Frame& frame, const Gauges& gauges, Commands& commands);
  void question(Commands& commands);
  void settings(Commands& commands);
  void timing(const flow::Frame& frame, const Gauges& gauges) const;
  void hands(const flow::Frame& frame, const Gauges& gauges) const;
  void keys(const Gauges& gauges, Commands& commands);
  void settings_keys(Commands& commands);
};

} // namespace nendo::viewer
