#pragma once
// Hands of a calibration as surfaces of the scene. They are upright, with the wrist at the origin
// and the palm towards +z, so that the wearer's own view is a turn about the vertical axis.

#include <array>
#include <utility>
#include <vector>

#include <nendo/hand/calibration_poses.hpp>
#include <nendo/hand/skeleton.hpp>

#include "calibrate/findings.hpp"
#include "render/camera.hpp"
#include "render/hand_skin.hpp"
#include "render/image.hpp"
#include "render/surface.hpp"

namespace nendo::studio {

using Fingers = std::array<bool, hand::finger_count>;

/// Returns the wrist of an upright hand at a place, metres.
Eigen::Isometry3d upright(const Eigen::Vector3d& wrist_m = Eigen::Vector3d::Zero());

/// Returns the direction from which the pose is read best: most as wearers look at their own hand.
render::View view_of(hand::PoseId pose, Side side) noexcept;
/// Returns the camera that has hands of this total width and an upright hand's height in the free
/// part of the picture. aspect: width / height of that part.
render::Camera camera_for(const render::View& view, double width_m, double aspect) noexcept;
/// Turns the camera towards a direction, in about half a second, by the shorter way.
void turn_towards(render::Camera& camera, const render::View& view, double elapsed_s) noexcept;

/// A hand of a calibration's picture.
struct ShownHand {
  enum class Look : std::uint8_t {
    live,
    ghost, ///< a translucent shell, a little wider than the hand that is to be in it
    glass  ///< translucent, for marks at its joints
  };
  hand::HandPose pose;
  Look look = Look::live;
  Fingers marked{};      ///< in the colour of a mistake, or of success
  bool is_wrong = false; ///< it is a mistake
};
/// From the tips of fingers to where they should be, metres.
using Ways = std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>;
/// A joint that the glove measures.
struct JointMark {
  Sensor sensor;
  Eigen::Vector3d place_m;
  calibrate::Certainty certainty;
};

/// Returns where the joint of a sensor is.
Eigen::Vector3d place_of(Sensor sensor, const hand::HandPose& pose);
/// Returns the ways of marked fingertips that are long enough to see.
Ways ways(const hand::HandPose& live, const hand::HandPose& asked, const Fingers& marked);

/// Draws hands of one side. Construction takes some tens of milliseconds.
class HandPainter {
public:
  explicit HandPainter(Side side) : skin_(side) {}

  std::vector<render::Surface> draw(const ShownHand& hand) const;
  /// Returns a ball at each joint, coloured by certainty.
  static std::vector<render::Surface> balls(const std::vector<JointMark>& joints);

private:
  std::vector<render::Surface> live(const ShownHand& hand) const;

  render::HandSkin skin_;
};

/// Returns the mark whose ball is at those pixels; null: none.
const JointMark* mark_at(const Eigen::Vector2d& pixel, const render::Camera& camera,
                         render::Size size, const std::vector<JointMark>& joints);

render::Surface arrows(const Ways& ways);

constexpr double ball_radius_m = 0.0065; ///< the mark of a joint
constexpr double picture_height_m =
    0.27 / 0.82;                          ///< a hand with a part of the forearm, and words above it
constexpr double middle_height_m = 0.085; ///< the picture's; the hand's is below
// Linear colours.
Eigen::Vector3f way_colour() noexcept;
Eigen::Vector3f mark_colour(bool is_wrong) noexcept; ///< a marked finger's
/// Returns the colour of a certainty.
Eigen::Vector3f colour_of(calibrate::Certainty certainty) noexcept;

} // namespace nendo::studio
