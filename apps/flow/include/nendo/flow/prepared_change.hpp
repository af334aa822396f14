#pragma once
// Changes that another thread prepares for a running loop, whose tick only swaps pointers.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/flow/hand_input.hpp>
#include <nendo/flow/input_script.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/flow/puppet_player.hpp>
#include <nendo/flow/shaping.hpp>
#include <nendo/hand/range_adaptation.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// A loop's state between two ticks. Grips are not included, because they end there. A loop that is
/// made of this (LoopOptions::held, and a first shape) does the same as the one that continues.
struct LoopState {
  /// One input's state.
  struct Input {
    GloveSample latest{};
    std::optional<hand::LearnedRanges> learned{};
    std::optional<Layer> layer{};
    SensorMask stuck{}; ///< sensors that were found stuck
  };
  std::vector<Input> inputs{}; ///< in the loop's order
  Placement placement{};
  bool held = true;
  SculptorSetup sculptor{};
  /// How the model came from the one with which the loop began, the first change first.
  std::vector<std::shared_ptr<const ModelOrigin>> origins{};
  puppet::RigState rig{};                      ///< the state of a puppet's player
  std::shared_ptr<const puppet::Rig> puppet{}; ///< that is played; null: none
  deform::BlockShape shape;
};

/// A change of the loop's log from a tick on.
struct LogChange {
  InputLog* log = nullptr; ///< null: nowhere
  LoopState state;         ///< at the log's beginning, or at its end
  /// Memory for the shape, if the change leads to another version of the model.
  deform::BlockShape of_other_model;
};

/// Another puppet, ready to be played.
struct ReadyRig {
  std::uint32_t number = 0; ///< ChangeBroker::puppet()
  std::uint32_t before = 0; ///< the number of the one that it replaces
  /// None: hands touch the model. The values at which the hands hold its functions are 0, or what
  /// they were when this puppet was played before.
  std::optional<PuppetPlayer> puppet{};
  std::optional<double> mirror{};  ///< fingertips shape both sides of this x, model units
  std::vector<std::size_t> from{}; ///< puppet::functions_before()
  deform::Points tips{};           ///< memory for the positions of its points
};

/// The changes that a loop takes at a tick. It swaps pointers, and returns the previous ones here.
struct PreparedChange {
  bool holds_still = false; ///< at the end of that tick, until the next change with a `model`
  std::optional<ChangeModel> model{};     ///< the version that `ready` works on
  std::optional<LoopSettings> settings{}; ///< the loop continues with them
  SculptorSetup before{};                 ///< which this change of settings replaces
  bool is_refused =
      false; ///< the loop has refused it, and continues as it was (Shaping::exchange())
  std::optional<ReadyRig> rig{}; ///< the hands continue with that puppet
  ReadySculptor ready{};
  std::optional<LogChange> log{};

  bool exchanges() const noexcept { return model || settings || rig; }
  bool is_empty() const noexcept { return !holds_still && !exchanges() && !log; }
  bool ends_stroke() const noexcept { return holds_still || exchanges(); }
};

} // namespace nendo::flow
