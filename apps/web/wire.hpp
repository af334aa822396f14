#pragma once
// The encoding of PROTOCOL.md. The tick uses it, so nothing allocates unless stated.

#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include <nendo/deform/material.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::web {

static_assert(std::endian::native == std::endian::little, "numbers are sent as they are in memory");

enum class MessageType : std::uint8_t {
  shape = 1,
  update = 2,
  report = 3,
  settings = 4,
  weights = 6,
  puppet = 7,
  clay = 8,
  commands = 9,
  wire = 11,
  form = 12,
  figures = 13
};
enum class StepKind : std::uint8_t { draw = 0, bake = 1 };
enum class StepContent : std::uint8_t { fields = 0, vectors = 1 };

/// The head of an update message, in PROTOCOL.md's order and without gaps.
struct UpdateHead {
  std::uint8_t type = static_cast<std::uint8_t>(MessageType::update);
  /// Bit 0: the hands hold the model; 3: StepList::in_hand; 4, 5: left, right has released the
  /// puppet; 6: symmetric; 7: there is a puppet.
  std::uint8_t state = 0;
  /// Bits 0, 1: left, right is present; 2, 3: silent; 4, 5: swapped bones; 6, 7: the
  /// tracker has lost the wrist.
  std::uint8_t hands = 0;
  std::uint8_t status = 0;
  std::uint32_t steps = 0;
  std::uint64_t number = 0;
  std::uint64_t tick = 0;
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0;
  std::uint32_t rest_changes = 0;
  std::uint32_t jumps = 0;
  float late_us = 0.0F;
  float max_late_us = 0.0F;
  float since_last_us = 0.0F;
  std::uint32_t lost = 0;
  std::uint32_t skipped = 0;
  std::uint32_t links = 0;
};
static_assert(sizeof(UpdateHead) == 72);

struct ShapeHead {
  std::uint8_t type = static_cast<std::uint8_t>(MessageType::shape);
  std::uint8_t spare = 0;
  std::uint16_t loop = 0; ///< as in the model's head
  std::uint32_t vertices = 0;
  std::uint64_t number = 0;
};
static_assert(sizeof(ShapeHead) == 16);

/// The head of the model message, in PROTOCOL.md's order and without gaps.
struct ModelHead {
  char magic[8]{'N', 'E', 'N', 'D', 'O', 'W', 'E', 'B'};
  std::uint32_t version = 9;
  std::uint32_t vertices = 0;
  std::uint32_t triangles = 0;
  std::uint32_t name_bytes = 0;
  double rate_hz = 0.0;
  double unit = 1.0;
  double origin[3]{};
  double units_per_metre = 1.0;
  double diagonal = 0.0;
  std::uint16_t loop = 0; ///< the loop's number within the server, which sets it
  /// Bits 0, 1: left, right hand's bones follow; 2: vertices' colours; 3: texture coordinates.
  std::uint8_t flags = 0;
  std::uint8_t spare = 0;
  std::uint32_t coats = 0;
};
static_assert(sizeof(ModelHead) == 88);

/// Consecutive triangles with the same material, in the model message.
struct CoatHead {
  std::uint32_t triangles = 0;
  std::uint32_t texture = deform::no_index;
  std::uint32_t has_colour = 0; ///< 0: `colour` is white because the material has none
  float colour[3]{1.0F, 1.0F, 1.0F};
};
static_assert(sizeof(CoatHead) == 24);

/// The head of the weights message.
struct WeightsHead {
  std::uint8_t type = static_cast<std::uint8_t>(MessageType::weights);
  std::uint8_t spare = 0;
  std::uint16_t vectors = 0;
  std::uint32_t number = 0; ///< the last bits of deform::SurfaceField::number()
  std::uint32_t vertices = 0;
  std::uint32_t terms = 0;
};
static_assert(sizeof(WeightsHead) == 16);

/// The head of the skin message.
struct SkinHead {
  std::uint32_t vertices = 0;
  std::uint32_t triangles = 0;
};
static_assert(sizeof(SkinHead) == 8);
inline constexpr std::size_t skin_vertex_bytes = 20; ///< a position, four joints, four weights

