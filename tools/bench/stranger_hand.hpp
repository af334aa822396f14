#pragma once
// A second model of a hand, for judging calibrations. It shares nothing with hand::HandSkeleton but
// the meaning of the joints' angles: its bones, its thumb and its axes come from other
// publications, and they differ from wearer to wearer.

#include <array>
#include <random>
#include <span>

#include <Eigen/Core>

#include <nendo/hand/calibration.hpp>

namespace nendo::bench {

class StrangerHand {
public:
  /// Draws a hand.
  explicit StrangerHand(std::mt19937_64& random);
  /// What is drawn of a hand, one after the other.
  static constexpr std::size_t parts = 61;
  /// Makes the hand whose parts lie so many standard deviations from their means.
  explicit StrangerHand(std::span<const double, parts> deviations);
  /// The hand whose parts are at their means.
  static StrangerHand usual() { return StrangerHand(std::array<double, parts>{}); }

  /// Returns the middle of the pad of the thumb (0) or of a finger (1 to 4), in metres, by the
  /// angles of the sensors' joints. A right hand's axes: the thumb at -X, the back at +Y, the
  /// fingers at -Z.
  Eigen::Vector3d pad(std::size_t digit, const hand::SensorAngles& angles_rad) const;
  /// Returns the skin of the palm at the base of the little finger.
  Eigen::Vector3d palm_at_little_finger(const hand::SensorAngles& angles_rad) const;

  /// How deep each pad is below the bone, and how far behind the end of the finger; metres.
  struct Pad {
    double depth, behind;
  };
  const std::array<Pad, 5>& pads() const noexcept { return pads_; }

private:
  struct FingerShape {
    Eigen::Vector3d knuckle; ///< from the wrist
    Eigen::Vector3d base;    ///< base of its metacarpal
    Eigen::Matrix3d rest;    ///< where it points, and how its axis of flexion is tilted
    double pip_tilt;         ///< tilt of the last two joints' axes against the knuckle's, radians
    std::array<double, 3> bones;
    double arch_share;
  };
  struct ThumbShape {
    Eigen::Vector3d base;
    Eigen::Matrix3d frame;       ///< frame of the axis about which the thumb rolls
    double rest_abduction;       ///< radians
    Eigen::Vector3d first_axis;  ///< axis of flexion, fixed in the trapezium
    Eigen::Vector3d second_axis; ///< axis of abduction at rest; it moves with the metacarpal
    double rest_turn;            ///< about its own axis, radians
    double mcp_tilt, ip_tilt;    ///< tilt of their axes about the bone, radians
    std::array<double, 3> bones;
  };

  template <class Normal, class Uniform>
  void make(Normal&& normal, Uniform&& uniform);
  Eigen::Matrix3d thumb_turn(double roll_rad, double abduction_rad) const;
  Eigen::Vector3d thumb_pad(const hand::SensorAngles& angles_rad) const;
  Eigen::Vector3d knuckle(std::size_t finger, const hand::SensorAngles& angles_rad) const;

  std::array<FingerShape, 4> fingers_;
  ThumbShape thumb_;
  std::array<Pad, 5> pads_{};
  double palm_depth_;
};

} // namespace nendo::bench
