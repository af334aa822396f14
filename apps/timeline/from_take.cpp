#include "timeline/reduce.hpp"

#include <algorithm>
#include <utility>

#include <nendo/flow/sculptor.hpp>
#include <nendo/hand/wearer.hpp>
#include <nendo/recording/loop_replay.hpp>

namespace nendo::timeline {
namespace {

using recording::LoopReplay;
using recording::Setup;
using recording::TakeReader;

Key key_of(double time_s, const hand::JointAngles& angles, const Eigen::Isometry3d& T_stage_wrist) {
  Key key;
  key.time_s = time_s;
  key.angles = angles;
  key.wrist_m = T_stage_wrist.translation();
  key.wrist_turn = Eigen::Quaterniond(T_stage_wrist.linear());
  return key;
}

// As the loop had it before its first tick.
hand::JointAngles own_angles(const flow::HandInput& input) {
  hand::ActiveCalibration calibration(input.wearer);
  const hand::Calibration& active = calibration.follow(input.first);
  return hand::joint_angles(input.first, active, calibration.left_out(input.first.side));
}

hand::JointAngles first_angles(const Setup& setup, const flow::HandInput& hand) {
  hand::JointAngles angles = own_angles(hand);
  if (hand.layer && hand.layer->below) angles = *hand.layer->below;
  for (const auto& input : setup.hands)
    if (input.side == hand.side && input.layer) input.layer->play_over(own_angles(input), angles);
  return angles;
}

Timeline begin_timeline(const Setup& setup, const std::filesystem::path& take) {
  const recording::LoopSetup& loop = *setup.loop;
  Timeline timeline;
  timeline.take = take.filename().string();
  timeline.mesh = loop.mesh;
  timeline.mesh_sum = loop.mesh_sum;
  timeline.units_per_metre = loop.placement.units_per_metre;
  timeline.rate_hz = loop.options.rate_hz;
  timeline.held = loop.options.begins_held();
  timeline.sculptor = loop.options.sculptor;
  timeline.sculptor.deformer.undo_bytes = 0;
  for (const auto& hand : setup.hands) {
    if (timeline.track(hand.side) != nullptr) continue; // a layer over it
    const auto& T_stage_wrist = loop.placement.T_stage_wrist[flow::Placement::index_of(hand.side)];
    timeline.hands.push_back({hand.side,
                              hand.wearer.of(hand.first.side).size,
                              {key_of(0.0, first_angles(setup, hand), T_stage_wrist)}});
  }
  return timeline;
}

/// The last change of the puppet; nothing if it is one all the time.
std::optional<recording::PuppetChange> last_change_in(TakeReader reader) {
  std::optional<recording::PuppetChange> last;
  while (const auto entry = reader.next())
    if (const auto* change = std::get_if<recording::PuppetChange>(&*entry)) last = *change;
  return last;
}

/// The options with another puppet than that of the loop's beginning.
void use_puppet(const puppet::Rig& first, const puppet::Rig& rig, flow::SculptorOptions& options) {
  deform::Supports& supports = options.deformer.supports;
  const double pieces = options.piece_length / deform::min_radius(supports);
  const double scale = deform::min_radius(supports) / deform::min_radius(first.supports());
  supports = flow::scaled(rig.supports(), scale); // people may have scaled the radii
  options.piece_length = pieces * deform::min_radius(supports);
  options.surface.reset(); // a player makes it
}

/// The puppet before the first tick, or the one that took its place; or the masks of fingertips.
void keep_puppet(const flow::DeformLoop& loop, const puppet::RigState& state,
                 const std::shared_ptr<const puppet::Rig>& last, Timeline& timeline) {
  const auto& first = loop.changes().puppet(0);
  if (!flow::is_played(first.get())) {
    if (first) timeline.masks = {first};
    return;
  }
  timeline.rig = last ? last : first;
  timeline.rig_state = first_state(*timeline.rig);
  timeline.rig_state.symmetric = state.symmetric;
  timeline.sculptor.surface = loop.changes().sculptor_options().surface;
  if (timeline.rig != first) use_puppet(*first, *timeline.rig, timeline.sculptor);
  const auto from = puppet::functions_before(first->puppet(), timeline.rig->puppet());
  for (std::size_t at = 0; at < from.size(); ++at) {
    if (from[at] >= state.functions.size()) continue;
    puppet::FunctionState& kept = timeline.rig_state.functions[at];
    const puppet::HandSignal input = kept.input; // which an edit may have chosen
    kept = state.functions[from[at]];
    if (first->puppet().functions[from[at]].input != input) kept.input = input;
  }
}

/// Returns the number in the timeline's puppet of a function of the one that is played then;
/// nothing if it has none such.
std::optional<std::uint16_t> function_in(const puppet::Rig& timelines, const puppet::Rig& played,
                                         std::uint16_t function) {
  const auto from = puppet::functions_before(played.puppet(), timelines.puppet());
  const auto found = std::ranges::find(from, std::size_t{function});
  if (found == from.end()) return std::nullopt;
  return static_cast<std::uint16_t>(found - from.begin());
}

// Follows a replay, and keeps a key a tick of each hand, and what the ticks did.
class TickRecorder {
public:
  TickRecorder(Timeline& timeline, const flow::LoopOptions& options, const flow::DeformLoop& loop)
      : timeline_(timeline), loop_(loop), held_(timeline.held),
        on_grid_(options.policy == flow::OverrunPolicy::skip ||
                 options.policy == flow::OverrunPolicy::catch_up) {}