/// The head of the clay message, in PROTOCOL.md's order and without gaps. The contacts follow.
struct ClayMessage {
  std::uint8_t type = static_cast<std::uint8_t>(MessageType::clay);
  std::uint8_t spare = 0;
  std::uint16_t contacts = 0;
  float penetration_mm = 0.0F;
  double volume = 0.0;
  double first_volume = 0.0;
};
static_assert(sizeof(ClayMessage) == 24);

inline constexpr std::size_t text_head_bytes = 4;   ///< the type, a kind, and two zeros
inline constexpr std::size_t puppet_head_bytes = 8; ///< the puppet message
inline constexpr std::size_t mask_bytes = 16;

/// Returns whether each frame has this joint's rotation. Other joints are fixed to their parents.
constexpr bool rotation_is_sent(hand::Joint joint) noexcept {
  using hand::Joint;
  for (const Joint fixed :
       {Joint::palm, Joint::index_metacarpal, Joint::middle_metacarpal, Joint::thumb_tip,
        Joint::index_tip, Joint::middle_tip, Joint::ring_tip, Joint::little_tip})
    if (joint == fixed) return false;
  return true;
}
/// The number of sent rotations: the forearm's and those of these joints.
inline constexpr std::size_t sent_rotations = 1 + 18;
inline constexpr std::size_t hand_bytes = 12 + sent_rotations * 6;
/// The bytes of a hand's bones, twice: for the initial glove, and for a glove of the other side.
/// Each joint has its position and rotation relative to its parent.
inline constexpr std::size_t pose_bytes = 28;
inline constexpr std::size_t bones_bytes = 2 * hand::joint_count * pose_bytes;
inline constexpr std::size_t step_head_bytes = 4;
/// Returns the bytes of a step with this number of vectors.
constexpr std::size_t vectors_bytes(std::size_t vectors) noexcept {
  return 4 + vectors * 12;
}

/// Returns the max bytes of a field with this number of functions.
constexpr std::size_t field_bytes(std::size_t functions) noexcept {
  return 8 + 48 + functions * 28;
}

/// Appends values to a buffer, which must be large enough.
class WireWriter {
public:
  explicit WireWriter(std::span<std::byte> buffer) noexcept : buffer_(buffer) {}

  template <class T>
  void put(const T& value) noexcept {
    assert(used_ + sizeof value <= buffer_.size());
    std::memcpy(buffer_.data() + used_, &value, sizeof value);
    used_ += sizeof value;
  }
  void put(const Eigen::Vector3f& point) noexcept {
    for (const float coordinate : point)
      put(coordinate);
  }
  std::size_t used() const noexcept { return used_; }

private:
  std::span<std::byte> buffer_;
  std::size_t used_ = 0;
};

/// Converts to float. Replaces numbers that are not finite or too large.
float as_float(double value) noexcept;

UpdateHead head_of(const flow::Frame& frame) noexcept;
/// Returns a text message: a report, settings, commands, a form or figures. `kind` is its
/// second byte. Allocates.
std::vector<std::byte> text_message(MessageType type, std::string_view text, std::uint8_t kind = 0);
/// Returns the message with the puppet's functions, or with fingertips' masks; null: neither.
/// Allocates.
std::vector<std::byte> message_of(std::uint32_t number, const puppet::Rig* rig);
/// Returns the message with the clay's contacts and volume. Allocates.
std::vector<std::byte> clay_message(const flow::Frame& frame);
/// Returns the message with the wire or knife that is being drawn. Allocates.
std::vector<std::byte> wire_message(const flow::Frame& frame);
/// Writes a position and a rotation as a unit quaternion x, y, z, w: pose_bytes.
void write_pose(const Eigen::Isometry3d& pose, WireWriter& out) noexcept;
void write_hand(const flow::HandFrame& hand, WireWriter& out) noexcept;
/// Writes the frame's step: the vectors of its surface move, if any, or else its fields. `origin`
/// and `unit` are those of the loop's BlockLayout. Omits functions with a zero coefficient, and
/// centres that follow from the previous field.
void write_step(StepKind kind, const flow::Frame& frame, const Eigen::Vector3d& origin, double unit,
                WireWriter& out) noexcept;

} // namespace nendo::web
