#pragma once
// The loop: at a fixed rate, it drains the gloves' rings, computes fingertips and control vectors,
// deforms the model and publishes the frame.

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

/// The stages of a tick. A measurement may disable some; their results then do not change.
struct TickStages {
  bool input = true;   ///< drains the rings
  bool hands = true;   ///< joints and fingertips
  bool deform = true;  ///< field and vertices
  bool publish = true; ///< passes the frame to the reader and the sinks
};

struct LoopOptions : PaceOptions {
  SculptorOptions sculptor;
  TickStages stages;
  /// Receives each tick's record. A full ring refuses records and counts them (counters()). It must
  /// outlive the loop.
  TickRing* records = nullptr;
  /// The commands, which the loop takes at the beginning of a tick. It must outlive the loop.
  CommandRing* commands = nullptr;
  /// The log to which the loop writes its input, for a recorder. It must outlive the loop.
  InputLog* input_log = nullptr;
  /// Recorded input that the loop takes in its ticks, before live input. It must outlive the
  /// loop.
  InputScript* script = nullptr;
  /// The times of an automatic DrawWire, since the first tick's deadline.
  struct WireTime {
    double from_s = 0.0, to_s = 0.0;
    Blade blade = Blade::wire;
  };
  std::optional<WireTime> wire_time{};
  std::size_t undo_max_bytes = 0; ///< UndoSpace::max_bytes for all versions together
  /// The sinks of every frame. They must outlive the loop.
  std::vector<FrameSink*> sinks;
  /// Is notified of each sample. OverrunPolicy::sample needs it. It must outlive the loop.
  EventCount* event_count = nullptr;
  HostClock::duration silent_after = std::chrono::milliseconds(500);
  SwitchAction switch_action = SwitchAction::none;
  /// Whether the hands initially hold the model; nothing: true unless switch_action is
  /// SwitchAction::grab.
  std::optional<bool> held{};
  /// The puppet of this model that hands play: its functions move its points, and fingertips do not
  /// touch the model. The supports are those of the points. A puppet without points
  /// (puppet::Puppet::is_played()) has masks for fingertips, and optionally a mirror, with which
  /// the supports are those of_both_sides(). If it measures distances along the surface,
  /// sculptor.surface is its surface_for(), or null: the loop then makes it.
  std::shared_ptr<const puppet::Rig> rig{};
  puppet::RigState rig_state{}; ///< its player's initial state
  /// The initial settings, if settings_of() the sculptor and filter would be less exact.
  std::optional<LoopSettings> settings{};

  bool begins_held() const noexcept { return held.value_or(switch_action != SwitchAction::grab); }
};

/// The loop's thread runs its ticks; the asking thread reads frames and requests changes. Neither
/// waits for the other.
class NENDO_API DeformLoop {
public:
  /// `hands` must pass check_inputs(). Copies the model and allocates all that a tick needs. The
  /// hands grab the model at their first samples. With SwitchAction::grab they hold it only while a
  /// switch is on. `first`, if given, is the initial shape, in the blocks of the model's layout.
  DeformLoop(const deform::Mesh& model, const Placement& placement,
             const std::vector<HandInput>& hands, const LoopOptions& options,
             const deform::BlockShape* first = nullptr);
  ~DeformLoop();
  DeformLoop(const DeformLoop&) = delete;
  DeformLoop& operator=(const DeformLoop&) = delete;

  /// Runs ticks on the calling thread, which is then the loop's thread, until `stop` or for
  /// `max_ticks` deadlines of the grid, skipped ones included. A tick does not allocate or lock;
  /// its only system call is the sleep. Call make_thread_realtime() first, for low wake-up latency.
  void run(const std::atomic<bool>& stop,
           std::uint64_t max_ticks = std::numeric_limits<std::uint64_t>::max()) noexcept;
  /// Runs one tick without sleep, for callers with their own clock. Loop's thread.
  void tick(std::uint64_t number, HostTime scheduled) noexcept;
  /// Replays a tick of an input log. Its measured durations have no meaning.
  void tick(std::uint64_t number, HostTime scheduled, HostTime woke) noexcept;

  /// Changes that the loop takes at the beginning of its next tick. Asking thread.
  ChangeBroker& changes() noexcept { return changes_; }
  const ChangeBroker& changes() const noexcept { return changes_; }

  /// The frames. A reader can take the newest one while the loop runs. Asking thread.
  FrameExchange& frames() noexcept;
  /// Returns the first grab's status: ok or merged on success. Thread-safe.
  deform::FieldStatus grab_status() const noexcept;

  // Loop's thread, or any thread after run() has returned:

  const LoopStats& stats() const noexcept;
  /// Returns the last completed wire. The asking thread uses Frame::wire.
  const WirePath& drawn_wire() const noexcept;
  /// Completes the last stroke and returns the shape, 3 by #vertices. Allocates.
  deform::Points final_shape();
  /// Does the same, with the faces of the loop's version. Allocates.
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
