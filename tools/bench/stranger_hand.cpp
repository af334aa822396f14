#include "bench/stranger_hand.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

#include <nendo/base/units.hpp>

namespace nendo::bench {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using hand::SensorAngles;

// Bones, from joint to joint, and the soft tissue at the end of each finger, in millimetres: A.
// Buryanov, V. Kotiuk, "Proportions of hand segments", Int. J. Morphol. 28(3), 2010, 755-758, who
// measured radiographs of 66 adults. Quoted from memory.
constexpr double finger_bones_mm[4][3] = {{39.78, 22.38, 15.82 + 3.84},
                                          {44.63, 26.33, 17.40 + 3.95},
                                          {41.37, 25.65, 17.30 + 3.95},
                                          {32.74, 18.11, 15.96 + 3.73}};
constexpr double thumb_bones_mm[3] = {46.22, 31.57, 21.67 + 5.67};
constexpr double metacarpals_mm[4] = {68.12, 64.60, 58.00, 53.69};

// How far sizes differ between people, and bones beyond that, as parts.
constexpr double size_spread = 0.055;
constexpr double bone_spread = 0.045;

constexpr double across_mm[4] = {-21.0, 0.0, 18.5, 34.0}; // of the knuckles
constexpr double dorsal_mm[4] = {-1.0, 1.5, 0.0, -3.5};
constexpr double axial_base_mm = -20.0;
constexpr double converging_deg[4] = {-2.0, 0.0, 2.0, 4.0}; // closed fingers' tips lie together
constexpr double tilt_deg[4] = {6.0, 1.0, -5.0, -11.0};     // fingers of a fist point to the wrist

constexpr std::size_t slot_at(Sensor sensor) {
  return static_cast<std::size_t>(sensor);
}

Matrix3d about_x(double angle) {
  return AngleAxisd(angle, Vector3d::UnitX()).matrix();
}
Matrix3d about_y(double angle) {
  return AngleAxisd(angle, Vector3d::UnitY()).matrix();
}
Matrix3d about_z(double angle) {
  return AngleAxisd(angle, Vector3d::UnitZ()).matrix();
}

} // namespace

StrangerHand::StrangerHand(std::mt19937_64& random) {
  make([&](double mean,
           double deviation) { return std::normal_distribution<double>(mean, deviation)(random); },
       [&](double low, double high) {
         return std::uniform_real_distribution<double>(low, high)(random);
       });
}

StrangerHand::StrangerHand(std::span<const double, parts> deviations) {
  std::size_t next = 0;
  make([&](double mean, double deviation) { return mean + deviation * deviations[next++]; },
       [&](double low, double high) {
         return 0.5 * (low + high) + (high - low) / std::sqrt(12.0) * deviations[next++];
       });
  assert(next == parts);
}

/// Calls for one random number after the other, by mean and deviation or by both ends.
template <class Normal, class Uniform>
void StrangerHand::make(Normal&& normal, Uniform&& uniform) {
  const auto degrees = [&](double mean, double deviation) {
    return from_degrees(normal(mean, deviation));
  };
  const double size = normal(1.04, size_spread), breadth = size * normal(1.0, 0.04);
  const auto bone = [&](double mm) { return 1e-3 * mm * size * normal(1.0, bone_spread); };
  for (std::size_t f = 0; f < 4; ++f) {
    FingerShape& finger = fingers_[f];
    const double across = 1e-3 * across_mm[f] * breadth;
    finger.base = {0.55 * across, 0.0, 1e-3 * axial_base_mm * size};
    finger.knuckle = {across, 1e-3 * (dorsal_mm[f] * size + normal(0.0, 1.0)),
                      finger.base.z() - bone(metacarpals_mm[f])};
    finger.rest = about_y(degrees(converging_deg[f], 1.5)) * about_z(degrees(tilt_deg[f], 4.0));
    finger.pip_tilt = degrees(0.0, 3.0);
    for (std::size_t n = 0; n < 3; ++n)
      finger.bones[n] = bone(finger_bones_mm[f][n]);
    finger.arch_share = f < 2 ? 0.0 : f == 2 ? normal(0.45, 0.05) : 1.0;
  }
  thumb_.base = 1e-3 * size * Vector3d{normal(-17, 3), normal(-9, 3), normal(-19, 3)};
  thumb_.frame = about_x(degrees(3.0, 5.0)) * about_y(degrees(4.0, 5.0));
  thumb_.rest_abduction = degrees(18.0, 4.0);
  // The saddle after A. Hollister and others, J. Orthop. Res. 10, 1992: axes that are not square to
  // each other, one in the trapezium and one in the metacarpal. Flexion runs across the palm.
  const double turned = degrees(57.0, 7.0);
  thumb_.rest_turn = turned;
  thumb_.first_axis = about_z(turned + degrees(12.0, 6.0)) * Vector3d::UnitX();
  thumb_.second_axis = about_z(turned + degrees(4.0, 6.0)) * Vector3d::UnitY();
  thumb_.first_axis = about_y(thumb_.rest_abduction) * thumb_.first_axis;
  thumb_.second_axis = about_y(thumb_.rest_abduction) * thumb_.second_axis;
  thumb_.mcp_tilt = degrees(0.0, 4.0);
  thumb_.ip_tilt = degrees(6.0, 4.0);
  for (std::size_t n = 0; n < 3; ++n)
    thumb_.bones[n] = bone(thumb_bones_mm[n]);
  const double common = uniform(0.006, 0.010);
  for (Pad& pad : pads_) {
    pad.depth = std::clamp(common + normal(0.0, 0.0008), 0.006, 0.010);
    pad.behind = uniform(0.002, 0.009);
  }
  palm_depth_ = normal(0.013, 0.002);
}

