#pragma once
// Applies requests to a sculptor: grab, release, commit, undo, redo. For the loop, and for code
// that shapes without a loop.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/flow/command.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/model_version.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::flow {

struct ShapingOptions {
  std::size_t max_requests = 64; ///< max pending undos, redos and resets; further ones are refused
  bool held = true;              ///< initially
  /// The caller applies the change that an undo or a redo awaits (Frame::awaited) in the same tick,
  /// so shape() completes the stroke.
  bool changes_at_once = false;
};

/// A prepared sculptor.
struct ReadySculptor {
  ModelVersion* model = nullptr; ///< the sculptor's model
  bool is_new_model = false;     ///< no undo step leads to that model yet
  std::unique_ptr<Sculptor> sculptor;
  LoopSettings settings{};
  std::uint32_t puppet = 0;                ///< the puppet that moves the control points
  StepKind puppet_step = StepKind::puppet; ///< the kind of the puppet's change
  /// With another puppet, in type 1: the hands keep their grip at `starts` instead of re-grabbing,
  /// so that only the edit changes the shape.
  bool holds_on = false;
  deform::Points starts{};     ///< 3 by #control points
  deform::Points still_tips{}; ///< memory for the control points
  /// The control points at the exchange, if their count changes (Hold). The caller of exchange()
  /// writes them.
  deform::Points tips{};
  /// Memory for the sculptor's fields in the three frames of a FrameExchange.
  std::array<deform::FieldSequence, 3> spare_fields;
  std::array<deform::SurfaceMove, 3> spare_moves; ///< the same for moves along the surface
  struct SpareShape {
    static constexpr std::uint32_t none = 0xFFFFFFFF;
    std::uint32_t model = none;
    deform::BlockShape shape;
  };
  /// Memory for the shapes of another version of the model in these frames.
  std::array<SpareShape, 3> spare_shapes;
};

/// Loop's thread, or the thread of a player without a loop, except prepare().
class NENDO_API Shaping {
public:
  /// `model` and all later models must outlive this. Allocates all that a tick needs.
  Shaping(ModelVersion& model, const SculptorSetup& setup, Eigen::Index control_points,
          const ShapingOptions& options);

  /// Grabs the model for the first time, at `tips` (3 by control_points, model units).
  deform::FieldStatus begin(const deform::Points& tips) noexcept { return sculptor_->grab(tips); }
  /// Sets the time of the next calls, since the first tick.
  void set_time(HostClock::duration time) noexcept { time_ = time; }
  /// Requests an action of the next shape(). Wait-free. Request::regrab makes hands that hold
  /// the model re-grab it at the current fingertips; the paper separates this from a commit
  /// (2.3.1). In type 1 it undoes the current deformation, which a redo restores, and keeps the
  /// rest shape. In type 2 it keeps the shape, joins the strokes before and after into one step,
  /// and drops the path to the next piece. It waits while an undo or a redo waits (Frame::awaited).
  void ask(Request request) noexcept;
  /// Requests a release if the last request was a grab, or else a grab.
  void toggle_hold() noexcept { hold_wanted_ = !hold_wanted_; }
  /// Requests a commit that waits until the hands hold the model.
  void commit_when_held() noexcept { commit_due_ = true; }

  /// Does a tick's work: executes requests, computes the frame's shape, fields, chain and `held`
  /// from `tips`, and counts in `stats`. With `completes`, a stroke is completed up to `tips`.
  /// Wait-free. Does not allocate if the frame has the right size.
  deform::FieldStatus shape(const deform::Points& tips, Frame& frame, LoopStats& stats,
                            bool completes = false) noexcept;
  /// Completes the stroke and returns the shape, 3 by #vertices. Allocates.
  deform::Points final_shape(const deform::Points& tips);

  bool is_held() const noexcept { return held_; }
  const LoopSettings& settings() const noexcept { return settings_; } ///< in effect
  const Sculptor& sculptor() const noexcept { return *sculptor_; }
  bool is_still() const noexcept { return is_still_; }
  const ModelVersion& model() const noexcept { return *model_; } ///< in effect
  const deform::BlockLayout& layout() const noexcept { return model_->layout(); }

  /// Stops the hands from shaping. Call it after shape() with `completes`, in the same tick. Their
  /// shaping becomes a step, and requests wait. The hands grab the next version where they stopped,
  /// so that none of their path is lost. Wait-free, without allocation.
  void hold_still(const deform::Points& tips, Frame& frame, LoopStats& stats) noexcept;
  /// Makes a sculptor with this number of control points for a version of the model, in `ready`.
  /// Asking thread, at any time. For a version that is not in effect, the caller makes
  /// `spare_shapes`. Allocates.
  static void prepare(const SculptorSetup& setup, ModelVersion& model, Eigen::Index control_points,
                      ReadySculptor& ready);
  /// Returns whether the hands keep their grip in exchange() (ReadySculptor::holds_on).
  bool holds_on(const ReadySculptor& ready) const noexcept;
  /// Swaps the sculptor with that of `ready`. Call it after shape() with `completes`, in the same
  /// tick. The stroke ends, and the fingertips re-grab at `tips`, or at `ready.tips` if their count
  /// changes. Stroke and change are separate steps; within a second after the previous exchange
  /// they join the adjacent steps. If an undo or a redo waits for this change (Frame::awaited),
  /// this completes it. The shape is kept, except that an undo drops the shaping since the last
  /// step. A change of the model's version is always a step, and the frame shows the new version.
  /// Returns false, and only ends the stroke and re-grabs, if the version is not new and no undo or
  /// redo waits for it any more. Wait-free, without allocation.
  bool exchange(ReadySculptor& ready, const deform::Points& tips, Frame& frame,
                LoopStats& stats) noexcept;
  /// Ends the stroke and drops pending requests. Fingertips that hold the shape re-grab, as in
  /// begin(). With `fences`, undo cannot go back beyond this point. Later ticks depend on earlier
  /// ones only through the shape, and whether it is held. Wait-free, without allocation.
  void restart(const deform::Points& tips, bool fences, Frame& frame, LoopStats& stats) noexcept;

private:
  enum class Exchange : std::uint8_t {
    awaited_step, ///< completes the pending undo or redo (Frame::awaited)
    new_step,
    same_step, ///< joins the step of the last change, less than a second ago
    refused    ///< a version for which no undo or redo waits any more
  };

