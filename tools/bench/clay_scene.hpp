#pragma once
// Two hands that press a ball of clay from above and below, scrape it sideways, and leave.

#include <span>
#include <vector>

#include <nendo/deform/contact_part.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/hand/hand_body.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::bench {

/// Lengths are in millimetres. The ball is about the origin.
class ClayScene {
public:
  static constexpr double ball_radius_mm = 60.0;
  static constexpr double depth_mm = 25.0;  ///< to which each hand presses
  static constexpr double scrape_mm = 40.0; ///< the upper hand; the lower one goes half as far
  static constexpr double rate_hz = 90.0;

  /// `hands` is 1 or 2. They move at `speed_m_s`.
  ClayScene(int hands, double speed_m_s);

  std::size_t hands() const noexcept { return bodies_.size(); }
  int ticks() const noexcept { return ticks_; }
  /// Returns where the hands are in that tick; before the first one they are where they begin.
  std::span<const deform::ContactPart> at(int tick);

private:
  std::vector<hand::HandSkeleton> skeletons_;
  std::vector<hand::HandBody> bodies_;
  std::vector<deform::ContactPart> parts_;
  double step_mm_;
  int ticks_;
};

} // namespace nendo::bench
