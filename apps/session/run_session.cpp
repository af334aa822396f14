#include "session/run_session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <limits>
#include <utility>

#include <nendo/deform/triangles.hpp>
#include <nendo/deform/undo_memory.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/flow/setting.hpp>
#include <nendo/sculpting/loop_thread.hpp>
#include <nendo/sculpting/placing.hpp>

#include "cli/cli.hpp"
#include "cli/terminal.hpp"
#include "commands/commands.hpp"
#include "gloves/glove_feedback.hpp"
#include "gloves/stuck_sensors.hpp"
#include "gloves/wrist_notices.hpp"
#include "render/picture.hpp"
#include "render/scene_frame.hpp"
#include "session/run_commands.hpp"
#include "session/run_models.hpp"

namespace nendo::session {
namespace {

using std::chrono::milliseconds;

constexpr render::View picture_view{22.0, 10.0};
constexpr render::Size panel_size{408, 392};

/// Draws the picture of a run: the model at the grab and at the end, with the hands.
class RunPicture {
public:
  /// Does nothing, and writes nothing, if `path` is empty.
  RunPicture(std::filesystem::path path, const deform::Mesh& model) : path_(std::move(path)) {
    if (!path_.empty()) before_ = model;
  }

  /// Call it for each frame that the main thread gets, from the beginning on. Allocates.
  void add(const flow::Frame& frame) {
    if (path_.empty()) return;
    holds_.follow(frame);
    render::set_hands(frame, holds_, last_);
    if (units_per_metre_ > 0.0) return;
    units_per_metre_ = frame.units_per_metre;
    first_ = last_;
    first_.radius_m = frame.settings.radius_m;
  }
  /// Sets the rest shape of the last frame's model, which decides the triangles of the final shape
  /// (triangles.hpp).
  void set_rest(const deform::Points& rest) {
    if (!path_.empty()) last_rest_ = rest;
  }
  /// Draws and writes the picture. Call it after the last frame. Blocks for some seconds. Error:
  /// failed.
  Result<void> write(const deform::Mesh& final_shape) {
    using namespace nendo::render;
    if (path_.empty()) return {};
    first_.vertices = before_.vertices;
    last_.vertices = final_shape.vertices;
    Scene before, after;
    SceneBuilder(before_, units_per_metre_).build(first_, {}, before);
    const bool has_rest = last_rest_.cols() == final_shape.vertices.cols();
    SceneBuilder(has_rest ? deform::with_triangles_of(final_shape, last_rest_) : final_shape,
                 units_per_metre_)
        .build(last_, {}, after);
    auto points = before.outline();
    const auto more = after.outline();
    points.insert(points.end(), more.begin(), more.end());
    const Camera camera =
        framing(points, picture_view, 1.0 * panel_size.width / panel_size.height, 0.04);
    const auto panel = [&](const Scene& scene, const char* caption) {
      return Panel{draw(Lighting(scene, picture_view.azimuth_deg), camera, panel_size), caption};
    };
    return write_png(
        path_, contact_sheet({panel(before, "Before: both hands grab"), panel(after, "After")}, 2));
  }

private:
  std::filesystem::path path_;
  deform::Mesh before_;
  deform::Points last_rest_;
  render::HoldTracker holds_;
  render::SceneFrame first_, last_;
  double units_per_metre_ = 0.0; ///< 0: no frame was added
};

/// The keys of a run, in its terminal.
class RunKeys final : public Observer {
public:
  /// `timeout` is how long update() waits for a key.
  explicit RunKeys(milliseconds timeout) : timeout_(timeout) {
    if (keys_.are_available()) cli::note("keys: ? lists them, q ends the run");
  }

