#pragma once
// Applies people's requests to a sculptor: the hands take hold and let go, shapes are committed,
// undone and redone. The loop uses it, and so does code that shapes without a loop.

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
  /// The most bytes by which refill_undo() may enlarge the memory for undo beyond
  /// SculptorOptions::deformer.undo_bytes; 0 if it is not enlarged.
  std::size_t undo_most_bytes = 0;
  std::size_t most_requests = 64; ///< in one tick
  bool held = true;               ///< at first
};

class Shaping {
public:
  /// rest: 3 by #vertices. Allocates all that a tick needs.
  Shaping(const deform::Points& rest, Eigen::Index control_points, const ShapingOptions& options);

  /// Lets the fingertips take hold for the first time (3 by control_points, model units).
  deform::FieldStatus begin(const deform::Points& tips) noexcept { return sculptor_.grab(tips); }
  /// Makes the next shape() do it. Wait-free.
  void ask(Request request) noexcept;
  /// Asks for Request::grab if Request::let_go was asked for last, and the other way round.
  void toggle_hold() noexcept { hold_wanted_ = !hold_wanted_; }
  /// Asks for a commit that waits until the hands hold the model.
  void commit_when_held() noexcept { commit_due_ = true; }

  /// Does a tick's work: it does what was asked for, computes the frame's shape, fields, chain and
  /// `held` from the fingertips' places, and counts in `stats`. Wait-free. It does not allocate if
  /// the frame has the right size.
  deform::FieldStatus shape(const deform::Points& tips, Frame& frame, LoopStats& stats) noexcept;
  /// Completes the stroke and returns the shape, 3 by #vertices. Allocates.
  deform::Points final_shape(const deform::Points& tips);

  bool is_held() const noexcept { return held_; }
  const Sculptor& sculptor() const noexcept { return sculptor_; }
  /// Allocates memory for further undo steps. One thread should call it now and then, at any time.
  /// Returns false if there is no more room, so that the oldest steps will be dropped.
  bool refill_undo() { return undo_memory_ == nullptr || undo_memory_->refill(); }

private:
  void take_steps(const deform::Points& tips, LoopStats& stats) noexcept;
  std::size_t undo_steps() const noexcept;

  std::unique_ptr<deform::UndoMemory> undo_memory_; ///< outlives the sculptor
  Sculptor sculptor_;
  bool held_;        ///< the fingertips shape the model
  bool hold_wanted_; ///< what is asked for; follows at the next tick that can
  bool commit_due_ = false;
  bool shaped_ = false;            ///< since the hands took hold, or since the last commit
  std::vector<Request> steps_due_; ///< undos and redos, in their order
};

} // namespace nendo::flow
