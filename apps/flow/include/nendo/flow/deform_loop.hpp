#pragma once
// The loop drains the gloves' rings, computes both hands' fingertips, makes control vectors of
// them, deforms the model and publishes the frame, at a fixed rate.

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nendo/base/job_offer.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/frame_sink.hpp>
#include <nendo/flow/hand_contact.hpp>
#include <nendo/flow/input_log.hpp>
#include <nendo/flow/input_script.hpp>
#include <nendo/flow/kneading_hand.hpp>
#include <nendo/flow/layer.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/pacer.hpp>
#include <nendo/flow/prepared_change.hpp>
#include <nendo/flow/rig_setup.hpp>
#include <nendo/flow/shaping.hpp>
#include <nendo/flow/tick_record.hpp>
#include <nendo/flow/wrist_switch.hpp>
#include <nendo/hand/active_calibration.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/hand/sensor_gate.hpp>
#include <nendo/puppet/gesture_clutch.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// A hand as an input of the loop, or a layer over it. Only the loop's thread drains `ring`, which
/// must outlive the loop; without one, the input is in LoopOptions::script.
struct HandInput {
  SampleRing* ring = nullptr;
  Side side = Side::right; ///< which hand it is on the stage, whichever glove it wears
  hand::Wearer wearer;
  GloveSample first;            ///< the pose in which the hand takes hold of the model
  bool gated = true;            ///< hand::SensorGate keeps out counts that no hand can have caused
  hand::FilterOptions filter{}; ///< for the joint angles, at the samples' own times
  /// Measured bones (HandSkeleton::of_bones) for gloves of the first sample's side, in place of the
  /// wearer's size. A recording does not keep them.
  std::optional<hand::HandSkeleton> measured{};
  /// A layer has its own glove and calibration; the hand's bones are those of the first input of
  /// its side.
  std::optional<Layer> layer{};
  /// Where the wrist of a simulated hand is, by its glove's own time. The loop moves the wrist with
  /// each sample as a WristMove does, which a recording keeps.
  std::shared_ptr<const WristPath> wrist_path{};

  /// Returns the skeleton for samples from a glove of that side. It always has the side `side`.
  hand::HandSkeleton skeleton(Side glove) const {
    if (measured && glove == first.side) return *measured;
    return hand::HandSkeleton(side, wearer.of(glove).size);
  }
};

/// Tells whether a loop can be made of these: one to most_inputs, and of each side at most one that
/// is no layer, before its layers.
bool are_usable(std::span<const HandInput> inputs) noexcept;
/// Returns how many hands shape: one or two.
std::size_t count_hands(std::span<const HandInput> inputs) noexcept;

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
  /// The ring that gets every tick's record, or refuses it if it is full. It must outlive the loop.
  TickRing* records = nullptr;
  /// The commands, which the loop takes at the beginning of a tick. It must outlive the loop.
  CommandRing* commands = nullptr;
  /// The log to which the loop writes its input, for a recorder. It must outlive the loop.
  InputLog* input_log = nullptr;
  /// Recorded input that the loop takes in its ticks, before what is live. It must outlive the
  /// loop.
  InputScript* script = nullptr;
  /// When a wire or knife is drawn (DrawWire) by itself, since the first tick was due.
  struct WireTime {
    double from_s = 0.0, to_s = 0.0;
    Blade blade = Blade::wire;
  };
  std::optional<WireTime> wire_time{};
  std::size_t undo_most_bytes = 0; ///< UndoRoom::most_bytes, of all versions together
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
  puppet::RigState rig_state{}; ///< of its player at first
  /// The settings at first, if settings_of() the sculptor and the filter would tell them less
  /// exactly.
  std::optional<LoopSettings> settings{};

  /// Whether an undo takes back what the hands have pulled in type 1 since the last commit as a
  /// step of its own. If not, it goes together with the step that is undone, as in recordings
  /// before format 1.5.
  bool pull_is_step = true;

  bool begins_held() const noexcept { return held.value_or(switch_action != SwitchAction::grab); }
};

class DeformLoop {
public:
  /// `hands` must be usable (are_usable()). Copies the model and allocates all that a tick
  /// needs. The hands take hold of the model at their first samples. With
  /// SwitchAction::grab they hold it only while a switch is on. With `first`, the shape is at first
  /// that one, in the blocks of the model's layout.
  DeformLoop(const deform::Mesh& model, const Placement& placement, std::vector<HandInput> hands,
             const LoopOptions& options, const deform::BlockShape* first = nullptr);
  ~DeformLoop();
  DeformLoop(const DeformLoop&) = delete;
  DeformLoop& operator=(const DeformLoop&) = delete;