  void update(const RunStatus& status, Asks& asks) override {
    const auto key = keys_.next(timeout_);
    if (!key) return;
    const auto* const row = commands::with_key({&*key, 1}, commands::in_terminal);
    if (row == nullptr) return;
    if (!row->is_for_run())
      return report("keys:" + commands::key_list(commands::in_terminal, "\n  ", "  "));
    pending_.follow(status.frame.settings);
    const commands::Answer answer = commands::press(*row, status.situation(), pending_);
    if (answer.command) asks.emplace_back(*answer.command);
    if (answer.refusal != nullptr) report(answer.refusal);
    if (row->choose != nullptr && answer.command)
      report(flow::in_words(pending_.now, status.frame.units_per_metre));
  }
  /// Writes to standard error, also without keys.
  void report(const Report& message) override {
    std::cerr << '\n'; // so that the line of progress is not overwritten
    cli::note(message.text);
  }

private:
  cli::Keys keys_;
  milliseconds timeout_;
  flow::PendingSettings pending_;
};

std::size_t max_undo_bytes(const RunOptions& options) noexcept {
  return options.undo_memory_mb ? static_cast<std::size_t>(1e6 * *options.undo_memory_mb)
                                : deform::half_of_memory();
}

// A run: its loop and its participants.
class Session {
public:
  Session(RunOptions options, std::vector<gloves::OpenHand>& hands, deform::Mesh model,
          const RunParticipants& participants, std::vector<flow::Grant> grants)
      : options_(std::move(options)), hands_(hands), model_(std::move(model)),
        participants_(participants), grants_(std::move(grants)),
        recorder_(options_, placed_, hands_, model_),
        models_(placed_, participants_.sinks, options_.refine_to, options_.changes_topology),
        saving_(options_, recorder_),
        commands_(options_, placed_, participants_.sinks, recorder_, models_, saving_,
                  [this](const Report& message) { report(message); }) {
    for (const auto& hand : hands_)
      feedback_.push_back({hand.side, gloves::GloveFeedback(*hand.glove)});
    options_.loop.commands = &commands_.ring();
    sculpting::set_undo_space(model_, max_undo_bytes(options_), options_.loop);
    options_.loop.sinks.assign(participants_.sinks.begin(), participants_.sinks.end());
  }

  Result<RunOutcome> run() {
    if (auto* const log = recorder_.first_log()) options_.loop.input_log = log;
    auto placed = place_loop(options_, hands_, model_);
    if (!placed) return placed.error();
    placed_ = *std::move(placed);
    if (const auto begun = recorder_.begin(); !begun) return begun.error();
    for (Sink* sink : participants_.sinks)
      if (const auto begun = sink->begin(start()); !begun) return begun.error();
    RunPicture picture(options_.picture, model_);
    RunKeys keys(key_timeout());
    observers_.push_back(&keys);
    observers_.insert(observers_.end(), participants_.observers.begin(),
                      participants_.observers.end());
    if (const auto begun = begin_gloves(); !begun) return begun.error();
    run_loop(picture);
    for (auto& [side, feedback] : feedback_)
      feedback.put_out();
    gloves::stop(hands_);
    if (!options_.hands_only && !is_shape_settled())
      if (const auto written = write_shape(options_.out, model_, options_.reading.up_axis());
          !written)
        return written.error();
    if (const auto drawn = picture.write(model_); !drawn) return drawn.error();
    for (Observer* observer : observers_)
      if (const auto ended = observer->end(); !ended) return ended.error();
    const flow::SculptorOptions& sculptor = placed_.loop->changes().sculptor_options();
    RunOutcome outcome{placed_.loop->stats(),
                       elapsed_s_,
                       model_.vertices.cols(),
                       deform::max_radius(sculptor.deformer.supports),
                       is_shape_settled() ? saving_.saved() : options_.out,
                       std::move(grants_),
                       recorder_.outcomes()};
    outcome.sculptor = sculptor;
    outcome.units_per_metre = placed_.setup.placement.units_per_metre;
    for (const Observer* observer : observers_)
      if (const auto* const times = observer->picture_times()) outcome.pictures = *times;
    return outcome;
  }

private:
  LoopStart start() const { return {placed_, model_, hands_}; }

  // Returns how long the keys wait, which is not at all if another observer sets the pace.
  milliseconds key_timeout() const {
    const auto& observers = participants_.observers;
    const bool paced = std::any_of(observers.begin(), observers.end(),
                                   [](const Observer* observer) { return observer->sets_pace(); });
    return milliseconds(paced ? 0 : 20);
  }

  void report(const Report& message) {
    for (Observer* observer : observers_)
      observer->report(message);
  }

  bool is_shape_settled() const {
    return std::any_of(observers_.begin(), observers_.end(),
                       [](const Observer* observer) { return observer->has_settled_shape(); });
  }

  commands::RunFacts facts() const {
    return {recorder_.is_to_file(), recorder_.is_recording(), recorder_.keeps_last_minute(),
            placed_.setup.live_layers() != 0};
  }

  void save() { report(saving_.save(*placed_.loop)); }