  void record(flow::Request request) {
    if (flow::goes_through_history(request)) steps_.push_back(request);
    if (request != flow::Request::regrab) return;
    if (timeline_.rig)
      puppet_commands_.emplace_back(request);
    else
      regrabs_ = true;
  }

  void record(const flow::Mark& mark) { marks_.emplace_back(mark); }
  void record(const flow::SetClutch& clutch) { puppet_commands_.emplace_back(clutch); }
  void record(const flow::SetSymmetry& symmetry) { puppet_commands_.emplace_back(symmetry); }
  /// A loop ignores roles of functions that the puppet which is played then does not have.
  void record(const flow::SetRole& role) {
    const auto& played = loop_.changes().puppet(loop_.changes().newest_puppet());
    const auto number = played && timeline_.rig
                            ? function_in(*timeline_.rig, *played, role.function)
                            : std::optional(role.function);
    if (number) puppet_commands_.emplace_back(flow::SetRole{*number, role.input});
  }

  void record(const flow::HoldStill&) { is_still_ = true; }
  /// The model is made of the shape of the tick in which the loop began to hold still; a cut one by
  /// the drawn wire.
  void record(const flow::ChangeModel& change) {
    is_still_ = false;
    if (!change.is_new()) return;
    if (change.source != flow::ModelSource::cut)
      return timeline_.events.push_back({still_at_s_, flow::asking_for(change)});
    const auto number = static_cast<std::uint32_t>(timeline_.wires.size());
    const auto places = loop_.drawn_wire().places();
    timeline_.wires.emplace_back(places.begin(), places.end());
    timeline_.events.push_back({still_at_s_, flow::ChangeModel{number, change.source}});
  }

  void record(const flow::LoopSettings& settings) {
    const flow::LoopSettings& current = loop_.changes().settings();
    changes_filter_ = changes_filter_ || settings.filter != current.filter;
    if (settings == current) return;
    settings_ = settings;
    settings_->filter = {};
    answers_step_ = awaited_ && awaited_->settings == settings;
  }
  /// Returns whether the settings changed the filter, which those of a timeline do not have.
  bool changes_filter() const noexcept { return changes_filter_; }
  template <class Other>
  void record(const Other&) {}

  /// The fingertips have other masks; `number` is the replay's.
  void record_masks(std::uint32_t number, const std::shared_ptr<const puppet::Rig>& masks) {
    if (std::exchange(masks_, number) == number) return; // recorders repeat it
    auto& all = timeline_.masks;
    all.resize(std::max<std::size_t>(all.size(), number + 1));
    all[number] = masks;
    masks_due_ = number;
    answers_step_ = awaited_ && awaited_->puppet == number;
  }

  /// A tick has run.
  void record_tick(const flow::LoggedTick& tick, const flow::Frame& frame,
                   const flow::LoopStats& stats) {
    if (!first_) first_ = tick;
    const double before_s = timeline_.duration_s;
    const double time_s = std::max(before_s, time_of(tick));
    record_switches(frame, stats);
    add_puppet_events(before_s, time_s);
    for (auto& hand : timeline_.hands) {
      const std::size_t slot = flow::Placement::index_of(hand.side);
      const Key key = key_of(time_s, frame.hands[slot].angles, frame.hands[slot].T_stage_wrist);
      if (time_s > hand.keys.back().time_s) hand.keys.push_back(key);
    }
    timeline_.duration_s = time_s;
    add_events(time_s, frame, stats);
    if (std::exchange(is_still_, false)) still_at_s_ = time_s;
    awaited_ = frame.awaited;
    puppet_ = frame.puppet;
  }
  bool has_ticks() const noexcept { return first_.has_value(); }

private:
  // Ticks of the grid are frames of the timeline's, whose times are quotients as these.
  double time_of(const flow::LoggedTick& tick) const noexcept {
    const double period_s = 1.0 / timeline_.rate_hz;
    if (!on_grid_) return period_s + seconds_between(first_->scheduled, tick.scheduled);
    return static_cast<double>(tick.number - std::min(first_->number, tick.number) + 1) /
           timeline_.rate_hz;
  }