  /// Runs ticks on the calling thread until `stop` or for `most_ticks` deadlines of the grid, also
  /// skipped ones. A tick does not allocate or lock; its only system call is the sleep. Call
  /// make_thread_realtime() first to make wake-ups punctual.
  void run(const std::atomic<bool>& stop,
           std::uint64_t most_ticks = std::numeric_limits<std::uint64_t>::max()) noexcept;
  /// Runs one tick without its sleep, for callers with a clock of their own, on the thread of
  /// run().
  void tick(std::uint64_t number, HostTime scheduled) noexcept {
    tick({number, scheduled, HostClock::now()});
  }
  /// Repeats a tick from an input log. The times that are measured of it mean nothing.
  void tick(std::uint64_t number, HostTime scheduled, HostTime woke) noexcept {
    tick(Pacer::Due{number, scheduled, woke});
  }

  // Changes, for one thread, which may be another than the loop's. The loop takes what was asked
  // for at the beginning of its next tick. What comes before that is taken together.

  /// Makes all that these settings need, and hands it to the loop: the stroke in hand then ends,
  /// and the fingertips take hold of the same shape anew. What is shaped between changes that are
  /// less than a second apart is one step for undo. Settings that were asked for last change
  /// nothing. Allocates; the tick does not. Returns false, and changes nothing, if they are not
  /// usable.
  bool change_settings(const LoopSettings& settings);
  /// Lets the input go to `log` from a tick on, or nowhere. That tick keeps what the hands have
  /// shaped, and they take hold anew; a log gets no undo that leads back before it. Ask
  /// take_state() when it has happened. Both logs must outlive that. `like` is a shape of the
  /// latest frames: the tick copies only the blocks that differ from it.
  void change_log(InputLog* log, const deform::BlockShape& like);
  /// Returns the state with which the log began, or ended, once for each change_log() that the loop
  /// has taken.
  std::optional<LoopState> take_state();
  /// Asks for what an undo or a redo waits for (Frame::awaited): settings, or a version of the
  /// model that is kept. Returns false, and changes nothing, if there are no such, or if the loop
  /// has yet to take another change of models. Allocates.
  bool change_to(const Awaited& awaited);
  /// Returns the settings that were asked for last, and their sculptor's options.
  const LoopSettings& settings() const noexcept { return asked_.settings; }
  const SculptorOptions& sculptor_options() const noexcept { return asked_.options; }

  /// Returns the puppet with which the loop began; null if the hands touched the model.
  const puppet::Rig* rig() const noexcept {
    return is_played(puppets_.front().get()) ? puppets_.front().get() : nullptr;
  }

  // Other puppets, and other masks of fingertips. Each has a number; 0 is what the loop began with,
  // which may be none.

  /// Lets the hands go on with another puppet of the model with which the loop began. It gets
  /// next_puppet() as its number, and is kept for undo. Functions of the same name keep their
  /// values. In type 1 the shape changes by what the puppets differ in, and by nothing else.
  /// Without points, it is the fingertips' masks and mirror that change: the stroke ends, and they
  /// take hold of the same shape anew. Errors: bad_input (its points are too near to each other, or
  /// it has none, and the loop began with hands that play one); failed (the loop holds still, or is
  /// about to begin a log or another model: ask again later). Then nothing changes. Allocates.
  Result<void> change_puppet(std::shared_ptr<const puppet::Rig> rig);
  /// Does the same with one that the loop has had.
  Result<void> change_puppet(std::uint32_t number);
  std::uint32_t next_puppet() const noexcept { return static_cast<std::uint32_t>(puppets_.size()); }
  /// Returns that puppet; null if it is none, and the hands touch the model.
  const std::shared_ptr<const puppet::Rig>& puppet(std::uint32_t number) const noexcept {
    return puppets_[number];
  }
  /// Returns the number of the one that was asked for last.
  std::uint32_t newest_puppet() const noexcept { return asked_puppet_; }

  /// Tells whether the loop has yet to take a change.
  bool is_changing();

  // Another model, in two changes, so that the hands go on while it is made and nothing is lost of
  // what they do. Make a FinerModel of newest_model(); ask the loop to hold still; when it does,
  // finish the model and hand it over. No log may begin or end meanwhile.

