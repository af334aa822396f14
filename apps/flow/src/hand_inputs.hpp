#pragma once
// All inputs of a loop: what the gloves and the layers over them make of samples, hand poses.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/flow/frame.hpp>
#include <nendo/flow/glove_hand.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/prepared_change.hpp>
#include <nendo/flow/tick_record.hpp>
#include <nendo/flow/wrist_move.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// For the loop's thread. Only the constructor allocates.
class HandInputs {
public:
  using Hands = puppet::RigPlayer::Hands;

  /// `inputs` must pass check_inputs().
  HandInputs(std::vector<HandInput> inputs, const Placement& placement,
             const LoopSettings& settings);

  std::size_t count() const noexcept { return hands_.size(); }
  std::span<const GloveHand> all() const noexcept { return hands_; }
  const GloveHand& operator[](std::size_t number) const noexcept { return hands_[number]; }
  GloveHand& operator[](std::size_t number) noexcept { return hands_[number]; }

  void move_wrist(const WristMove& move) noexcept;
  void set_layer(const SetLayer& layer) noexcept;
  /// Advances the layers' fades to that deadline. They go by the deadlines, so that a replay does
  /// the same.
  void advance_layers(HostTime scheduled) noexcept;
  /// Changes the filters of all inputs.
  void change_filters(const LoopSettings& settings) noexcept;
  /// Begins as a loop that is made of the present state, which it writes into `state`.
  void begin_anew(LoopState& state) noexcept;

  /// Computes where the hands are now, with all layers over them: null for a side without one. The
  /// pointers are valid until the next call.
  Hands pose() noexcept;
  /// Writes the hands that pose() computed last.
  void show(const LoopStats& stats, Frame& frame) const noexcept;
  /// Counts the samples that an input took out of its ring in this tick.
  void count_samples(std::size_t number, std::size_t samples, HostTime now,
                     HostClock::duration silent_after, LoopStats& stats) noexcept;
  /// Adds the ages of this tick's samples, and the filters' delays.
  void record_latencies(HostTime done, LoopStats& stats) const noexcept;

private:
  hand::JointAngles angles_of(const GloveHand& lowest) const noexcept;
  bool is_silent(std::size_t slot) const noexcept;

  std::vector<GloveHand> hands_;
  std::array<puppet::HandState, 2> states_; ///< by side
  HostTime last_due_{};                     ///< the previous tick's deadline
};

} // namespace nendo::flow
