#pragma once
// The result of a tick: both hands, the field, and the deformed vertices. It is published through a
// lock-free exchange of the latest value.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <nendo/base/triple_buffer.hpp>
#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/surface_field.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/clay_hands.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/flow/step.hpp>
#include <nendo/flow/wire_path.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/puppet/puppet.hpp>

namespace nendo::flow {

struct HandFrame {
  bool present = false; ///< a glove drives this hand
  bool silent = false;  ///< its glove has sent nothing for a while; the pose is frozen
  bool swapped = false; ///< its glove has not the side of HandInput::first
  hand::HandPose pose;  ///< on the stage, metres
  /// Where the hand is. The wrist's joints, where a glove measures them, turn the hand from there.
  Eigen::Isometry3d T_stage_wrist = Eigen::Isometry3d::Identity();
  std::uint64_t samples = 0;  ///< received since the loop began
  hand::JointAngles angles{}; ///< the angles of the pose
  SensorMask left_out{};      ///< stuck sensors of its glove, whose angles are estimated
};

/// What an undo or a redo waits for. The loop's owner must request it (DeformLoop::change_to()). No
/// member has a default, so that omissions do not compile.
struct Awaited {
  LoopSettings settings;
  std::uint32_t model;  ///< ModelVersion::number
  std::uint32_t puppet; ///< DeformLoop::puppet()
  friend bool operator==(const Awaited&, const Awaited&) = default;
};

/// The places where hands touch clay, or hold parts.
struct Contacts {
  static constexpr std::size_t most = 128;

  std::array<deform::ClayContact, most> places{};
  std::uint32_t count = 0;

  /// Takes the first of them, up to `most`. Their `body` counts the hands that are present, left
  /// hand first.
  void take(std::span<const deform::ClayContact> contacts) noexcept {
    count = static_cast<std::uint32_t>(std::min(contacts.size(), most));
    std::copy_n(contacts.begin(), count, places.begin());
  }
  std::span<const deform::ClayContact> all() const noexcept { return {places.data(), count}; }
};

struct Frame {
  std::uint64_t tick = 0;      ///< the number of the deadline on the grid; gaps were missed
  std::uint64_t ticks_run = 0; ///< how many ticks have run
  std::uint64_t missed = 0;    ///< how many deadlines were skipped
  LoopSettings settings;       ///< with which this frame was made
  /// How often a commit or a release made permanent what the hands had shaped, and how often a step
  /// was undone: as LoopStats counts them.
  std::uint64_t commits = 0;
  std::uint64_t undos = 0;
  /// How often the shape became the rest shape: at a commit, and where a stroke ended without one,
  /// as with another setting or a contact with clay. One in this frame comes after its fields.
  std::uint64_t rest_changes = 0;
  /// How often the fields did not lead from the previous frame's shape to this one's: at an undo, a
  /// redo or a reset, and in frames that a brush, clay, parts or a puppet shaped without fields. In
  /// the frame that counts one, a reader that applies fields must copy the whole shape.
  std::uint64_t shape_jumps = 0;
  /// How many of `shape_jumps` were moves along the surface, which a reader can follow by
  /// `surface`, without a copy.
  std::uint64_t surface_moves = 0;
  /// How often one can undo, and how often redo, after this frame. At 0 it changes nothing. What
  /// hands that hold the model have shaped since the last commit is a step.
  std::uint64_t undo_steps = 0;
  std::uint64_t redo_steps = 0;
  StepList steps; ///< the names of the last of them
  std::optional<Awaited> awaited;
  std::uint32_t steps_due = 0; ///< undos, redos and resets that wait, the first for `awaited`
  bool held = true;            ///< the hands hold the model; otherwise it is at rest
  HostTime scheduled{};
  HostTime woke{};
  /// The time between the wake-ups of the previous tick and of this one; 0 at first. It differs
  /// from a whole number of periods by lateness.
  HostClock::duration since_last{};
  double units_per_metre = 1.0;   ///< from the stage to the model
  std::array<HandFrame, 2> hands; ///< in the order of Placement::index_of(side)
  deform::FieldStatus status = deform::FieldStatus::ok;
  /// The fields in model units. Those of Type-1 lead from the rest shape to this shape, those of
  /// Type-2 from the shape of the previous frame.
  deform::FieldSequence fields;
  /// What led along the surface from the rest shape to this shape, in place of fields.
  deform::SurfaceMove surface;
  deform::ChainReport chain; ///< how the shape stayed injective; all 0 if that is off
  ClayState clay{};
  PartsState parts{};
  WirePath wire{}; ///< that hands draw, or have drawn last
  Contacts contacts{};
  std::uint32_t model = 0;  ///< the version of the model that `shape` is of
  std::uint32_t puppet = 0; ///< the number of the puppet whose functions made this frame
  /// The values of a puppet's functions, in their order, and how many there are; 0 without a
  /// puppet.
  std::array<float, puppet::Puppet::max_functions> functions{};
  std::uint32_t function_count = 0;
  std::array<bool, 2> let_go{}; ///< in the order of Side: that hand has released all that it plays
  bool symmetric = false;       ///< one hand plays both sides
  /// Which inputs of the loop are layers that play, or are coming in; bit k is input k.
  std::uint32_t layers_on = 0;
  /// The deformed vertices, which DeformLoop::layout(model) turns into points. The stamps show
  /// which blocks differ from those of an earlier frame of the same version.
  deform::BlockShape shape;
};

using FrameExchange = TripleBuffer<Frame>;

/// Takes every frame of a loop. A single reader that needs only the newest frame uses
/// DeformLoop::frames() instead.
class NENDO_API FrameSink {
public:
  virtual ~FrameSink() = default;
  /// Takes a frame. Loop's thread: it is a part of the tick, so it must be wait-free, without
  /// allocation, lock or system call.
  virtual void show(const Frame& frame) noexcept = 0;
};

/// Follows a loop's frames, one after another. A hold begins where `held` becomes true, or where a
/// change of the rest shape or a jump of the shape is counted. Wait-free.
class HoldWatch {
public:
  /// Returns true if the fingertips grabbed in this frame.
  bool follow(const Frame& frame) noexcept {
    const bool has_grabbed = frame.held && (!held_ || frame.rest_changes != rest_changes_ ||
                                            frame.shape_jumps != jumps_);
    held_ = frame.held;
    rest_changes_ = frame.rest_changes;
    jumps_ = frame.shape_jumps;
    return has_grabbed;
  }

private:
  std::uint64_t rest_changes_ = 0;
  std::uint64_t jumps_ = 0;
  bool held_ = false;
};

} // namespace nendo::flow