  /// Lets the hands stop shaping at the end of the next tick (Shaping::hold_still()). Returns
  /// false, and does nothing, if the loop has yet to take a change or holds still already.
  bool hold_still();
  /// Tells whether the loop has done so, and waits for a model.
  bool is_still();
  /// Finishes the model, which must be made of newest_model(), and hands it to the loop, which must
  /// be still and goes on with it. `accepts` is called with the new version before the loop has it.
  /// Settings that are asked for meanwhile come with it. Later, versions to which no undo or redo
  /// leads any more are freed. With an error the loop goes on with the model that it has: that of
  /// `accepts`, what FinerModel::finish() tells, or bad_input if a puppet plays the model and it
  /// would be cut or joined, or a puppet's points cannot be solved for on that version. Allocates.
  Result<void> change_model(FinerModel& finer,
                            const std::function<Result<void>(const ModelVersion&)>& accepts = {});
  /// Lets a loop that holds still go on with the model that it has.
  void keep_model();
  /// Returns the last wire that was drawn to its end. On the loop's thread; others see Frame::wire.
  const WirePath& drawn_wire() const noexcept { return drawn_wire_; }
  /// Returns the version that the loop has or was asked last to go on with.
  const ModelVersion& newest_model() const noexcept { return *asked_model_; }
  /// Returns that version; null if there is none. It lives until change_model() frees it.
  const ModelVersion* model(std::uint32_t number) const noexcept {
    return version_numbered(number);
  }

  /// Returns ok or merged if the hands could take hold of the model.
  deform::FieldStatus grab_status() const noexcept { return grab_status_; }
  /// One reader thread may poll it while the loop runs.
  FrameExchange& frames() noexcept { return frames_; }
  const LoopStats& stats() const noexcept { return stats_; }
  /// Makes room for more undos, up to LoopOptions::undo_most_bytes. The thread that asks for
  /// changes should call it now and then. Returns false if there is no more room, so that the
  /// oldest steps will be dropped.
  bool refill_undo();
  /// Returns the layout of a version that there is, which turns a frame's shape into points in the
  /// mesh's order.
  const deform::BlockLayout& layout(std::uint32_t version = 0) const noexcept {
    return model(version)->layout();
  }
  /// Completes the last stroke and returns the shape, 3 by #vertices. Call it when the loop has
  /// ended.
  deform::Points final_shape();
  /// Does the same, with the faces of the version that the loop has.
  deform::Mesh final_mesh();

private:
  struct Hand;
  void tick(const Pacer::Due& due) noexcept;
  void take_commands(HostTime scheduled) noexcept;
  void apply(const Command& command) noexcept;
  void take_change() noexcept;
  void finish_change(Frame& frame) noexcept;
  void change_filters(const LoopSettings& settings) noexcept;
  void begin_anew(LogChange& change, Frame& frame) noexcept;
  void give_back_change() noexcept;
  void place_tips(deform::Points& tips) noexcept;
  void place_body(const Hand& hand, const hand::HandPose& pose) noexcept;
  void take_rig(ReadyRig& rig, ReadySculptor& ready) noexcept;
  void note_hold() noexcept;
  void tell_rig(Frame& frame) const noexcept;
  void play_rig() noexcept;
  void set_rig(const Command& command) noexcept;
  void draw_blade(const DrawWire& draw) noexcept;
  void follow_blade(const Frame& frame) noexcept;
  puppet::RigPlayer::Hands played_hands() const noexcept;
  puppet::RigPlayer::Hands hands_now() noexcept;
  ModelVersion* version_numbered(std::uint32_t number) const noexcept;
  Result<void> set_surface(SculptorOptions& sculptor, const ModelVersion& model) const;
  Result<void> set_model(SculptorOptions& sculptor, const ModelVersion& model) const;
  int hands_of(std::uint32_t puppet) const noexcept;
  Eigen::Index points_of_hand(const deform::Points& tips) const noexcept;
  Eigen::Index control_points(std::uint32_t puppet) const noexcept;
  SculptorSetup first_with(std::uint32_t puppet) const;
  Result<SculptorSetup> setup_with(std::uint32_t puppet) const;
  ReadyRig ready_rig(std::uint32_t number, std::uint32_t before) const;
  void make_ready(PreparedChange& change);
  std::optional<SculptorSetup> setup_for(const SculptorSetup& before,
                                         const LoopSettings& settings) const;
  PreparedChange& next_change();
  void offer_change();
  void offer_model(ModelVersion& version, const ChangeModel& model);
  void go_back();
  Eigen::Index hand_count() const noexcept;
  void free_others(const ChangeModel& taken);
  UndoRoom undo_room() const noexcept;
  void take_script(HostTime scheduled) noexcept;
  void take_samples(TickRecord& record) noexcept;
  void take(std::uint8_t number, const GloveSample& sample) noexcept;
  void count(Hand& hand, std::size_t samples, HostTime now) noexcept;
  void let_layers_pass(HostTime scheduled) noexcept;
  hand::JointAngles angles_of(const Hand& lowest) const noexcept;
  hand::HandPose pose_of(const Hand& lowest) const noexcept;
  bool is_silent(std::size_t slot) const noexcept;
  void follow_switches() noexcept;
  bool has_clutch(const Hand& hand) const noexcept;
  void compute_hands(Frame& frame) noexcept;
  void describe(const TickRecord& record, Frame& frame) noexcept;
  void record_latencies(const TickRecord& record) noexcept;

