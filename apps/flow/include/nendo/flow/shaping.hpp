#pragma once
// Applies people's requests to a sculptor: the hands take hold and let go, shapes are committed,
// undone and redone. The loop uses it, and so does code that shapes without a loop.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/flow/frame.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/model_version.hpp>
#include <nendo/flow/request.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::flow {

struct ShapingOptions {
  SculptorSetup sculptor;
  std::size_t most_requests = 64; ///< in one tick
  bool held = true;               ///< at first
  bool pull_is_step = true;       ///< as LoopOptions::pull_is_step
  /// What an undo or a redo awaits (Frame::awaited) comes in the same tick, whose shape() therefore
  /// completes the stroke.
  bool changes_at_once = false;
};

/// Another sculptor, made before it is needed.
struct ReadySculptor {
  ModelVersion* model = nullptr; ///< that it works on
  bool is_new_model = false;     ///< and that no step leads to yet
  std::unique_ptr<Sculptor> sculptor;
  LoopSettings settings{};
  std::uint32_t puppet = 0;                ///< that moves its control points
  StepKind puppet_step = StepKind::puppet; ///< what it is a change of
  /// With another puppet, in type 1: the hands hold the shape at `starts`, as they held it, in
  /// place of beginning anew where they are. So only what the edit asks for changes.
  bool holds_on = false;
  deform::Points starts{};     ///< 3 by #control points
  deform::Points still_tips{}; ///< room for so many of them
  /// Where they are at the exchange, if there are others than before (Hold): the caller of
  /// exchange() writes them.
  deform::Points tips{};
  /// Room for its fields in the three frames of a FrameExchange, which may have had too little.
  std::array<deform::FieldSequence, 3> room;
  std::array<deform::SurfaceMove, 3> surface_room; ///< likewise, for what a puppet tells
  struct ShapeRoom {
    static constexpr std::uint32_t none = 0xFFFFFFFF;
    std::uint32_t model = none;
    deform::BlockShape shape;
  };
  /// Room for the shapes of another version of the model in these frames.
  std::array<ShapeRoom, 3> shape_room;
};

class Shaping {
public:
  /// Shapes that model, which must outlive this, as must all others that come in its place.
  /// Allocates all that a tick needs.
  Shaping(ModelVersion& model, Eigen::Index control_points, const ShapingOptions& options);

  /// Lets the fingertips take hold for the first time (3 by control_points, model units).
  deform::FieldStatus begin(const deform::Points& tips) noexcept { return sculptor_->grab(tips); }
  /// Tells the time of the next calls, since the beginning.
  void set_time(HostClock::duration time) noexcept { time_ = time; }
  /// Makes the next shape() do it. Wait-free. Request::take_hold freezes the start points anew
  /// where the fingertips of hands that hold the model are, as the paper's Type-1 keeps it apart
  /// from a commit (2.3.1). In type 1 the rest shape stays what it was, and so the shape is the
  /// rest shape again: what was pulled is taken back, and a redo brings it back. In type 2 the
  /// shape stays as it is, and what is shaped before and after is one step; of the way to the next
  /// piece, which was not made yet, nothing is made.
  /// It waits while an undo or a redo does (Frame::awaited).
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
  bool is_still() const noexcept { return is_still_; }
  const ModelVersion& model() const noexcept { return *model_; } ///< in force
  std::uint32_t puppet() const noexcept { return puppet_; }      ///< in force
  const deform::BlockLayout& layout() const noexcept { return model_->layout(); }

  /// Lets the hands stop shaping, after shape() with `completes` and in the same tick. What they
  /// have shaped is a step, and what is asked for meanwhile waits. When another version comes, they
  /// take hold of it at the places where they stopped, so that nothing of their way is lost.
  /// Wait-free, without allocation.
  void hold_still(const deform::Points& tips, Frame& frame, LoopStats& stats) noexcept;
  /// Puts another sculptor with that many control points into `ready`, for that version of the
  /// model. Another thread may call it,
  /// at any time. For a version that is not in force, the caller makes `shape_room`. Allocates.
  static void prepare(const SculptorSetup& setup, ModelVersion& model, Eigen::Index control_points,
                      ReadySculptor& ready);
  /// Tells whether exchange() lets the hands hold on to the shape with that puppet.
  bool holds_on(const ReadySculptor& ready) const noexcept;
  /// Lets that sculptor go on where the present one ends, which `ready` then has: after shape()
  /// with `completes`, in the same tick. A stroke ends, and the fingertips take hold anew at
  /// `tips`, or at `ready.tips` if it has other control points. Stroke and change are steps of
  /// their own; less than a second after the exchange before they belong to the steps before and
  /// behind. If an undo or a redo has waited for these settings (Frame::awaited), this is it. The
  /// shape does not change, but for what the hands have shaped since the last step, which an undo
  /// drops. Another version of the model is always a step, and the frame then shows it. Returns
  /// false, and goes on as it was, if another version is not new, and no undo or redo waits for it
  /// any more. Wait-free, without allocation.
  bool exchange(ReadySculptor& ready, const deform::Points& tips, Frame& frame,
                LoopStats& stats) noexcept;
  /// Ends the stroke, lets undo go back to here and no farther (`fences`), or as far as memory
  /// goes, and lets the fingertips that hold the shape take hold anew, as begin() does. What was
  /// asked for and could not be done is forgotten. Nothing that was before then matters to what
  /// comes, but the shape, and whether it is held. Wait-free, without allocation.
  void begin_anew(const deform::Points& tips, bool fences, Frame& frame, LoopStats& stats) noexcept;

private:
  /// What exchange() makes of a change.
  enum class Exchange : std::uint8_t {
    awaited_step, ///< the undo or redo that has waited for it (Frame::awaited)
    new_step,
    same_step, ///< belongs to the step of the change less than a second before
    refused    ///< leads to another version that no undo or redo waits for any more
  };

