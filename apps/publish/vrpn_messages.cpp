#include "publish/vrpn_messages.hpp"

#include <span>

#include <nendo/base/byte_writer.hpp>
#include <nendo/driver/vrpn_protocol.hpp>

namespace nendo::publish::vrpn {
namespace {

namespace protocol = driver::vrpn;

/// The server's types. The value is the number that clients get.
enum Type : std::int32_t { ping, pong, pose, analog, button };
constexpr std::array<std::string_view, 5> type_names{protocol::ping_name, protocol::pong_name,
                                                     protocol::pose_name, protocol::analog_name,
                                                     protocol::button_name};

std::int32_t number_of(std::size_t sender) noexcept {
  return static_cast<std::int32_t>(sender);
}

void append_joint(Bytes& out, std::size_t sender, std::size_t sensor,
                  const nendo_publish_joint& joint, std::int64_t time_us) {
  Bytes payload;
  payload.reserve(protocol::pose_payload_bytes);
  ByteWriter writer(payload);
  writer.u32_be(static_cast<std::uint32_t>(sensor));
  writer.u32_be(0);
  for (const float coordinate : joint.position)
    writer.f64_be(static_cast<double>(coordinate));
  for (const float component : joint.orientation)
    writer.f64_be(static_cast<double>(component));
  protocol::append_message(out, time_us, number_of(sender), pose, payload);
}

void append_angles(Bytes& out, std::size_t sender, const nendo_publish_hand_state& state,
                   std::int64_t time_us) {
  Bytes payload;
  payload.reserve(std::size_t{8} * (1 + NENDO_PUBLISH_ANGLES));
  ByteWriter writer(payload);
  writer.f64_be(NENDO_PUBLISH_ANGLES);
  for (const double angle_rad : state.angles)
    writer.f64_be(angle_rad);
  protocol::append_message(out, time_us, number_of(sender), analog, payload);
}

} // namespace

Bytes names() {
  Bytes out;
  for (std::size_t sender = 0; sender < sender_names.size(); ++sender)
    protocol::append_name(out, protocol::describes_sender, number_of(sender), sender_names[sender]);
  for (std::size_t type = 0; type < type_names.size(); ++type)
    protocol::append_name(out, protocol::describes_type, number_of(type), type_names[type]);
  return out;
}

void append_hands(Bytes& out, const HandsRecord& record, std::int64_t time_us) {
  for (std::size_t side = 0; side < 2; ++side) {
    const nendo_publish_hand& hand = record.record.hands[side];
    const nendo_publish_hand_state& state = record.states.hands[side];
    if ((hand.flags & NENDO_PUBLISH_PRESENT) == 0 || (hand.flags & NENDO_PUBLISH_SILENT) != 0)
      continue;
    append_angles(out, first_glove + side, state, time_us);
    if ((state.flags & NENDO_PUBLISH_LOST) != 0) continue;
    for (std::size_t joint = 0; joint < NENDO_PUBLISH_JOINTS; ++joint)
      append_joint(out, first_hand + side, joint, hand.joints[joint], time_us);
  }
}

std::optional<bool> switch_of(const HandsRecord& record, std::size_t side) noexcept {
  const std::uint32_t flags = record.states.hands[side].flags;
  if ((flags & NENDO_PUBLISH_HAS_SWITCH) == 0) return std::nullopt;
  return (flags & NENDO_PUBLISH_SWITCH_ON) != 0;
}

void append_switch(Bytes& out, std::size_t side, bool is_on, std::int64_t time_us) {
  Bytes payload;
  ByteWriter writer(payload);
  writer.u32_be(0); // its only button
  writer.u32_be(is_on ? 1 : 0);
  protocol::append_message(out, time_us, number_of(first_glove + side), button, payload);
}

void append_pong(Bytes& out, std::size_t sender) {
  protocol::append_message(out, 0, number_of(sender), pong, {});
}

} // namespace nendo::publish::vrpn
