#pragma once
// The side of a DeformLoop that belongs to the thread of run(): inputs, core, statistics, frames.

#include <cstdint>
#include <span>
#include <vector>

#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/pacer.hpp>
#include <nendo/flow/prepared_change.hpp>
#include <nendo/flow/shaping_core.hpp>
#include <nendo/flow/wrist.hpp>
#include <nendo/puppet/rig.hpp>

#include "tracked_wrists.hpp"

namespace nendo::flow {

/// All inputs of a loop: gloves and the layers over them, whose samples become hand poses. Loop's
/// thread. Only the constructor allocates.
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

  TrackedWrists& wrists() noexcept { return wrists_; }
  void move_wrist(const WristMove& move) noexcept;
  /// Puts the hands to where trackers have their wrists.
  void follow_trackers() noexcept;
  void set_layer(const SetLayer& layer) noexcept;
  /// Advances the layers' fades to that deadline. They go by the deadlines, so that a replay does
  /// the same.
  void advance_layers(HostTime scheduled) noexcept;
  /// Changes the filters of all inputs.
  void change_filters(const LoopSettings& settings) noexcept;
  /// Begins as a loop that is made of the present state, which it writes into `state`.
  void restart(LoopState& state) noexcept;

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

  TrackedWrists wrists_;
  std::vector<GloveHand> hands_;
  std::array<puppet::HandState, 2> states_; ///< in the order of Side
  HostTime last_due_{};                     ///< the previous tick's deadline
};

class DeformLoop::Ticker {
public:
  Ticker(ChangeBroker& changes, const LoopOptions& options, const CoreOptions& core,
         std::vector<HandInput> hands, const Placement& placement);

  void run(const std::atomic<bool>& stop, std::uint64_t max_ticks) noexcept;
  void tick(const Pacer::Due& due) noexcept;

  FrameExchange& frames() noexcept { return frames_; }
  deform::FieldStatus grab_status() const noexcept { return grab_status_; }
  const LoopStats& stats() const noexcept { return stats_; }
  ShapingCore& core() noexcept { return core_; }

private:
  // In hand_inputs.cpp:
  void take_input(TickRecord& record) noexcept;
  void take_commands(HostTime scheduled) noexcept;
  void take_script(HostTime scheduled) noexcept;
  void take_poses(HostTime woke) noexcept;
  void take_samples(TickRecord& record) noexcept;
  void take(std::uint8_t number, const GloveSample& sample) noexcept;
  void take(Side side, const PoseSample& pose) noexcept;
  void apply(const Command& command) noexcept;
  void update_switches() noexcept;
  // In deform_loop.cpp:
  void begin_change() noexcept;
  void finish_change(Frame& frame) noexcept;
  void end_change() noexcept;
  void describe(const TickRecord& record, Frame& frame) noexcept;
  void record_latencies(const TickRecord& record) noexcept;

  LoopOptions options_;
  JobOffer<PreparedChange*>& changes_;
  ShapingCore core_;
  HandInputs inputs_;
  PreparedChange* change_ = nullptr; ///< that this tick finishes
  bool switch_on_ = false;           ///< any hand's switch, for SwitchAction::grab
  bool draws_in_time_ = false;       ///< as LoopOptions::wire_time says
  HostTime first_due_{};             ///< the first tick's deadline
  HostTime last_woke_{};             ///< the previous tick's; HostTime{} at first
  LoopStats stats_;
  FrameExchange frames_;
  deform::FieldStatus grab_status_ = deform::FieldStatus::ok;
};

} // namespace nendo::flow
