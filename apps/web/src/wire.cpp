#include "wire.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace nendo::web {
namespace {

constexpr double place_unit_m = 1e-5;

float microseconds(HostClock::duration time) noexcept {
  return static_cast<float>(1e6 * to_seconds(time));
}

// What is not finite, or too large, is sent as something that is drawn, if only in a wrong place.
float as_float(double value) noexcept {
  return std::isfinite(value) ? static_cast<float>(std::clamp(value, -1e30, 1e30)) : 0.0F;
}

// The largest part of a unit quaternion follows from the other three, which are within 1/sqrt(2):
// 15 bits each, and in the two first words' highest bits which part that is.
std::array<std::uint16_t, 3> packed(const Eigen::Matrix3d& rotation) noexcept {
  const Eigen::Vector4d parts = Eigen::Quaterniond(rotation).coeffs(); // x, y, z, w
  Eigen::Index largest = 0;
  parts.cwiseAbs().maxCoeff(&largest);
  const double sign = parts[largest] < 0.0 ? -1.0 : 1.0;
  std::array<std::uint16_t, 3> words{};
  std::size_t at = 0;
  for (Eigen::Index part = 0; part < 4; ++part) {
    if (part == largest) continue;
    const double share = sign * parts[part] * std::numbers::sqrt2; // -1 to 1
    const double step = std::round((std::clamp(share, -1.0, 1.0) + 1.0) / 2.0 * 32767.0);
    words[at++] = static_cast<std::uint16_t>(std::isfinite(step) ? step : 16384.0);
  }
  const auto which = static_cast<unsigned>(largest);
  words[0] = static_cast<std::uint16_t>(words[0] | (which & 1U) << 15U);
  words[1] = static_cast<std::uint16_t>(words[1] | (which >> 1U) << 15U);
  return words;
}

bool has_one_radius(const deform::CsrbfField& field) noexcept {
  for (Eigen::Index at = 1; at < field.radii.size(); ++at)
    if (field.radii[at] != field.radii[0]) return false;
  return field.radii.size() > 0;
}

void write_polynomial(const deform::CsrbfField& field, const Eigen::Vector3d& origin, double unit,
                      WireWriter& out) noexcept {
  const Eigen::Matrix3d slope = field.polynomial.rightCols<3>();
  const Eigen::Vector3d constant = (field.polynomial.col(0) + slope * origin) / unit;
  for (Eigen::Index row = 0; row < 3; ++row) {
    out.put(as_float(constant[row]));
    for (Eigen::Index column = 0; column < 3; ++column)
      out.put(as_float(slope(row, column)));
  }
}

void write_field(const deform::CsrbfField& field, const Eigen::Vector3d& origin, double unit,
                 WireWriter& out) noexcept {
  const bool one_radius = has_one_radius(field);
  const bool polynomial = !field.polynomial.isZero(0.0);
  std::uint16_t functions = 0;
  for (Eigen::Index at = 0; at < field.centres.cols(); ++at)
    if (!field.coefficients.col(at).isZero(0.0)) ++functions;
  out.put(static_cast<std::uint8_t>(field.kernel));
  out.put(static_cast<std::uint8_t>((polynomial ? 1U : 0U) | (one_radius ? 2U : 0U)));
  out.put(functions);
  if (one_radius) out.put(as_float(unit / field.radii[0]));
  if (polynomial) write_polynomial(field, origin, unit, out);
  for (Eigen::Index at = 0; at < field.centres.cols(); ++at) {
    if (field.coefficients.col(at).isZero(0.0)) continue;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      out.put(as_float((field.centres(axis, at) - origin[axis]) / unit));
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      out.put(as_float(field.coefficients(axis, at) / unit));
    if (!one_radius) out.put(as_float(unit / field.radii[at]));
  }
}

} // namespace

UpdateHead head_of(const flow::Frame& frame) noexcept {
  UpdateHead head;
  head.held = frame.held ? 1 : 0;
  head.status = static_cast<std::uint8_t>(frame.status);
  head.tick = frame.tick;
  head.ticks = frame.ticks;
  head.missed = frame.missed;
  head.commits = static_cast<std::uint32_t>(frame.commits);
  head.undos = static_cast<std::uint32_t>(frame.undos);
  head.late_us = head.most_late_us = microseconds(frame.woke - frame.scheduled);
  head.since_last_us = microseconds(frame.since_last);
  head.links = static_cast<std::uint32_t>(std::max(0, frame.chain.links));
  for (unsigned slot = 0; slot < 2; ++slot) {
    const flow::HandFrame& hand = frame.hands[slot];
    head.samples[slot] = static_cast<std::uint32_t>(hand.samples);
    const unsigned bits = (hand.present ? 1U : 0U) | (hand.silent ? 4U : 0U);
    head.hands = static_cast<std::uint8_t>(head.hands | bits << slot);
  }
  return head;
}

void write_hand(const hand::HandPose& pose, WireWriter& out) noexcept {
  const Eigen::Vector3d wrist = pose[hand::Joint::wrist].translation();
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    out.put(as_float(wrist[axis]));
  for (const Eigen::Isometry3d& joint : pose.joints) {
    const Eigen::Vector3d steps = (joint.translation() - wrist) / place_unit_m;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double step = std::isfinite(steps[axis]) ? std::round(steps[axis]) : 0.0;
      out.put(static_cast<std::int16_t>(std::clamp(step, -32767.0, 32767.0)));
    }
    for (const std::uint16_t word : packed(joint.linear()))
      out.put(word);
  }
}

void write_step(StepKind kind, const deform::FieldSequence& fields, const Eigen::Vector3d& origin,
                double unit, WireWriter& out) noexcept {
  const auto all = fields.fields();
  out.put(static_cast<std::uint8_t>(kind));
  out.put(std::uint8_t{0});
  out.put(static_cast<std::uint16_t>(all.size()));
  for (const deform::CsrbfField& field : all)
    write_field(field, origin, unit, out);
}

} // namespace nendo::web
