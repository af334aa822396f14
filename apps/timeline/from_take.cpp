#include "timeline/from_take.hpp"

#include <algorithm>
#include <utility>

#include <nendo/hand/active_calibration.hpp>
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
hand::JointAngles first_angles(const flow::HandInput& hand) {
  hand::ActiveCalibration calibration(hand.wearer);
  return hand::joint_angles(hand.first, calibration.follow(hand.first));
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
  timeline.pull_is_step = loop.options.pull_is_step;
  timeline.sculptor = loop.options.sculptor;
  timeline.sculptor.deformer.undo_bytes = 0;
  for (const auto& hand : setup.hands) {
    const auto& T_stage_wrist = loop.placement.T_stage_wrist[flow::Placement::index_of(hand.side)];
    timeline.hands.push_back({hand.side,
                              hand.wearer.of(hand.first.side).size,
                              {key_of(0.0, first_angles(hand), T_stage_wrist)}});
  }
  return timeline;
}

// Follows a replay, and keeps a key a tick of each hand, and what the ticks did.
class Follower {
public:
  Follower(Timeline& timeline, const flow::LoopOptions& options)
      : timeline_(timeline), held_(timeline.held),
        on_grid_(options.policy == flow::OverrunPolicy::skip ||
                 options.policy == flow::OverrunPolicy::catch_up) {}

  void hear(flow::Request request) {
    if (flow::goes_through_history(request)) steps_.push_back(request);
  }

  void hear(const flow::HoldStill&) { is_still_ = true; }
  /// The model is made of the shape of the tick in which the loop began to hold still.
  void hear(const flow::ChangeModel& change) {
    is_still_ = false;
    if (change.source == flow::ModelSource::subdivided)
      timeline_.events.push_back({still_at_s_, {}, {}, true});
  }

  /// Returns false if a timeline has no such settings.
  bool hear(const flow::LoopSettings& settings, const flow::LoopSettings& in_force) {
    if (settings.filter != in_force.filter) return false;
    const bool is_undo =
        awaited_ &&
        awaited_->settings == settings; // which the timeline's player makes of the request
    if (is_undo || settings == in_force) return true;
    settings_ = settings;
    settings_->filter = {};
    return true;
  }

  /// A tick has run. `commits`: how many there were.
  void see(const flow::LoggedTick& tick, const flow::Frame& frame, std::uint64_t commits) {
    if (!first_) first_ = tick;
    const double before_s = timeline_.duration_s;
    const double time_s = std::max(before_s, time_of(tick));
    for (auto& hand : timeline_.hands) {
      const std::size_t slot = flow::Placement::index_of(hand.side);
      const Key key = key_of(time_s, frame.hands[slot].angles, frame.hands[slot].T_stage_wrist);
      if (time_s > hand.keys.back().time_s) hand.keys.push_back(key);
    }
    timeline_.duration_s = time_s;
    see_events(time_s, frame, commits);
    if (std::exchange(is_still_, false)) still_at_s_ = time_s;
    awaited_ = frame.awaited;
  }
  bool has_seen() const noexcept { return first_.has_value(); }

private:
  // Ticks of the grid are frames of the timeline's, whose times are quotients as these.
  double time_of(const flow::LoggedTick& tick) const noexcept {
    const double period_s = 1.0 / timeline_.rate_hz;
    if (!on_grid_) return period_s + seconds_between(first_->scheduled, tick.scheduled);
    return static_cast<double>(tick.number - std::min(first_->number, tick.number) + 1) /
           timeline_.rate_hz;
  }

  void add(double time_s, flow::Request request) { timeline_.events.push_back({time_s, request}); }

  // One that waits for settings, and those behind it, have not happened yet.
  void add_steps(double time_s, const flow::Frame& frame) {
    std::uint64_t done = frame.undos - std::exchange(undos_, frame.undos);
    auto step = steps_.begin();
    for (; step != steps_.end() && (!frame.awaited || done > 0); ++step, done -= done > 0 ? 1 : 0)
      add(time_s, *step);
    steps_.erase(steps_.begin(), step);
  }