  Awaited in_force() const noexcept { return {settings_, model_->number, puppet_}; }
  deform::FieldStatus shape_by_hands(const deform::Points& tips, Frame& frame, LoopStats& stats,
                                     bool completes) noexcept;
  deform::FieldStatus show_rest(Frame& frame) noexcept;
  // In clay, a stroke is a contact: from the first touch until the hands have left.
  void tell_hands(Frame& frame) const noexcept;
  void follow_clay(const ClayState& clay, LoopStats& stats) noexcept;
  bool have_hands_left() const noexcept;
  void end_stroke_of_hands(const deform::Points& tips) noexcept;
  bool is_pulled() const noexcept;
  bool is_in_hand() const noexcept;
  void take_hold_anew(const deform::Points& tips) noexcept;
  void make_room(Frame& frame) noexcept;
  Exchange decide(const ReadySculptor& ready) const noexcept;
  void end_stroke(Exchange kind, bool holds_on) noexcept;
  void make_awaited_step(ReadySculptor& ready, LoopStats& stats) noexcept;
  void make_change(ReadySculptor& ready, Exchange kind) noexcept;
  const deform::Points& held_points(const ReadySculptor& ready, const deform::Points& tips,
                                    bool holds_on) const noexcept;
  void go_on_with(ReadySculptor& ready) noexcept;
  void tell(Frame& frame, LoopStats& stats) noexcept;
  // In shaping_steps.cpp:
  void take_steps(const deform::Points& tips, LoopStats& stats) noexcept;
  bool take_step(Request step, const deform::Points& tips, LoopStats& stats) noexcept;
  bool take_change(Request step, const deform::Points& tips, LoopStats& stats) noexcept;
  void count(Request step, LoopStats& stats) noexcept;
  static void step_over_change(Request step, ModelVersion& version, const Awaited& before) noexcept;
  void step_to(Request step, ModelVersion& next, const Awaited& before) noexcept;
  bool is_change_next(Request step) const noexcept;
  std::optional<Awaited> other_of(Request step) const noexcept;
  void note_settings(const LoopSettings& before, bool is_step) noexcept;
  void note_model(ModelVersion& next, const LoopSettings& before) noexcept;
  void note_puppet(const Awaited& before, StepKind kind) noexcept;
  Step step_now(StepKind kind) const noexcept;
  const ModelVersion* version_before(const ModelVersion& version) const noexcept;
  std::size_t steps_to_undo() const noexcept;
  std::size_t steps_to_redo() const noexcept;
  std::size_t undo_steps() const noexcept;
  void forget_later() noexcept;
  void list_undoable(StepList& list) const noexcept;
  void list_undone(StepList& list) const noexcept;
  void list_steps(StepList& list) const noexcept;

  ModelVersion* model_;
  ModelVersion* fenced_ = nullptr; ///< undo goes back to the fence there and no farther
  std::unique_ptr<Sculptor> sculptor_;
  std::array<deform::FieldSequence, 3> room_; ///< for frames that have too little
  std::array<deform::SurfaceMove, 3> surface_room_;
  std::array<ReadySculptor::ShapeRoom, 3> shape_room_;
  deform::Points still_tips_; ///< where the hands stopped, if is_still_
  bool is_still_ = false;
  bool pull_is_step_;
  bool changes_at_once_;
  bool held_;        ///< the fingertips shape the model
  bool hold_wanted_; ///< what is asked for; follows at the next tick that can
  bool commit_due_ = false;
  bool anew_due_ = false;             ///< Request::take_hold
  bool shaped_ = false;               ///< since the hands took hold, or since the last commit
  std::uint64_t otherwise_ended_ = 0; ///< strokes, by a change, without a commit
  std::uint64_t shape_jumps_ = 0;     ///< Frame::shape_jumps
  std::uint64_t surface_moves_ = 0;   ///< Frame::surface_moves
  bool in_step_ = false;              ///< shaped before the last change, and not a step yet
  LoopSettings settings_;             ///< in force
  std::uint32_t puppet_ = 0;          ///< in force
  std::optional<Awaited> awaited_;    ///< by the first step that is due
  HostClock::duration time_{};
  std::optional<HostClock::duration> exchanged_at_; ///< last
  std::optional<HostClock::duration> touched_at_;   ///< clay, last
  std::vector<Request> steps_due_;                  ///< undos, redos and resets, in their order
};

} // namespace nendo::flow
