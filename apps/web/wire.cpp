#include "web/wire.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace nendo::web {
namespace {

// The error, in units, that a centre may have if it is left out. Floats lose more than that.
constexpr double centre_gap = 1e-7;

float microseconds(HostClock::duration time) noexcept {
  return static_cast<float>(1e6 * to_seconds(time));
}

// The largest part of a unit quaternion follows from the other three, which are within 1/sqrt(2).
// Each of them is sent in 15 bits. The highest bits of the first two words say which part is left
// out.
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

bool is_nothing(const deform::CsrbfField& field, Eigen::Index function) noexcept {
  return field.coefficients.col(function).isZero(0.0);
}

// Whether the functions of `field` are those of `before`, with each centre where `before` moves it.
// So it is in a chain of links, whose centres the hands hold, unless two of them pinch.
bool goes_on(const deform::CsrbfField& field, const deform::CsrbfField& before,
             double unit) noexcept {
  if (field.radii.size() != before.radii.size() || field.radii != before.radii) return false;
  for (Eigen::Index at = 0; at < field.centres.cols(); ++at) {
    if (is_nothing(field, at) != is_nothing(before, at)) return false;
    const Eigen::Vector3d centre = before.centres.col(at);
    const Eigen::Vector3d taken = centre + before.displacement_at(centre);
    const double gap = (field.centres.col(at) - taken).cwiseAbs().maxCoeff();
    if (!(gap <= centre_gap * unit)) return false;
  }
  return true;
}

// before: the field before this one in the step, or null.
void write_field(const deform::CsrbfField& field, const deform::CsrbfField* before,
                 const Eigen::Vector3d& origin, double unit, WireWriter& out) noexcept {
  const bool follows = before != nullptr && goes_on(field, *before, unit);
  const bool one_radius = !follows && has_one_radius(field);
  const bool polynomial = !field.polynomial.isZero(0.0);
  std::uint16_t functions = 0;
  for (Eigen::Index at = 0; at < field.centres.cols(); ++at)
    if (!is_nothing(field, at)) ++functions;
  out.put(static_cast<std::uint8_t>(field.kernel));
  const bool keeps_volume = field.keep_volume > 0.0;
  out.put(static_cast<std::uint8_t>((polynomial ? 1U : 0U) | (one_radius ? 2U : 0U) |
                                    (follows ? 4U : 0U) | (keeps_volume ? 8U : 0U) |
                                    (field.is_halfway ? 16U : 0U)));
  out.put(functions);
  if (one_radius) out.put(as_float(unit / field.radii[0]));
  if (keeps_volume) out.put(as_float(field.keep_volume));
  if (polynomial) write_polynomial(field, origin, unit, out);
  for (Eigen::Index at = 0; at < field.centres.cols(); ++at) {
    if (is_nothing(field, at)) continue;
    for (Eigen::Index axis = 0; !follows && axis < 3; ++axis)
      out.put(as_float((field.centres(axis, at) - origin[axis]) / unit));
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      out.put(as_float(field.coefficients(axis, at) / unit));
    if (!follows && !one_radius) out.put(as_float(unit / field.radii[at]));
  }
}

void write_vectors(const deform::SurfaceMove& move, WireWriter& out) noexcept {
  out.put(static_cast<std::uint16_t>(move.count));
  out.put(static_cast<std::uint32_t>(move.field));
  for (Eigen::Index at = 0; at < static_cast<Eigen::Index>(move.count); ++at)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      out.put(as_float(static_cast<double>(move.vectors(axis, at))));
}

void write_turn(const Eigen::Isometry3d& pose, WireWriter& out) noexcept {
  for (const std::uint16_t word : packed(pose.linear()))
    out.put(word);
}

} // namespace

float as_float(double value) noexcept {
  return std::isfinite(value) ? static_cast<float>(std::clamp(value, -1e30, 1e30)) : 0.0F;
}

UpdateHead head_of(const flow::Frame& frame) noexcept {
  UpdateHead head;
  head.state = static_cast<std::uint8_t>(
      (frame.held ? 1U : 0U) | (frame.steps.in_hand ? 8U : 0U) | (frame.released[0] ? 16U : 0U) |
      (frame.released[1] ? 32U : 0U) | (frame.symmetric ? 64U : 0U) |
      (frame.function_count > 0 ? 128U : 0U));
  head.status = static_cast<std::uint8_t>(frame.status);
  head.tick = frame.tick;
  head.ticks = frame.ticks_run;
  head.missed = frame.missed;
  head.rest_changes = static_cast<std::uint32_t>(frame.rest_changes);
  head.jumps = static_cast<std::uint32_t>(frame.shape_jumps - frame.surface_moves);
  head.late_us = head.max_late_us = microseconds(frame.woke - frame.scheduled);
  head.since_last_us = microseconds(frame.since_last);
  head.links = static_cast<std::uint32_t>(std::max(0, frame.chain.links));
  for (unsigned slot = 0; slot < 2; ++slot) {
    const flow::HandFrame& hand = frame.hands[slot];
    const unsigned bits = (hand.present ? 1U : 0U) | (hand.silent ? 4U : 0U) |
                          (hand.swapped ? 16U : 0U) | (hand.tracked && hand.lost ? 64U : 0U);
    head.hands = static_cast<std::uint8_t>(head.hands | bits << slot);
  }
  return head;
}

