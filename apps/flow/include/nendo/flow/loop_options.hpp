#pragma once
// The options of a DeformLoop: its pace, its rings, and its first settings.

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/base/event_count.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/input_log.hpp>
#include <nendo/flow/input_script.hpp>
#include <nendo/flow/pacer.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/flow/tick_record.hpp>
#include <nendo/flow/wrist_switch.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// The stages of a tick. A measurement may leave some out; their results then stay as they were.
struct TickStages {
  bool input = true;   ///< drains the rings
  bool hands = true;   ///< joints and fingertips
  bool deform = true;  ///< field and vertices
  bool publish = true; ///< gives the frame to the reader and the sinks
};

struct LoopOptions : PaceOptions {
  SculptorOptions sculptor;
  TickStages stages;
  /// The ring that gets every tick's record, or refuses and counts it (counters()) if it is full.
  /// It must outlive the loop.
  TickRing* records = nullptr;
  /// The commands, which the loop takes at the beginning of a tick. It must outlive the loop.
  CommandRing* commands = nullptr;
  /// The log to which the loop writes its input, for a recorder. It must outlive the loop.
  InputLog* input_log = nullptr;
  /// Recorded input that the loop takes in its ticks, before live input. It must outlive the
  /// loop.
  InputScript* script = nullptr;
  /// When a wire or knife is drawn (DrawWire) by itself, since the first tick was due.
  struct WireTime {
    double from_s = 0.0, to_s = 0.0;
    Blade blade = Blade::wire;
  };
  std::optional<WireTime> wire_time{};
  std::size_t undo_max_bytes = 0; ///< UndoSpace::max_bytes, of all versions together
  /// The sinks that are shown every frame. They must outlive the loop.
  std::vector<FrameSink*> sinks;
  /// Is notified of each sample that comes; OverrunPolicy::sample needs it. It must outlive the
  /// loop.
  EventCount* event_count = nullptr;
  HostClock::duration silent_after = std::chrono::milliseconds(500);
  SwitchAction switch_action = SwitchAction::none;
  /// Whether the hands hold the model at first; nothing: unless SwitchAction::grab waits for a
  /// switch.
  std::optional<bool> held{};
  /// A puppet: the hands play its functions, which move its points, in place of touching the model
  /// with their fingertips. The supports are then those of the points. It must be of this model.
  /// One without points (puppet::Puppet::is_played()) has masks for the fingertips, and perhaps a
  /// mirror, with which the supports are those of_both_sides().
  /// Where its distances are along the surface, sculptor.surface is surface_for() it, or null: the
  /// loop then makes that itself.
  std::shared_ptr<const puppet::Rig> rig{};
  puppet::RigState rig_state{}; ///< its player's first state
  /// The settings at first, if settings_of() the sculptor and the filter would be less exact.
  std::optional<LoopSettings> settings{};

  bool begins_held() const noexcept { return held.value_or(switch_action != SwitchAction::grab); }
};

} // namespace nendo::flow