  Awaited in_effect() const noexcept { return {settings_, model_->number, puppet_}; }
  deform::FieldStatus shape_by_hands(const deform::Points& tips, Frame& frame, LoopStats& stats,
                                     bool completes) noexcept;
  deform::FieldStatus show_rest(Frame& frame) noexcept;
  void write_hands(Frame& frame) const noexcept;
  void track_clay(const ClayState& clay, LoopStats& stats) noexcept;
  bool is_contact_over() const noexcept;
  void end_contact(const deform::Points& tips) noexcept;
  bool is_pulled() const noexcept;
  bool is_in_hand() const noexcept;
  void regrab(const deform::Points& tips) noexcept;
  void make_space(Frame& frame) noexcept;
  Exchange decide(const ReadySculptor& ready) const noexcept;
  void end_stroke(Exchange kind, bool holds_on) noexcept;
  void make_awaited_step(ReadySculptor& ready, LoopStats& stats) noexcept;
  void make_change(ReadySculptor& ready, Exchange kind) noexcept;
  const deform::Points& held_points(const ReadySculptor& ready, const deform::Points& tips,
                                    bool holds_on) const noexcept;
  void swap_in(ReadySculptor& ready) noexcept;
  void write_state(Frame& frame, LoopStats& stats) noexcept;
  // In shaping_steps.cpp:
  void take_steps(const deform::Points& tips, LoopStats& stats) noexcept;
  bool take_step(Request step, const deform::Points& tips, LoopStats& stats) noexcept;
  bool take_change(Request step, const deform::Points& tips, LoopStats& stats) noexcept;
  void count(Request step, LoopStats& stats) noexcept;
  static void step_over_change(Request step, ModelVersion& version, const Awaited& before) noexcept;
  void step_to(Request step, ModelVersion& next, const Awaited& before) noexcept;
  bool is_change_next(Request step) const noexcept;
  std::optional<Awaited> target_of(Request step) const noexcept;
  void record_settings(const LoopSettings& before, bool is_step) noexcept;
  void record_model(ModelVersion& next, const LoopSettings& before) noexcept;
  void record_puppet(const Awaited& before, StepKind kind) noexcept;
  Step step_now(StepKind kind) const noexcept;
  const ModelVersion* previous_version(const ModelVersion& version) const noexcept;
  std::size_t steps_to_undo() const noexcept;
  std::size_t steps_to_redo() const noexcept;
  std::size_t undo_steps() const noexcept;
  void forget_redo() noexcept;
  void list_undoable(StepList& list) const noexcept;
  void list_undone(StepList& list) const noexcept;
  void list_steps(StepList& list) const noexcept;

  ModelVersion* model_;
  ModelVersion* fenced_ = nullptr; ///< the version with the fence for undo
  std::unique_ptr<Sculptor> sculptor_;
  std::array<deform::FieldSequence, 3> spare_fields_; ///< memory for frames that need more
  std::array<deform::SurfaceMove, 3> spare_moves_;
  std::array<ReadySculptor::SpareShape, 3> spare_shapes_;
  deform::Points still_tips_; ///< the points at the stop, if is_still_
  bool is_still_ = false;
  bool changes_at_once_;
  bool held_;        ///< the fingertips shape the model
  bool hold_wanted_; ///< the requested value of held_
  bool commit_due_ = false;
  bool regrab_due_ = false;         ///< Request::regrab
  bool shaped_ = false;             ///< has shaped since the grab or the last commit
  std::uint64_t strokes_ended_ = 0; ///< strokes that ended without a commit
  std::uint64_t refused_steps_ = 0; ///< LoopStats::refused_steps
  std::uint64_t shape_jumps_ = 0;   ///< Frame::shape_jumps
  std::uint64_t surface_moves_ = 0; ///< Frame::surface_moves
  bool in_step_ = false;            ///< the shaping before a change is not a step yet
  LoopSettings settings_;           ///< in effect
  std::uint32_t puppet_ = 0;        ///< in effect
  std::optional<Awaited> awaited_;  ///< the change that steps_due_.front() awaits
  HostClock::duration time_{};
  std::optional<HostClock::duration> exchanged_at_; ///< the last change of settings alone
  std::optional<HostClock::duration> touched_at_;   ///< the last contact with clay
  std::vector<Request> steps_due_;                  ///< pending undos, redos and resets, in order
};

} // namespace nendo::flow
