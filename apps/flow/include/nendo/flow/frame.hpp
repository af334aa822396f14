#pragma once
// What a tick gives to the world, through a lock-free exchange of the latest value: both hands, the
// field, and the deformed vertices.

#include <array>
#include <cstdint>

#include <nendo/base/triple_buffer.hpp>
#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::flow {

struct HandFrame {
  bool present = false; ///< a glove drives this hand
  bool silent = false;  ///< its glove has sent nothing for a while; the pose is frozen
  bool swapped = false; ///< its glove has not the side of HandInput::first
  hand::HandPose pose;  ///< on the stage, metres
  /// Where the hand is; the joints of the wrist, where a glove measures them, turn it from there.
  Eigen::Isometry3d T_stage_wrist = Eigen::Isometry3d::Identity();
  std::uint64_t samples = 0;  ///< received since the loop began
  hand::JointAngles angles{}; ///< of which the pose is made
};

struct Frame {
  std::uint64_t tick = 0;      ///< the number of the deadline on the grid; gaps were missed
  std::uint64_t ticks_run = 0; ///< how many ticks have run
  std::uint64_t missed = 0;    ///< how many deadlines were skipped
  /// How often the shape became the rest shape; a commit of this frame's comes after its fields.
  std::uint64_t commits = 0;
  /// How often it became an earlier one, or that one's successor again (undo, redo); one of this
  /// frame's comes before its fields, which then do not lead here from the frame before: whoever
  /// follows fields takes the shape anew.
  std::uint64_t undos = 0;
  bool held = true; ///< the hands hold the model; otherwise it is at rest
  HostTime scheduled{};
  HostTime woke{};
  /// From the tick before, as both woke; 0 at first. Times the rate it is 1 but for lateness;
  /// `tick` tells how many periods it ought to be.
  HostClock::duration since_last{};
  double units_per_metre = 1.0;   ///< from the stage to the model
  std::array<HandFrame, 2> hands; ///< by Placement::index_of(side)
  deform::FieldStatus status = deform::FieldStatus::ok;
  /// Model units. Type-1: from the rest shape to this one; Type-2: from the frame before to this
  /// one.
  deform::FieldSequence fields;
  deform::ChainReport chain; ///< how the shape stayed injective; all 0 if that is not asked for
  /// The deformed vertices; DeformLoop::layout() makes points of them. Its stamps tell which blocks
  /// differ from those of an earlier frame.
  deform::BlockShape shape;
};

using FrameExchange = TripleBuffer<Frame>;

} // namespace nendo::flow
