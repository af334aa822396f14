#pragma once
// The result of a tick: both hands, the field, and the deformed vertices. It is published through a
// lock-free exchange of the latest value, and to sinks that receive every frame.

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
#include <nendo/hand/wrist_tracking.hpp>
#include <nendo/puppet/puppet.hpp>

namespace nendo::flow {

struct HandFrame {
  bool present = false; ///< a glove drives this hand
  bool silent = false; ///< its glove sent nothing for LoopOptions::silent_after; the pose is frozen
  bool tracked = false; ///< a tracker moves its wrist
  bool lost = false;    ///< the tracker delivers no good pose of the wrist, which is frozen
  bool swapped = false; ///< its glove's side differs from that of HandInput::first
  hand::HandPose pose;  ///< on the stage, metres
  /// The hand's pose on the stage. Measured wrist joints, if any, rotate the hand relative to it.
  Eigen::Isometry3d T_stage_wrist = Eigen::Isometry3d::Identity();
  std::uint64_t samples = 0;  ///< received since the loop began
  HostTime newest_sample{};   ///< the arrival of the newest sample
  HostTime sampled{};         ///< when the newest sample was measured
  hand::JointAngles angles{}; ///< the angles of the pose
  SensorMask sensors{};       ///< the sensors in the newest sample
  SensorMask left_out{};      ///< stuck sensors of its glove, whose angles are estimated
  WristSwitch wrist_switch = WristSwitch::unknown; ///< in the newest sample
  hand::TrackingCounts pose_counts; ///< the poses of a tracked wrist since the loop began
  HostTime newest_pose{}; ///< the arrival of the newest good pose of the wrist; 0: none came
  HostTime tracked_at{};  ///< when that pose was measured
};

/// The change that an undo or a redo waits for. The loop's owner must request it
/// (ChangeBroker::change_to()). No member has a default, so that omissions do not compile.
struct Awaited {
  LoopSettings settings;
  std::uint32_t model;  ///< ModelVersion::number
  std::uint32_t puppet; ///< ChangeBroker::puppet()
  friend bool operator==(const Awaited&, const Awaited&) = default;
};

/// The contacts of hands with clay or with held parts.
struct Contacts {
  static constexpr std::size_t max_count = 128;

  std::array<deform::ClayContact, max_count> places{};
  std::uint32_t count = 0;

  /// Copies the first `max_count` contacts. Their `body` is an index of the present hands, left
  /// hand first.
  void take(std::span<const deform::ClayContact> contacts) noexcept {
    count = static_cast<std::uint32_t>(std::min(contacts.size(), max_count));
    std::copy_n(contacts.begin(), count, places.begin());
  }
  std::span<const deform::ClayContact> all() const noexcept { return {places.data(), count}; }
};

struct Frame {
  std::uint64_t tick = 0;      ///< the number of the deadline on the grid; missed ones leave gaps
  std::uint64_t ticks_run = 0; ///< the number of ticks that have run
  std::uint64_t missed = 0;    ///< the number of skipped deadlines
  LoopSettings settings;       ///< the settings of this frame
  /// The numbers of commits, which releases also cause, and of undone steps, as in LoopStats.
  std::uint64_t commits = 0;
  std::uint64_t undos = 0;
  /// How often the shape became the rest shape: at a commit, and where a stroke ended without one,
  /// as by a change of settings or a contact with clay. A change in this frame follows its fields.
  std::uint64_t rest_changes = 0;
  /// The number of frames whose fields do not describe the step from the previous shape: after an
  /// undo, redo or reset, and where a brush, clay, parts or a puppet shaped without fields. When it
  /// increases, a reader that applies fields must copy the whole shape.
  std::uint64_t shape_jumps = 0;
  /// The number of `shape_jumps` that a reader can follow by `surface`, without a copy.
  std::uint64_t surface_moves = 0;
  /// The numbers of steps that can be undone and redone after this frame. The shaping of holding
  /// hands since the last commit is a step.
  std::uint64_t undo_steps = 0;
  std::uint64_t redo_steps = 0;
  StepList steps; ///< the last of these steps
  std::optional<Awaited> awaited;
  std::uint32_t steps_due = 0; ///< pending undos, redos and resets; the first waits for `awaited`
  bool held = true;            ///< the hands hold the model; otherwise it is at rest
  HostTime scheduled{};
  HostTime woke{};
  /// The time between the wake-ups of the previous tick and this one; 0 in the first. Lateness
  /// makes it differ from whole periods.
  HostClock::duration since_last{};
  double units_per_metre = 1.0;   ///< model units per metre of the stage
  std::array<HandFrame, 2> hands; ///< in the order of Placement::index_of(side)
  deform::FieldStatus status = deform::FieldStatus::ok;
  /// The fields in model units. In type 1 they displace the rest shape, in type 2 the shape of the
  /// previous frame.
  deform::FieldSequence fields;
  /// The move along the surface from the rest shape to this shape, in place of fields.
  deform::SurfaceMove surface;
  deform::ChainReport chain; ///< the report on injectivity; all 0 if `injective` is off
  ClayState clay{};
  PartsState parts{};
  WirePath wire{}; ///< the current wire, or the last one
  Contacts contacts{};
  std::uint32_t model = 0;  ///< the model version of `shape`
  std::uint32_t puppet = 0; ///< the number of the puppet whose functions made this frame
  /// The values of the puppet's functions, in their order, and their number; 0 without a puppet.
  std::array<float, puppet::Puppet::max_functions> functions{};
  std::uint32_t function_count = 0;
  std::array<bool, 2>
      released{};         ///< index: Side; the hand has released all functions that it plays
  bool symmetric = false; ///< one hand plays both sides
  /// The inputs that are layers, and on or fading in; bit k is input k.
  std::uint32_t layers_on = 0;
  /// The deformed vertices. ChangeBroker::layout(model) converts them to points. The stamps show
  /// which blocks differ from those of another frame of the same version.
  deform::BlockShape shape;
};

using FrameExchange = TripleBuffer<Frame>;

/// The max contents of a loop's frames, with any settings.
struct FrameCapacity {
  std::size_t fields = 0;
  std::size_t functions = 0; ///< functions per field
  std::size_t vectors = 0;   ///< vectors of deform::SurfaceMove
};

/// Receives every frame of a loop. A single reader that needs only the newest frame uses
/// DeformLoop::frames() instead.
class NENDO_API FrameSink {
public:
  virtual ~FrameSink() = default;
  /// Loop's thread: it is a part of the tick, so it must be wait-free, without allocation, lock or
  /// system call.
  virtual void show(const Frame& frame) noexcept = 0;
};

/// Detects grabs in a loop's sequence of frames: `held` becomes true, or rest_changes or
/// shape_jumps increases while it is true. Wait-free.
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