/// How the metacarpal of the thumb is turned when it points where roll and abduction say. Two axes
/// can point it anywhere. How far it is then turned about itself follows from them, and is found by
/// Newton's method.
Matrix3d StrangerHand::thumb_turn(double roll_rad, double abduction_rad) const {
  const Vector3d ahead = -Vector3d::UnitZ();
  const Vector3d rest = about_y(thumb_.rest_abduction) * ahead;
  const Vector3d wanted =
      about_z(roll_rad) * about_y(thumb_.rest_abduction + abduction_rad) * ahead;
  double a = 0.0, b = 0.0;
  const auto turn = [&] {
    return Matrix3d(AngleAxisd(a, thumb_.first_axis) * AngleAxisd(b, thumb_.second_axis));
  };
  for (int n = 0; n < 40; ++n) {
    const Matrix3d now = turn();
    const Vector3d at = now * rest, off = wanted - at;
    Eigen::Matrix<double, 3, 2> slopes;
    slopes.col(0) = thumb_.first_axis.cross(at);
    slopes.col(1) = (AngleAxisd(a, thumb_.first_axis) * thumb_.second_axis).cross(at);
    Eigen::Matrix2d square = slopes.transpose() * slopes;
    square.diagonal().array() += 1e-4;
    const Eigen::Vector2d step = square.inverse() * (slopes.transpose() * off);
    a += std::clamp(step[0], -0.3, 0.3);
    b += std::clamp(step[1], -0.3, 0.3);
  }
  return turn() * about_y(thumb_.rest_abduction) * about_z(thumb_.rest_turn);
}

Vector3d StrangerHand::thumb_pad(const SensorAngles& angles) const {
  Matrix3d axes = thumb_.frame * thumb_turn(angles[slot_at(Sensor::thumb_roll)],
                                            angles[slot_at(Sensor::thumb_abduction)]);
  Vector3d at = thumb_.base + axes * Vector3d(0, 0, -thumb_.bones[0]);
  axes = axes * about_z(thumb_.mcp_tilt) * about_x(-angles[slot_at(Sensor::thumb_mcp)]);
  at += axes * Vector3d(0, 0, -thumb_.bones[1]);
  axes = axes * about_z(thumb_.ip_tilt) * about_x(-angles[slot_at(Sensor::thumb_ip)]);
  return at + axes * Vector3d(0, -pads_[0].depth, -thumb_.bones[2] + pads_[0].behind);
}

Vector3d StrangerHand::knuckle(std::size_t f, const SensorAngles& angles) const {
  const FingerShape& finger = fingers_[f];
  const Matrix3d arched = about_x(-finger.arch_share * angles[slot_at(Sensor::palm_arch)]);
  return finger.base + arched * (finger.knuckle - finger.base);
}

Vector3d StrangerHand::pad(std::size_t digit, const SensorAngles& angles) const {
  if (digit == 0) return thumb_pad(angles);
  const std::size_t f = digit - 1;
  const FingerShape& finger = fingers_[f];
  const double middle_ring = angles[slot_at(Sensor::middle_ring_abduction)];
  const double sideways[4] = {angles[slot_at(Sensor::index_middle_abduction)], 0.0, -middle_ring,
                              -middle_ring - angles[slot_at(Sensor::ring_little_abduction)]};
  const std::size_t mcp = slot_at(Sensor::index_mcp) + 4 * f;
  const Pad& pad = pads_[digit];
  Matrix3d axes = about_x(-finger.arch_share * angles[slot_at(Sensor::palm_arch)]) *
                  about_y(sideways[f]) * finger.rest * about_x(-angles[mcp]);
  Vector3d at = knuckle(f, angles) + axes * Vector3d(0, 0, -finger.bones[0]);
  axes = axes * about_z(finger.pip_tilt) * about_x(-angles[mcp + 1]);
  at += axes * Vector3d(0, 0, -finger.bones[1]);
  axes = axes * about_x(-angles[mcp + 2]);
  return at + axes * Vector3d(0, -pad.depth, -finger.bones[2] + pad.behind);
}

Vector3d StrangerHand::palm_at_little_finger(const SensorAngles& angles) const {
  const Matrix3d arched = about_x(-angles[slot_at(Sensor::palm_arch)]);
  return knuckle(3, angles) + arched * Vector3d(0.0, -palm_depth_, 0.0);
}

} // namespace nendo::bench
