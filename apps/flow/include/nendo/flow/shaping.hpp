#pragma once
// Applies people's requests to a sculptor: the hands take hold and let go, shapes are committed,
// undone and redone. The loop has one, and so has whoever shapes without a loop.

#include <memory>
#include <vector>

#include <nendo/deform/undo_memory.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/request.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::flow {

struct ShapingOptions {
  SculptorOptions sculptor;
  /// As far as memory for undo may grow beyond SculptorOptions::deformer.undo_bytes, by
  /// refill_undo(); 0: it does not.
  std::size_t undo_most_bytes = 0;
  std::size_t most_requests = 64; ///< in one tick
  bool held = true;               ///< at first
};

class Shaping {
public:
  /// rest: 3 by #vertices. All that a tick needs is allocated here.
  Shaping(const deform::Points& rest, Eigen::Index control_points, const ShapingOptions& options);

  /// The fingertips take hold for the first time (3 by control_points, model units).
  deform::FieldStatus begin(const deform::Points& tips) noexcept { return sculptor_.grab(tips); }
  /// The next shape() does it. Wait-free.
  void ask(Request request) noexcept;
  /// Asks for Request::grab if Request::let_go was asked for last, and the other way round.
  void toggle_hold() noexcept { hold_wanted_ = !hold_wanted_; }
  /// A commit that waits until the hands hold the model.
  void commit_when_held() noexcept { commit_due_ = true; }

  /// A tick: does what was asked for, and makes of the fingertips' places the frame's shape,
  /// fields, chain and `held`; counts in `stats`. Wait-free, no allocation if the frame has the
  /// size.
  deform::FieldStatus shape(const deform::Points& tips, Frame& frame, LoopStats& stats) noexcept;
  /// Completes the stroke and returns the shape, 3 by #vertices. Allocates.
  deform::Points final_shape(const deform::Points& tips);

  bool is_held() const noexcept { return held_; }
  const Sculptor& sculptor() const noexcept { return sculptor_; }
  /// To be called now and then, at any time, by one thread. Allocates. False: there is no more
  /// room, and the oldest steps go.
  bool refill_undo() { return undo_memory_ == nullptr || undo_memory_->refill(); }

private:
  void take_steps(const deform::Points& tips, LoopStats& stats) noexcept;

  std::unique_ptr<deform::UndoMemory> undo_memory_; ///< outlives the sculptor
  Sculptor sculptor_;
  bool held_;        ///< the fingertips shape the model
  bool hold_wanted_; ///< what is asked for; follows at the next tick that can
  bool commit_due_ = false;
  std::vector<Request> steps_due_; ///< undos and redos, in their order
};

} // namespace nendo::flow