  struct Hand {
    /// Updates `latest` and `angles` by the next sample.
    void follow(const GloveSample& sample) noexcept;
    /// Sets `angles` by `latest` and this calibration.
    void pose_by(const hand::Calibration& active) noexcept;
    /// Forgets all that came before `latest` but what adaptation has learned.
    void begin_anew() noexcept;
    const hand::HandSkeleton& skeleton() const noexcept {
      return skeletons[Placement::index_of(latest.side)];
    }

    /// Sensors of `latest` that are stuck.
    SensorMask left_out() const noexcept {
      return {calibration.left_out(latest.side).bits & latest.present.bits};
    }

    HandInput input;
    std::size_t slot = 0; ///< of arrays by side
    Eigen::Isometry3d T_stage_wrist;
    std::array<hand::HandSkeleton, 2> skeletons; ///< by the glove's side
    hand::ActiveCalibration calibration;
    hand::SensorGate gate{};
    hand::JointFilter filter;
    GloveSample latest{};
    bool closes_pinches = false; ///< the filter's options say so, and nothing is between the pads
    hand::JointAngles angles{};  ///< of `latest`, filtered, with pinches closed
    WristSwitchEdge wrist_switch{};
    bool is_lowest = true;  ///< of its side: the hand, and not a layer over it
    bool is_topmost = true; ///< of its side: whose samples are counted
    bool fresh = false;     ///< samples came out of its ring in this tick
    bool silent = false;
  };

  LoopOptions options_;
  double units_per_metre_;
  std::vector<Hand> hands_;
  std::optional<puppet::RigPlayer> rig_;
  std::optional<puppet::GestureClutch> gestures_; ///< of the rig's hands
  std::optional<double> mirror_;                  ///< mirror_of() what is in force
  std::array<puppet::HandState, 2> hand_states_;  ///< by side, for the rig
  /// The control points, 3 by 5 a hand, or by as many as a puppet has; model units.
  deform::Points tips_;
  std::shared_ptr<HandBodies> bodies_; ///< of hands that press clay; by side, if there are two
  std::vector<double> held_at_;        ///< the rig's values when the hands took hold of the shape
  std::vector<double> still_at_;       ///< and when they stopped (Shaping::is_still())
  // For the thread that asks for changes:
  std::vector<std::unique_ptr<ModelVersion>> versions_;
  SculptorSetup first_;
  std::shared_ptr<const puppet::Rig> first_rig_;            ///< of it
  std::optional<deform::Supports> tip_supports_;            ///< of hands without a puppet
  std::vector<std::shared_ptr<const puppet::Rig>> puppets_; ///< by their numbers
  std::uint32_t asked_puppet_ = 0;                          ///< for last
  struct Played {
    puppet::RigPlayer player;
    std::vector<double> held_at;
  };
  std::map<std::uint32_t, Played> played_; ///< as puppets were when others replaced them
  ModelVersion* asked_model_;              ///< for last
  ModelVersion* model_before_ = nullptr;   ///< before that
  std::uint32_t last_number_ = 0;
  // For the loop's thread:
  Shaping shaping_;
  deform::FieldStatus grab_status_ = deform::FieldStatus::ok;
  bool switch_on_ = false; ///< any hand's, for SwitchAction::grab
  WirePath wire_;          ///< that hands draw, or have drawn last
  WirePath drawn_wire_;    ///< the last one that has been drawn to its end
  Blade blade_ = Blade::wire;
  bool knife_in_right_ = true;    ///< hand
  bool draws_in_time_ = false;    ///< by LoopOptions::wire_time
  bool holds_after_wire_ = false; ///< the hands held the model before
  JobOffer<PreparedChange*> changes_;
  PreparedChange* taken_ = nullptr; ///< by this tick
  // For the thread that asks for changes:
  SculptorSetup asked_;                    ///< for last
  std::unique_ptr<PreparedChange> change_; ///< that the loop has, or will have
  bool is_offered_ = false;
  bool is_still_ = false;                      ///< the loop has taken that it holds still
  std::optional<LoopSettings> settings_later_; ///< that were asked for while it holds still
  std::vector<LoopState> states_;              ///< not taken yet
  HostTime first_due_{};                       ///< of the first tick
  std::optional<HostTime> due_;                ///< of this tick
  HostTime last_woke_{};                       ///< of the tick before; HostTime{} at first
  HostTime last_due_{};                        ///< of the tick before
  LoopStats stats_;
  FrameExchange frames_;
};

} // namespace nendo::flow