std::vector<std::byte> text_message(MessageType type, std::string_view text, std::uint8_t kind) {
  std::vector<std::byte> message(text_head_bytes + text.size());
  message[0] = static_cast<std::byte>(type);
  message[1] = static_cast<std::byte>(kind);
  const auto bytes = std::as_bytes(std::span(text));
  std::copy(bytes.begin(), bytes.end(), message.data() + text_head_bytes);
  return message;
}

std::vector<std::byte> message_of(std::uint32_t number, const puppet::Rig* rig) {
  const std::span<const puppet::Function> functions =
      rig != nullptr ? std::span(rig->puppet().functions) : std::span<const puppet::Function>();
  std::size_t bytes = puppet_head_bytes;
  for (const puppet::Function& function : functions)
    bytes += 2 + function.name.size() + function.input.name().size();
  // Masks of a puppet that is played are in its weights.
  const bool has_masks = rig != nullptr && !rig->puppet().is_played();
  const std::span<const puppet::Mask> masks =
      has_masks ? std::span(rig->puppet().masks) : std::span<const puppet::Mask>();
  bytes += sizeof(std::uint32_t) + mask_bytes * masks.size();
  std::vector<std::byte> message(bytes);
  WireWriter out(message);
  out.put(static_cast<std::uint8_t>(MessageType::puppet));
  out.put(static_cast<std::uint8_t>(has_masks && rig->puppet().inverted ? 1 : 0));
  out.put(static_cast<std::uint16_t>(functions.size()));
  out.put(number);
  const auto put_text = [&out](const std::string& text) { // of at most 64 letters
    out.put(static_cast<std::uint8_t>(text.size()));
    for (const char letter : text)
      out.put(letter);
  };
  for (const puppet::Function& function : functions) {
    put_text(function.name);
    put_text(function.input.name());
  }
  out.put(static_cast<std::uint32_t>(masks.size()));
  for (const puppet::Mask& mask : masks) {
    out.put(Eigen::Vector3f(mask.at.cast<float>()));
    out.put(as_float(mask.radius));
  }
  return message;
}

std::vector<std::byte> clay_message(const flow::Frame& frame) {
  constexpr std::size_t contact_bytes = 16;
  std::vector<std::byte> message(sizeof(ClayMessage) + contact_bytes * frame.contacts.count);
  WireWriter out(message);
  ClayMessage head;
  head.contacts = static_cast<std::uint16_t>(frame.contacts.count);
  head.penetration_mm = as_float(frame.clay.penetration_mm);
  head.volume = frame.clay.volume;
  head.first_volume = frame.clay.first_volume;
  out.put(head);
  for (const deform::ClayContact& contact : frame.contacts.all()) {
    for (const double coordinate : contact.place)
      out.put(as_float(coordinate / frame.units_per_metre));
    out.put(flow::strength_of(contact));
  }
  return message;
}

std::vector<std::byte> wire_message(const flow::Frame& frame) {
  constexpr std::size_t head_bytes = 4, place_bytes = 24;
  const auto places =
      frame.wire.is_drawing() ? frame.wire.places() : decltype(frame.wire.places()){};
  std::vector<std::byte> message(head_bytes + place_bytes * places.size());
  WireWriter out(message);
  out.put(MessageType::wire);
  out.put(std::uint8_t{0});
  out.put(static_cast<std::uint16_t>(places.size()));
  for (const deform::WirePlace& place : places)
    for (const Eigen::Vector3d& end : {place.from, place.to})
      out.put(Eigen::Vector3f((end / frame.units_per_metre).cast<float>()));
  return message;
}

void write_pose(const Eigen::Isometry3d& pose, WireWriter& out) noexcept {
  out.put(Eigen::Vector3f(pose.translation().cast<float>()));
  const Eigen::Quaternionf turn(pose.linear().cast<float>());
  for (const float part : turn.coeffs()) // x, y, z, w
    out.put(part);
}

void write_hand(const flow::HandFrame& hand, WireWriter& out) noexcept {
  const Eigen::Vector3d wrist = hand.pose[hand::Joint::wrist].translation();
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    out.put(as_float(wrist[axis]));
  write_turn(hand.T_stage_wrist, out);
  for (std::size_t joint = 0; joint < hand::joint_count; ++joint)
    if (rotation_is_sent(static_cast<hand::Joint>(joint))) write_turn(hand.pose.joints[joint], out);
}

void write_step(StepKind kind, const flow::Frame& frame, const Eigen::Vector3d& origin, double unit,
                WireWriter& out) noexcept {
  out.put(static_cast<std::uint8_t>(kind));
  if (frame.surface.field != 0) {
    out.put(StepContent::vectors);
    write_vectors(frame.surface, out);
    return;
  }
  const auto all = frame.fields.fields();
  out.put(StepContent::fields);
  out.put(static_cast<std::uint16_t>(all.size()));
  for (std::size_t at = 0; at < all.size(); ++at)
    write_field(all[at], at > 0 ? &all[at - 1] : nullptr, origin, unit, out);
}

} // namespace nendo::web
