#pragma once
// Hands of a calibration as surfaces of the scene. They are upright, with the wrist at the origin
// and the palm towards +z, so that the wearer's own view is a turn about the vertical axis.

#include <array>
#include <optional>
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

/// Draws hands of one side. Construction takes some tens of milliseconds.
class HandPainter {
public:
  explicit HandPainter(Side side) : side_(side), skin_(side) {}

  Side side() const noexcept { return side_; }
  /// Returns a translucent shell around the pose, a little wider than the hand that is to be in it.
  render::Surface ghost(const hand::HandPose& pose) const;
  /// Returns the hand, with the marked fingers in the colour of a mistake, or of success.
  std::vector<render::Surface> live(const hand::HandPose& pose, const Fingers& marked,
                                    bool is_wrong) const;
  /// Returns a translucent hand with a ball at each joint that the glove measures, coloured by
  /// certainty.
  std::vector<render::Surface> report(const hand::HandPose& pose,
                                      const calibrate::FinishedCalibration& finished,
                                      SensorMask sensors) const;

private:
  Side side_;
  render::HandSkin skin_;
};

/// Returns the sensor whose ball in HandPainter::report() is at those pixels.
std::optional<Sensor> sensor_at(const Eigen::Vector2d& pixel, const render::Camera& camera,
                                render::Size size, const hand::HandPose& pose, SensorMask sensors);

/// Returns arrows from the tips of the marked fingers to where they should be, if that is far
/// enough to see.
render::Surface arrows(const hand::HandPose& live, const hand::HandPose& asked,
                       const Fingers& marked);

/// Returns the linear colour of a certainty.
Eigen::Vector3f colour_of(calibrate::Certainty certainty) noexcept;

} // namespace nendo::studio