  void add(double time_s, const flow::Command& command) {
    timeline_.events.push_back({time_s, command});
  }

  /// By which hands release a puppet, and grab it again.
  void record_switches(const flow::Frame& frame, const flow::LoopStats& stats) {
    for (const Side side : {Side::left, Side::right}) {
      const std::size_t slot = flow::Placement::index_of(side);
      const bool used =
          std::exchange(switch_uses_[slot], stats.switch_uses[slot]) != stats.switch_uses[slot];
      const auto by_switch = puppet::ClutchTrigger::wrist_switch;
      if (used && timeline_.rig && timeline_.rig->puppet().clutch.means[slot] == by_switch)
        puppet_commands_.emplace_back(
            flow::SetClutch{side, puppet::RigPlayer::all_fingers, !frame.released[slot]});
    }
  }

  /// A puppet's command applies to the hands as they were in the last tick. Where ticks
  /// were missed, that is the frame behind it.
  void add_puppet_events(double before_s, double time_s) {
    const double period_s = 1.0 / timeline_.rate_hz;
    const double next_s = time_s < before_s + 1.5 * period_s ? time_s : before_s + period_s;
    for (const flow::Command& command : puppet_commands_)
      if (timeline_.rig) add(next_s, command);
    puppet_commands_.clear();
  }

  // One that waits for settings, and those behind it, have not happened yet.
  void add_steps(double time_s, const flow::Frame& frame, const flow::LoopStats& stats) {
    const std::uint64_t all = stats.undos + stats.redos + stats.resets;
    const bool is_done = std::exchange(done_, all) != all;
    // The player makes the settings of the step that waited for them. If the undo took something
    // else back that had come by then, they were a change like others, which ends all redo.
    const bool is_step_over = is_done && !steps_.empty() &&
                              (steps_.front() == flow::Request::redo || frame.redo_steps > 0);
    if (std::exchange(answers_step_, false) && is_step_over) {
      settings_.reset();
      masks_due_.reset();
    }
    // Over an edit of the puppet, which the timeline has not.
    if (is_step_over && timeline_.rig && awaited_ && awaited_->puppet != puppet_)
      steps_.erase(steps_.begin());
    for (; steps_.size() > frame.steps_due; steps_.erase(steps_.begin()))
      add(time_s, steps_.front());
  }

  void add_events(double time_s, const flow::Frame& frame, const flow::LoopStats& stats) {
    add_steps(time_s, frame, stats);
    if (!is_still_ && std::exchange(regrabs_, false)) add(time_s, flow::Request::regrab);
    const bool committed = stats.commits > commits_;
    if (!held_ && (frame.held || committed)) add(time_s, flow::Request::grab);
    if (committed && frame.held) add(time_s, flow::Request::commit);
    if (committed && !frame.held) add(time_s, flow::Request::release);
    if (settings_) add(time_s, flow::ChangeSettings{*std::exchange(settings_, {})});
    if (masks_due_) add(time_s, flow::ChangePuppet{*std::exchange(masks_due_, {})});
    for (const flow::Command& mark : marks_)
      add(time_s, mark);
    marks_.clear();
    commits_ = stats.commits;
    held_ = frame.held;
  }

