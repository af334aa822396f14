#pragma once
// What another thread makes for a loop that runs, and hands to it ready. The loop's tick only swaps
// pointers.

#include <optional>
#include <vector>

#include <nendo/flow/input_log.hpp>
#include <nendo/flow/layer.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/flow/shaping.hpp>
#include <nendo/hand/range_adaptation.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// Where a loop is between two ticks, without the hands' grip, which ends there. A loop that is
/// made of this (LoopOptions::held, and a first shape) does the same as the one that goes on.
struct LoopState {
  /// Of an input of the loop.
  struct Input {
    GloveSample latest{};
    std::optional<hand::LearnedRanges> learned{};
    std::optional<Layer> layer{};
  };
  std::vector<Input> inputs{}; ///< in the loop's order
  Placement placement{};       ///< without the gaps
  bool held = true;
  SculptorSetup sculptor{};
  std::uint32_t subdivisions = 0; ///< of the model with which the loop began
  puppet::RigState rig{};         ///< of a puppet's player
  deform::BlockShape shape;
};

/// Where the loop's input goes from a tick on.
struct LogChange {
  InputLog* log = nullptr; ///< null: nowhere
  LoopState state;         ///< with which the log begins, or that it led to
};

/// What a loop goes on with from a tick on. It swaps pointers, and gives back what it had before.
struct PreparedChange {
  bool holds_still = false; ///< at the end of that tick, until the next change with a `model`
  std::optional<ChangeModel> model{};     ///< the version that `ready` works on
  std::optional<LoopSettings> settings{}; ///< the loop goes on with them
  SculptorSetup before{};                 ///< which this change of settings replaces
  bool is_refused = false; ///< by the loop, which goes on as it was (Shaping::exchange())
  ReadySculptor ready{};
  std::optional<LogChange> log{};

  bool is_empty() const noexcept { return !holds_still && !model && !settings && !log; }
  bool ends_stroke() const noexcept { return holds_still || model || settings; }
};

} // namespace nendo::flow