  void update_observers(bool fresh) {
    const flow::Frame& frame = placed_.loop->frames().front();
    const flow::ModelVersion& model = *placed_.loop->changes().model(frame.model);
    settle_sinks();
    commands_.follow_frame(frame);
    follow_stuck(frame);
    follow_wrists(frame);
    const RunStatus status{frame,    model,
                           fresh,    devices_,
                           facts(),  placed_.loop->changes().puppet(frame.puppet),
                           &saving_, recorder_.last_file()};
    asks_.clear();
    for (Observer* observer : observers_)
      observer->update(status, asks_);
    commands_.execute(asks_);
    commands_.follow(fresh);
  }

  /// Reports once for each sensor that it is stuck, or moves again.
  void follow_stuck(const flow::Frame& frame) {
    if (frame.ticks_run == 0) return;
    for (const auto& hand : hands_) {
      const std::size_t slot = flow::Placement::index_of(hand.side);
      for (const std::string& sentence : stuck_[slot].changes(frame.hands[slot].left_out))
        report({hand.glove->info().source + ": " + sentence, true});
    }
  }
  /// Reports wrists that a tracker loses and has again, and receivers in the wrong hemisphere.
  void follow_wrists(const flow::Frame& frame) {
    if (frame.ticks_run == 0) return;
    for (const auto& hand : hands_) {
      if (!hand.wrist) continue;
      const std::size_t slot = flow::Placement::index_of(hand.side);
      for (const std::string& sentence : wrists_[slot].changes(
               hand.side, frame.hands[slot], frame.scheduled, hand.wrist->station))
        report({hand.wrist->station.source + ": " + sentence, true});
    }
  }
  void look_at_devices() {
    devices_ = device_watch_.look(hands_, placed_.loop->frames().front(), HostClock::now());
  }
  void settle_sinks() {
    const std::uint32_t model = placed_.loop->frames().front().model;
    if (std::exchange(shown_model_, model) == model) return;
    for (Sink* sink : participants_.sinks)
      if (const auto settled = sink->settle(); !settled) report(settled.error());
  }

  // Commands that came just before the end are still executed, if the loop ticks at all.
  void wait_until_taken() {
    auto& frames = placed_.loop->frames();
    const HostTime begin = HostClock::now();
    const auto waits_for = [&](milliseconds max) { return HostClock::now() - begin < max; };
    // Only a further frame shows that an undo waits for settings.
    for (bool is_news = false; waits_for(milliseconds(commands_.is_due() ? 1000 : 100));) {
      std::this_thread::sleep_for(milliseconds(1));
      const bool fresh = frames.update();
      settle_sinks();
      commands_.follow(fresh);
      is_news = is_news || fresh;
      if (is_news && !commands_.is_due() && !frames.front().awaited) return;
    }
  }

  // Called last, because simulated hands act at times of the run.
  Result<void> begin_gloves() {
    look_at_devices();
    for (Observer* observer : observers_)
      observer->loop_begins(start());
    if (options_.over) std::this_thread::sleep_until(options_.over->begin);
    const flow::InheritedPriority readers(flow::reader_priority(options_.realtime.priority));
    return gloves::begin_again(hands_);
  }

  // Runs the loop until it ends, and leaves its shape in model_.
  void run_loop(RunPicture& picture) {
    flow::DeformLoop& loop = *placed_.loop;
    sculpting::LoopThread thread(loop, options_.realtime, ticks_for(options_));
    for (flow::Grant& grant : thread.grants())
      grants_.push_back(std::move(grant));
    for (const auto& line : flow::refusals(grants_))
      cli::note(line);
    watch(thread, picture);
    if (commands_.ends()) wait_until_taken();
    if (saving_.is_due()) save(); // asked for just before the end
    thread.stop();
    elapsed_s_ = to_seconds(HostClock::now() - thread.start);
    deform::Mesh shape = loop.final_mesh();
    recorder_.end(shape.vertices); // which compares with the model as it was loaded
    model_ = std::move(shape);
    if (loop.frames().update()) picture.add(loop.frames().front());
    if (const auto last = loop.changes().model(loop.frames().front().model))
      picture.set_rest(last->mesh.vertices);
  }

  // Returns whether all gloves have ended, and the loop has taken all of their samples. Its present
  // tick, which is completed before it stops, shows the last ones.
  bool is_exhausted() const {
    if (options_.over) return options_.over->take.script->has_ended();
    return gloves::have_ended(hands_) && placed_.loop->frames().front().ticks_run > 0 &&
           std::all_of(hands_.begin(), hands_.end(),
                       [](const auto& hand) { return hand.ring->size() == 0; });
  }

