#pragma once
// The loop drains the gloves' rings, computes both hands' fingertips, makes control vectors of
// them, deforms the model and publishes the frame, at a fixed rate.

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/flow/change_broker.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/flow/loop_options.hpp>
#include <nendo/flow/loop_stats.hpp>

namespace nendo::flow {

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
