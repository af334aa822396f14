#pragma once
// The loop drains the gloves' rings, computes both hands' fingertips, makes control vectors of
// them, deforms the model and publishes the frame, at a fixed rate.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/base/event_count.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/flow/change_broker.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/flow/input_script.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/pacer.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/flow/wrist.hpp>
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

/// The loop's thread runs its ticks; the asking thread reads frames and asks for changes. Neither
/// waits for the other.
class NENDO_API DeformLoop {
public:
  /// `hands` must pass check_inputs(). Copies the model and allocates all that a tick
  /// needs. The hands grab the model at their first samples. With SwitchAction::grab they hold it
  /// only while a switch is on. With `first`, the shape is at first that one, in the blocks of the
  /// model's layout.
  DeformLoop(const deform::Mesh& model, const Placement& placement,
             const std::vector<HandInput>& hands, const LoopOptions& options,
             const deform::BlockShape* first = nullptr);
  ~DeformLoop();
  DeformLoop(const DeformLoop&) = delete;
  DeformLoop& operator=(const DeformLoop&) = delete;

  /// Runs ticks on the calling thread, which is then the loop's thread, until `stop` or for
  /// `max_ticks` deadlines of the grid, also skipped ones. A tick does not allocate or lock; its
  /// only system call is the sleep. Call make_thread_realtime() first to make wake-ups punctual.
  void run(const std::atomic<bool>& stop,
           std::uint64_t max_ticks = std::numeric_limits<std::uint64_t>::max()) noexcept;
  /// Runs one tick without its sleep, for callers with a clock of their own. Loop's thread.
  void tick(std::uint64_t number, HostTime scheduled) noexcept;
  /// Repeats a tick from an input log. Durations that are measured of it mean nothing.
  void tick(std::uint64_t number, HostTime scheduled, HostTime woke) noexcept;

  /// Changes that the loop takes at the beginning of its next tick. Asking thread.
  ChangeBroker& changes() noexcept { return changes_; }
  const ChangeBroker& changes() const noexcept { return changes_; }

  /// The frames, of which the newest may be taken while the loop runs. Asking thread.
  FrameExchange& frames() noexcept;
  /// Returns ok or merged if the hands could grab the model. Thread-safe.
  deform::FieldStatus grab_status() const noexcept;

  // Loop's thread, or any one when run() has returned:

  const LoopStats& stats() const noexcept;
  /// Returns the last wire whose path is complete. The asking thread finds it in Frame::wire.
  const WirePath& drawn_wire() const noexcept;
  /// Completes the last stroke and returns the shape, 3 by #vertices. Allocates.
  deform::Points final_shape();
  /// Does the same, with the faces of the version that the loop has. Allocates.
  deform::Mesh final_mesh();

private:
  class Ticker;
  DeformLoop(const deform::Mesh& model, const CoreOptions& core,
             const std::vector<HandInput>& hands, const Placement& placement,
             const LoopOptions& options, const deform::BlockShape* first);

  ChangeBroker changes_;           ///< asking thread
  std::unique_ptr<Ticker> ticker_; ///< loop's thread
};

} // namespace nendo::flow