  void see_events(double time_s, const flow::Frame& frame, std::uint64_t commits) {
    add_steps(time_s, frame);
    const bool committed = commits > commits_;
    if (!held_ && (frame.held || committed)) add(time_s, flow::Request::grab);
    if (committed && frame.held) add(time_s, flow::Request::commit);
    if (committed && !frame.held) add(time_s, flow::Request::let_go);
    if (settings_) timeline_.events.push_back({time_s, {}, std::exchange(settings_, {})});
    commits_ = commits;
    held_ = frame.held;
  }

  Timeline& timeline_;
  bool held_;
  bool on_grid_;
  std::uint64_t commits_ = 0;
  std::uint64_t undos_ = 0;
  std::vector<flow::Request> steps_;           ///< undos, redos and resets since the last tick
  std::optional<flow::LoopSettings> settings_; ///< a change since the last tick
  bool is_still_ = false;                      ///< from the next tick on
  double still_at_s_ = 0.0;                    ///< the end of the last tick that shaped
  std::optional<flow::Awaited> awaited_;       ///< after the last tick, by an undo or a redo
  std::optional<flow::LoggedTick> first_;
};

// Of frames or of events; empty if nothing does.
std::string what_exceeds(const Timeline& timeline, std::size_t most) {
  if (timeline.events.size() > most) return std::to_string(most) + " events";
  for (const auto& hand : timeline.hands)
    if (hand.keys.size() > most) return std::to_string(most) + " frames";
  return {};
}

} // namespace

Result<MadeTimeline> timeline_of_take(const std::filesystem::path& take, const deform::Mesh& model,
                                      const Tolerance& tolerance, std::size_t most) {
  auto reader = TakeReader::open(take);
  if (!reader) return reader.error();
  const auto bad = [&take](const std::string& what) {
    return Error{Errc::bad_input, take.string() + ": " + what};
  };
  auto replay = LoopReplay::make(reader->setup(), model);
  if (!replay) return bad(replay.error().message);
  const Setup& setup = reader->setup();
  if (!setup.loop->rest.empty() || setup.loop->subdivisions > 0)
    return bad(
        "begins in the middle of a run, with a shape that is no file's; a timeline begins with "
        "its model. Record from the beginning of the run, with --record");
  if (!setup.loop->puppet.text.empty())
    return bad("plays a puppet, and a timeline is of hands that touch the model; "
               "`nendo export` makes an animation of it");
  MadeTimeline made;
  made.timeline = begin_timeline(setup, take);
  Follower follower(made.timeline, setup.loop->options);
  while (const auto entry = reader->next()) {
    if (const auto* request = std::get_if<flow::Request>(&*entry)) follower.hear(*request);
    if (const auto* still = std::get_if<flow::HoldStill>(&*entry)) follower.hear(*still);
    if (const auto* change = std::get_if<flow::ChangeModel>(&*entry)) follower.hear(*change);
    const auto* settings = std::get_if<flow::LoopSettings>(&*entry);
    if (settings != nullptr && !follower.hear(*settings, (*replay)->loop().settings()))
      return bad("changes the filter of the hands on the way, which a timeline cannot; cut out the "
                 "part before that with `nendo recording cut`");
    if (!(*replay)->feed(*entry)) continue;
    auto& frames = (*replay)->loop().frames();
    frames.update();
    follower.see(std::get<flow::LoggedTick>(*entry), frames.front(),
                 (*replay)->loop().stats().commits);
    if (const std::string many = what_exceeds(made.timeline, most); !many.empty())
      return bad("has more than " + many + "; cut a part with `nendo recording cut`");
  }
  if (!follower.has_seen()) return bad("there is no tick of a loop in it");
  if (const std::string wrong = complaint_about(made.timeline); !wrong.empty())
    return bad("cannot become a timeline: " + wrong);
  for (auto& hand : made.timeline.hands) {
    made.hands.push_back(reduce_keys(hand.skeleton(), hand.keys, tolerance));
    hand.keys = std::exchange(made.hands.back().keys, {});
  }
  made.exact = (*replay)->is_exact() && reader->chunks().damage_count() == 0;
  return made;
}

} // namespace nendo::timeline
