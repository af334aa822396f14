#pragma once
// Changes that the asking thread prepares for a running loop. The tick only swaps pointers.

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

/// A loop's state between two ticks, where all grips end. A loop that begins with this state
/// (LoopOptions::held, and an initial shape) behaves like the loop that continues.
struct LoopState {
  /// One input's state.
  struct Input {
    GloveSample latest{};
    std::optional<hand::LearnedRanges> learned{};
    std::optional<Layer> layer{};
    SensorMask stuck{}; ///< the sensors found to be stuck
  };
  std::vector<Input> inputs{}; ///< in the loop's order
  Placement placement{};
  bool held = true;
  SculptorSetup sculptor{};
  /// The changes from the loop's initial model to the current one, in order.
  std::vector<std::shared_ptr<const ModelOrigin>> origins{};
  puppet::RigState rig{};                      ///< the state of a puppet's player
  std::shared_ptr<const puppet::Rig> puppet{}; ///< the played puppet; null: none
  deform::BlockShape shape;
};

/// A change of the loop's log from a tick on.
struct LogChange {
  InputLog* log = nullptr; ///< null: nowhere
  LoopState state;         ///< the state at the log's beginning, or at its end
  /// Memory for the shape, if the change leads to another version of the model.
  deform::BlockShape of_other_model;
};

/// A puppet that is prepared for playing.
struct ReadyRig {
  std::uint32_t number = 0; ///< ChangeBroker::puppet()
  std::uint32_t before = 0; ///< the number of the one that it replaces
  /// None: hands touch the model. Its held values are 0, or those from when this puppet was last
  /// played.
  std::optional<PuppetPlayer> puppet{};
  std::optional<double> mirror{};  ///< the x of the fingertips' mirror plane, model units
  std::vector<std::size_t> from{}; ///< puppet::functions_before()
  deform::Points tips{};           ///< memory for its points
};

/// The changes that a loop takes at a tick. The loop swaps pointers, and returns the previous
/// objects here.
struct PreparedChange {
  bool holds_still = false; ///< from the end of that tick until the next change with `model`
  std::optional<ChangeModel> model{};     ///< the version that `ready` shapes
  std::optional<LoopSettings> settings{}; ///< the new settings
  SculptorSetup before{};                 ///< the setup that `settings` replace
  bool is_refused = false;                ///< the loop has refused it (Shaping::exchange())
  std::optional<ReadyRig> rig{};          ///< the new puppet
  ReadySculptor ready{};
  std::optional<LogChange> log{};

  bool exchanges() const noexcept { return model || settings || rig; }
  bool is_empty() const noexcept { return !holds_still && !exchanges() && !log; }
  bool ends_stroke() const noexcept { return holds_still || exchanges(); }
};

} // namespace nendo::flow