  Timeline& timeline_;
  const flow::DeformLoop& loop_;
  bool held_;
  bool on_grid_;
  std::uint64_t commits_ = 0;
  std::array<std::uint64_t, 2> switch_uses_{};
  std::uint64_t done_ = 0;                     ///< undos, redos and resets
  std::vector<flow::Command> puppet_commands_; ///< to the puppet since the last tick
  std::vector<flow::Command> marks_;           ///< since the last tick
  std::vector<flow::Request> steps_;           ///< undos, redos and resets since the last tick
  bool regrabs_ = false;                       ///< it was asked for since the last tick
  std::optional<flow::LoopSettings> settings_; ///< a change since the last tick
  std::uint32_t masks_ = 0;                    ///< their number
  std::optional<std::uint32_t> masks_due_;     ///< a change since the last tick
  bool changes_filter_ = false;
  bool answers_step_ = false;            ///< an undo or a redo has waited for these changes
  bool is_still_ = false;                ///< from the next tick on
  double still_at_s_ = 0.0;              ///< the end of the last tick that shaped
  std::optional<flow::Awaited> awaited_; ///< after the last tick, by an undo or a redo
  std::uint32_t puppet_ = 0;             ///< in the last tick
  std::optional<flow::LoggedTick> first_;
};

// Of frames or of events; empty if nothing does.
std::string what_exceeds(const Timeline& timeline, std::size_t most) {
  if (timeline.events.size() > most) return std::to_string(most) + " events";
  for (const auto& hand : timeline.hands)
    if (hand.keys.size() > most) return std::to_string(most) + " frames";
  return {};
}

/// Both hands may move one point, so that each may use up its part of the tolerance.
void reduce(Tolerance tolerance, MadeTimeline& made) {
  Timeline& timeline = made.timeline;
  tolerance.point_m /= static_cast<double>(timeline.hands.size());
  for (auto& hand : timeline.hands) {
    const PointSway sway(timeline, hand.side);
    made.hands.push_back(reduce_keys(hand.skeleton(), hand.keys, tolerance, &sway));
    hand.keys = std::exchange(made.hands.back().keys, {});
  }
}

} // namespace

Result<MadeTimeline> timeline_of_take(const std::filesystem::path& take, const deform::Mesh& model,
                                      const Tolerance& tolerance, std::size_t most) {
  const auto reader = TakeReader::open(take);
  if (!reader) return reader.error();
  return timeline_of_take(take, reader->setup(), model, tolerance, most);
}

Result<MadeTimeline> timeline_of_take(const std::filesystem::path& take, const Setup& setup,
                                      const deform::Mesh& model, const Tolerance& tolerance,
                                      std::size_t most) {
  auto reader = TakeReader::open(take);
  if (!reader) return reader.error();
  const auto bad = [&take](const std::string& what) {
    return Error{Errc::bad_input, take.string() + ": " + what};
  };
  auto replay = LoopReplay::make(setup, model);
  if (!replay) return bad(replay.error().message);
  if (!setup.loop->rest.empty() || !setup.loop->origins.empty())
    return bad("begins in the middle of a run, with a shape that is no file's");
  MadeTimeline made;
  made.timeline = begin_timeline(setup, take);
  std::optional<recording::PuppetChange> change;
  std::shared_ptr<const puppet::Rig> last;
  if ((*replay)->loop().changes().first_puppet() != nullptr) {
    auto scanned = TakeReader::open(take);
    if (!scanned) return scanned.error();
    change = last_change_in(*std::move(scanned));
  }
  if (change && change->puppet) {
    auto rig = recording::rig_of(*change->puppet, model);
    if (!rig) return bad(rig.error().message);
    last = *std::move(rig);
  }
  made.has_last_puppet = change.has_value();
  keep_puppet((*replay)->loop(), setup.loop->options.rig_state, last, made.timeline);
  flow::DeformLoop& loop = (*replay)->loop();
  TickRecorder recorder(made.timeline, setup.loop->options, loop);
  while (const auto entry = reader->next()) {
    std::visit([&](const auto& one) { recorder.record(one); }, *entry);
    if (recorder.changes_filter())
      return bad("changes the filter of the hands on the way, which a timeline cannot; cut out the "
                 "part before that with `nendo recording cut`");
    const bool ticked = (*replay)->feed(*entry);
    if (std::holds_alternative<recording::PuppetChange>(*entry) && !made.timeline.rig) {
      const auto& masks = loop.changes().puppet(loop.changes().newest_puppet());
      if (flow::is_played(masks.get()))
        return bad("begins a puppet on the way, and a timeline has one from the beginning on; save "
                   "the puppet, and record a run with it by --puppet FILE");
      recorder.record_masks(loop.changes().newest_puppet(), masks);
    }
    if (!ticked) continue;
    loop.frames().update();
    recorder.record_tick(std::get<flow::LoggedTick>(*entry), loop.frames().front(), loop.stats());
    if (const std::string many = what_exceeds(made.timeline, most); !many.empty())
      return bad("has more than " + many + "; cut a part with `nendo recording cut`");
  }
  if (!recorder.has_ticks()) return bad("there is no tick of a loop in it");
  if (const std::string wrong = complaint_about(made.timeline); !wrong.empty())
    return bad("cannot become a timeline: " + wrong);
  reduce(tolerance, made);
  made.exact = (*replay)->is_exact() && reader->chunks().damage_count() == 0;
  return made;
}

} // namespace nendo::timeline
