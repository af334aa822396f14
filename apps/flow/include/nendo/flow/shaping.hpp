#pragma once
// Applies people's requests to a sculptor: the hands take hold and let go, shapes are committed,
// undone and redone. The loop uses it, and so does code that shapes without a loop.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/deform/sculpted_shape.hpp>
#include <nendo/deform/undo_memory.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/request.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::flow {

struct ShapingOptions {
  SculptorSetup sculptor;
  /// The most bytes by which refill_undo() may enlarge the memory for undo beyond
  /// DeformerOptions::undo_bytes; 0 if it is not enlarged.
  std::size_t undo_most_bytes = 0;
  std::size_t most_requests = 64; ///< in one tick
  bool held = true;               ///< at first
  /// The shape at first; null: the rest shape. It has the layout of the rest shape, to which a
  /// reset goes back.
  const deform::BlockShape* first = nullptr;
};

/// Another sculptor for the same shape, made before it is needed.
struct ReadySculptor {
  std::unique_ptr<Sculptor> sculptor;
  LoopSettings settings{};
  /// Room for its fields in the three frames of a FrameExchange, which may have had too little.
  std::array<deform::FieldSequence, 3> room;
};

class Shaping {
public:
  /// rest: 3 by #vertices. Allocates all that a tick needs.
  Shaping(const deform::Points& rest, Eigen::Index control_points, const ShapingOptions& options);

  /// Lets the fingertips take hold for the first time (3 by control_points, model units).
  deform::FieldStatus begin(const deform::Points& tips) noexcept { return sculptor_->grab(tips); }
  /// Tells the time of the next calls, since the beginning.
  void set_time(HostClock::duration time) noexcept { time_ = time; }
  /// Makes the next shape() do it. Wait-free.
  void ask(Request request) noexcept;
  /// Asks for Request::grab if Request::let_go was asked for last, and the other way round.
  void toggle_hold() noexcept { hold_wanted_ = !hold_wanted_; }
  /// Asks for a commit that waits until the hands hold the model.
  void commit_when_held() noexcept { commit_due_ = true; }

  /// Does a tick's work: it does what was asked for, computes the frame's shape, fields, chain and
  /// `held` from the fingertips' places, and counts in `stats`. With `completes`, a stroke leads
  /// all the way to `tips`. Wait-free. It does not allocate if the frame has the right size.
  deform::FieldStatus shape(const deform::Points& tips, Frame& frame, LoopStats& stats,
                            bool completes = false) noexcept;
  /// Completes the stroke and returns the shape, 3 by #vertices. Allocates.
  deform::Points final_shape(const deform::Points& tips);

  bool is_held() const noexcept { return held_; }
  const LoopSettings& settings() const noexcept { return settings_; } ///< in force
  const Sculptor& sculptor() const noexcept { return *sculptor_; }
  const deform::BlockLayout& layout() const noexcept { return shape_.layout(); }

  /// Makes another sculptor. Another thread may call it, at any time. Allocates.
  ReadySculptor prepare(const SculptorSetup& setup);
  /// Lets that sculptor go on where the present one ends, which `ready` then has: after shape()
  /// with `completes`, in the same tick. A stroke ends, and the fingertips take hold anew at
  /// `tips`. Stroke and change are steps of their own; less than a second after the exchange before
  /// they belong to the steps before and behind. If an undo or a redo has waited for these settings
  /// (Frame::awaited), this is it. The shape does not change, but for what the hands have shaped
  /// since the last step, which an undo drops. Wait-free, without allocation.
  void exchange(ReadySculptor& ready, const deform::Points& tips, Frame& frame,
                LoopStats& stats) noexcept;
  /// Ends the stroke, lets undo go back to here and no farther (`fences`), or as far as memory
  /// goes, and lets the fingertips that hold the shape take hold anew, as begin() does. What was
  /// asked for and could not be done is forgotten. Nothing that was before then matters to what
  /// comes, but the shape, and whether it is held. Wait-free, without allocation.
  void begin_anew(const deform::Points& tips, bool fences, Frame& frame, LoopStats& stats) noexcept;

  /// Allocates memory for further undo steps. One thread should call it now and then, at any time.
  /// Returns false if there is no more room, so that the oldest steps will be dropped.
  bool refill_undo() { return undo_memory_ == nullptr || undo_memory_->refill(); }

private:
  struct NotedStep;
  void take_steps(const deform::Points& tips, LoopStats& stats) noexcept;
  bool take_step(Request step, const deform::Points& tips, LoopStats& stats) noexcept;
  bool take_change(Request step, const deform::Points& tips, LoopStats& stats) noexcept;
  void count(Request step, LoopStats& stats) noexcept;
  void step_over_change(Request step, const LoopSettings& before) noexcept;
  bool is_change_next(Request step) const noexcept;
  std::optional<LoopSettings> other_of(Request step) const noexcept;
  void note_change(const LoopSettings& before, bool is_step) noexcept;
  Step step_now(StepKind kind) const noexcept;
  void list_steps(StepList& list) const noexcept;
  std::size_t undo_steps() const noexcept;
  bool is_in_hand() const noexcept;
  void make_room(deform::FieldSequence& fields) noexcept;
  void tell(Frame& frame, LoopStats& stats) const noexcept;

  std::unique_ptr<deform::UndoMemory> undo_memory_; ///< outlives the shape
  deform::SculptedShape shape_;
  Eigen::Index control_points_;
  std::unique_ptr<Sculptor> sculptor_;
  std::array<deform::FieldSequence, 3> room_; ///< for frames that have too little
  bool held_;                                 ///< the fingertips shape the model
  bool hold_wanted_; ///< what is asked for; follows at the next tick that can
  bool commit_due_ = false;
  bool shaped_ = false;                 ///< since the hands took hold, or since the last commit
  std::uint64_t otherwise_ended_ = 0;   ///< strokes, by a change, without a commit
  bool in_step_ = false;                ///< shaped before the last change, and not a step yet
  LoopSettings settings_;               ///< in force
  std::optional<LoopSettings> awaited_; ///< by the first step that is due
  HostClock::duration time_{};
  std::optional<HostClock::duration> exchanged_at_; ///< last
  std::vector<Request> steps_due_;                  ///< undos, redos and resets, in their order
};

} // namespace nendo::flow