  // Returns whether the run ends with the gloves. A window's user decides that.
  bool ends_with_gloves() {
    if (!is_exhausted()) return false;
    const auto& observers = participants_.observers;
    if (std::none_of(observers.begin(), observers.end(),
                     [](const Observer* observer) { return observer->stays_open(); }))
      return true;
    if (!std::exchange(end_reported_, true))
      report("the recording has ended, and the hands stay in place; press q or close the window to "
             "end "
             "the run");
    return false;
  }

  // The LED shows whether the hands hold the model. Vibrators signal contact with clay.
  void give_feedback(const flow::Frame& frame) noexcept {
    const bool both = frame.hands[0].present && frame.hands[1].present;
    for (auto& [side, feedback] : feedback_) {
      if (options_.loop.switch_action != flow::SwitchAction::none) feedback.show(frame.held);
      feedback.feel(
          flow::touch_of(frame.contacts.all(), both ? flow::Placement::index_of(side) : 0));
    }
  }

  void watch(const sculpting::LoopThread& thread, RunPicture& picture) {
    auto& frames = placed_.loop->frames();
    HostTime next_progress = thread.start;
    bool is_news = false;
    while (!thread.ended && !cli::stop_requested() && !is_over(options_, thread.start)) {
      placed_.loop->changes().refill_undo();
      const bool fresh = frames.update();
      if (fresh) {
        is_news = true;
        give_feedback(frames.front());
        picture.add(frames.front());
      }
      update_observers(fresh);
      if (commands_.ends() || ends_with_gloves()) return;
      if (saving_.is_due_now()) save();
      if (HostClock::now() < next_progress) continue;
      look_at_devices();
      if (is_news)
        participants_.progress(frames.front(), to_seconds(HostClock::now() - thread.start));
      is_news = false;
      next_progress += milliseconds(250);
    }
  }

  RunOptions options_;
  std::vector<gloves::OpenHand>& hands_;
  deform::Mesh model_; ///< as it was loaded, and at the end as the hands left it
  const RunParticipants& participants_;
  std::vector<Observer*> observers_;
  std::vector<flow::Grant> grants_;
  Asks asks_;         ///< the new requests of all observers
  PlacedLoop placed_; ///< outlives what another thread may be making of its model
  RunRecorder recorder_;
  RunModels models_;
  std::uint32_t shown_model_ = 0; ///< the model of the latest frame
  RunSaving saving_;
  RunCommands commands_;
  struct Felt {
    Side side;
    gloves::GloveFeedback feedback;
  };
  std::vector<Felt> feedback_; ///< the feedback of all gloves
  gloves::DeviceWatch device_watch_;
  gloves::DeviceStatuses devices_;
  double elapsed_s_ = 0.0;
  bool end_reported_ = false;                    ///< the end of all gloves was reported
  std::array<gloves::StuckNotices, 2> stuck_{};  ///< index: flow::Placement::index_of(side)
  std::array<gloves::WristNotices, 2> wrists_{}; ///< the same
};

} // namespace

std::uint64_t ticks_for(const RunOptions& options) noexcept {
  // Ticks that follow samples, or slip, do not measure time.
  const auto policy = options.loop.policy;
  const bool on_grid =
      policy == flow::OverrunPolicy::skip || policy == flow::OverrunPolicy::catch_up;
  if (options.duration_s <= 0.0 || !on_grid) return std::numeric_limits<std::uint64_t>::max();
  return static_cast<std::uint64_t>(
      std::max(1.0, std::round(options.duration_s * options.loop.rate_hz)));
}

bool is_over(const RunOptions& options, HostTime start) noexcept {
  if (options.duration_s <= 0.0) return false;
  const bool on_grid = ticks_for(options) != std::numeric_limits<std::uint64_t>::max();
  return !on_grid && to_seconds(HostClock::now() - start) >= options.duration_s;
}

Result<RunOutcome> run_session(RunOptions options, std::vector<gloves::OpenHand>& hands,
                               deform::Mesh model, const RunParticipants& participants,
                               std::vector<flow::Grant> grants) {
  return Session(std::move(options), hands, std::move(model), participants, std::move(grants))
      .run();
}

} // namespace nendo::session
