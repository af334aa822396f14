#include "session/run_session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include <nendo/deform/undo_memory.hpp>
#include <nendo/flow/rig_setup.hpp>

#include "cli/cli.hpp"
#include "gloves/glove_feedback.hpp"
#include "gloves/stuck_sensors.hpp"
#include "session/loop_thread.hpp"
#include "session/mask_edits.hpp"
#include "session/run_keys.hpp"
#include "session/run_models.hpp"
#include "session/run_picture.hpp"
#include "session/run_saving.hpp"

namespace nendo::session {
namespace {

using std::chrono::milliseconds;

// Returns the memory for undo at the beginning: room for some dozens of whole shapes, of which
// strokes mostly change parts.
std::size_t undo_bytes_for(const deform::Mesh& model) noexcept {
  constexpr std::size_t most = std::size_t{64} << 20;
  constexpr std::size_t shapes_of_a_vertex = std::size_t{64} * 3 * sizeof(float);
  return std::min(most,
                  shapes_of_a_vertex * static_cast<std::size_t>(model.vertices.cols() + 1000));
}

std::size_t most_undo_bytes(const RunOptions& options) noexcept {
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
        saving_(options_, recorder_) {
    for (const auto& hand : hands_)
      feedback_.push_back({hand.side, gloves::GloveFeedback(*hand.glove)});
    options_.loop.commands = &loop_commands_;
    const std::size_t most = most_undo_bytes(options_);
    const std::size_t at_once = std::min(undo_bytes_for(model_), most);
    options_.loop.sculptor.deformer.undo_bytes = at_once;
    options_.loop.undo_most_bytes = most - at_once;
    options_.loop.sinks.assign(participants_.sinks.begin(), participants_.sinks.end());
  }

  Result<RunOutcome> run() {
    options_.loop.input_log = recorder_.first_log();
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
    for (const auto& hand : hands_)
      hand.glove->stop();
    if (const auto written =
            write_shape(options_.out, model_, options_.reading.up.value_or(deform::UpAxis::y));
        !written)
      return written.error();
    if (const auto drawn = picture.write(model_); !drawn) return drawn.error();
    for (Observer* observer : observers_)
      if (const auto ended = observer->end(); !ended) return ended.error();
    const flow::SculptorOptions& sculptor = placed_.loop->changes().sculptor_options();
    RunOutcome outcome{placed_.loop->stats(),  elapsed_s_,
                       model_.vertices.cols(), deform::largest_radius(sculptor.deformer.supports),
                       options_.out,           std::move(grants_),
                       recorder_.outcomes()};
    outcome.sculptor = sculptor;
    outcome.units_per_metre = placed_.setup.placement.units_per_metre;
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

  void report(const std::string& message) {
    for (Observer* observer : observers_)
      observer->report(message);
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
    follow_layers(frame);
    follow_wire(frame);
    follow_stuck(frame);
    const RunStatus status{frame,   model,   fresh,
                           gloves_, facts(), placed_.loop->puppet(frame.puppet)};
    for (Observer* observer : observers_) {
      observer->update(status, commands_);
      if (auto puppet = observer->take_puppet()) puppet_ = std::move(puppet);
    }
    commands_.drain([this](const flow::Command& command) noexcept { dispatch(command); });
    follow_take();
    for (auto& wrist : wrists_)
      if (wrist)
        loop_commands_.try_push(*std::exchange(wrist, {})); // if it is full, the next move counts
    if (const auto refused = std::exchange(refused_, {}); refused && !refusal_reported_) {
      refusal_reported_ = true;
      report("the loop does not answer, so it was not asked to " + std::string(name_of(*refused)));
    }
    change_loop(fresh);
  }

  // Passes on the newest settings when the loop has those before, begins or ends a recording, and
  // goes on with making a model.
  void change_loop(bool fresh) {
    flow::DeformLoop& loop = *placed_.loop;
    const flow::Frame& frame = loop.frames().front();
    const bool awaits = frame.awaited.has_value(); // by an undo or a redo
    if (fresh && awaits && !settings_) tell(models_.go_to(*frame.awaited));
    if (settings_ && !loop.changes().is_changing() &&
        !loop.changes().change_settings(*std::exchange(settings_, {})))
      report("settings that nothing can be done with; the run goes on as it was (puppets "
             "do not act on clay, and one whose distances go along the surface cannot keep the "
             "volume)");
    if (!awaits) edit_masks();
    if (puppet_ && !awaits && !loop.changes().is_changing() && !recorder_.is_changing() &&
        !models_.is_handing_over())
      change_puppet();
    if (taken_puppet_ && !awaits && !loop.changes().is_changing() && !recorder_.is_changing() &&
        !models_.is_handing_over())
      follow_taken_puppet();
    // A recording has the whole of a wire that cuts in it, or nothing of it.
    if (record_ && !recorder_.is_changing() && !models_.is_handing_over() && !models_.is_due())
      recorder_.set_file(*std::exchange(record_, {}), frame);
    tell(recorder_.follow());
    tell(models_.follow(!awaits && !recorder_.is_changing()));
  }
  // What the take changes, and its loop does not do by itself.
  void follow_take() noexcept {
    if (options_.over)
      options_.over->take.script->for_others().drain([this](const flow::Command& command) noexcept {
        if (const auto* change = std::get_if<flow::ChangePuppet>(&command))
          taken_puppet_ = change->number; // only the newest counts
        else
          dispatch(command);
      });
  }
  /// Cuts by each wire that has been drawn.
  void follow_wire(const flow::Frame& frame) {
    if (std::exchange(wires_, frame.wire.completed()) == frame.wire.completed()) return;
    if (!frame.wire.is_drawn()) models_.cut(frame.wire);
  }
  void follow_layers(const flow::Frame& frame) {
    if (frame.ticks_run == 0) return;
    const bool on = (frame.layers_on & placed_.setup.live_layers()) != 0;
    if (is_in_ && *is_in_ != on) report(on ? "punched in" : "punched out");
    is_in_ = on;
  }
  /// Says once of each sensor that it is stuck, or moves again.
  void follow_stuck(const flow::Frame& frame) {
    if (frame.ticks_run == 0) return;
    for (const auto& hand : hands_) {
      const std::size_t slot = flow::Placement::index_of(hand.side);
      for (const std::string& sentence : stuck_[slot].changes(frame.hands[slot].left_out))
        report(hand.glove->info().source + ": " + sentence);
    }
  }
  void punch() noexcept {
    const std::uint32_t live = placed_.setup.live_layers();
    if (live == 0) return report(commands::no_layers);
    const bool on = !is_in_.value_or(true);
    for (std::size_t at = 0; at < placed_.setup.inputs.size(); ++at)
      if ((live >> at & 1U) != 0)
        loop_commands_.try_push(flow::SetLayer{static_cast<std::uint8_t>(at), on});
  }
  void change_puppet() {
    flow::DeformLoop& loop = *placed_.loop;
    const std::shared_ptr<const puppet::Rig> rig = std::exchange(puppet_, nullptr);
    const Eigen::Index functions =
        flow::is_played(rig.get()) ? rig->supports().functions(rig->starts().cols()) : 0;
    if (!participants_.sinks.empty() &&
        static_cast<std::size_t>(functions) > frame_capacity(placed_).functions)
      return report("a puppet with so many points more cannot be published; save it, and begin "
                    "again with it");
    recorder_.add_puppet(loop.changes().next_puppet(), *rig);
    if (const auto changed = loop.changes().change_puppet(rig); !changed)
      report(changed.error().message);
  }
  /// To a puppet of the take, which the loop has already if the take has changed to it before.
  void follow_taken_puppet() {
    const std::uint32_t number = *std::exchange(taken_puppet_, {});
    flow::DeformLoop& loop = *placed_.loop;
    const auto& puppets = options_.over->take.puppets;
    const auto of_take = puppets.find(number);
    const auto known = taken_puppets_.find(number);
    if (of_take == puppets.end() || known != taken_puppets_.end()) {
      const auto changed =
          loop.changes().change_puppet(of_take == puppets.end() ? 0 : known->second);
      if (!changed) report(changed.error().message);
      return;
    }
    auto rig = recording::rig_of(*of_take->second, loop.changes().model(0)->mesh);
    if (!rig) return report(rig.error().message);
    taken_puppets_[number] = loop.changes().next_puppet();
    puppet_ = *std::move(rig);
    change_puppet();
  }
  // Makes one puppet of all edits that have come.
  void edit_masks() {
    const flow::DeformLoop& loop = *placed_.loop;
    for (const flow::Command& command : std::exchange(mask_edits_, {})) {
      if (!puppet_) puppet_ = loop.changes().puppet(loop.changes().newest_puppet());
      auto edited = edited_masks(command, puppet_, loop.changes().model(0)->mesh.vertices);
      if (edited)
        puppet_ = *std::move(edited);
      else
        report(edited.error().message);
    }
    if (puppet_ == loop.changes().puppet(loop.changes().newest_puppet())) puppet_.reset();
  }
  void tell(const std::optional<std::string>& message) {
    if (message) report(*message);
  }
  void settle_sinks() {
    const std::uint32_t model = placed_.loop->frames().front().model;
    if (std::exchange(shown_model_, model) == model) return;
    for (Sink* sink : participants_.sinks)
      if (const auto settled = sink->settle(); !settled) report(settled.error().message);
  }

  void dispatch(const flow::Command& command) noexcept {
    const auto* const move = std::get_if<flow::WristMove>(&command);
    if (move != nullptr && !move->is_usable()) {
      if (!std::exchange(move_refused_, true)) report(std::string(flow::WristMove::refusal));
    } else if (move != nullptr) {
      move_refused_ = false;
      wrists_[flow::Placement::index_of(move->side)] = *move; // only the newest counts
    } else if (const auto* request = std::get_if<flow::Request>(&command)) {
      if (loop_commands_.try_push(command)) {
        refusal_reported_ = false;
      } else {
        refused_ = *request;
      }
    }
    if (const auto* change = std::get_if<flow::ChangeSettings>(&command))
      settings_ = change->settings; // only the newest count
    if (const auto* recording = std::get_if<flow::SetRecording>(&command)) record_ = recording->on;
    if (const auto change = flow::model_asked_by(command)) models_.ask(*change);
    if (std::holds_alternative<flow::DrawWire>(command)) loop_commands_.try_push(command);
    if (std::holds_alternative<flow::Mark>(command)) mark();
    if (std::holds_alternative<flow::Punch>(command)) punch();
    if (std::holds_alternative<flow::SetMask>(command)) mask_edits_.push_back(command);
    if (flow::is_for_puppet(command)) play_otherwise(command);
    ends_ = ends_ || std::holds_alternative<flow::EndRun>(command);
    saving_.add(command);
  }

  void play_otherwise(const flow::Command& command) noexcept {
    const flow::DeformLoop& loop = *placed_.loop;
    if (!flow::is_played(loop.changes().puppet(loop.changes().newest_puppet()).get()) &&
        !flow::is_played(puppet_.get()) && std::holds_alternative<flow::SetSymmetry>(command))
      mask_edits_.push_back(command);
    else if (!flow::is_played(loop.puppet(loop.newest_puppet()).get()))
      report(commands::no_puppet);
    else if (!loop_commands_.try_push(command))
      report("the loop does not answer, so it was not told how to play the puppet");
  }
  void mark() noexcept {
    const bool marks = recorder_.is_recording() && loop_commands_.try_push(flow::Mark{});
    if (marks) ++marks_;
    report(marks ? "mark " + std::to_string(marks_) + " is in the recording"
                 : commands::no_recording);
  }

  // Commands that came just before the end are still obeyed, if the loop ticks at all.
  void wait_until_taken() {
    const auto is_due = [this] {
      return loop_commands_.size() > 0 || settings_ || puppet_ || taken_puppet_ ||
             !mask_edits_.empty() || record_ || recorder_.is_changing() || models_.is_due() ||
             models_.is_handing_over() || placed_.loop->changes().is_changing();
    };
    auto& frames = placed_.loop->frames();
    const HostTime begin = HostClock::now();
    const auto waits_for = [&](milliseconds most) { return HostClock::now() - begin < most; };
    // Only a further frame tells that an undo waits for settings.
    for (bool is_news = false; waits_for(milliseconds(is_due() ? 1000 : 100));) {
      std::this_thread::sleep_for(milliseconds(1));
      const bool fresh = frames.update();
      settle_sinks();
      change_loop(fresh);
      is_news = is_news || fresh;
      if (is_news && !is_due() && !frames.front().awaited) return;
    }
  }

  // When all else is ready: what simulated hands do is done at times of the run.
  Result<void> begin_gloves() {
    gloves_ = status_of(hands_);
    for (Observer* observer : observers_)
      observer->loop_begins(start());
    if (options_.over) std::this_thread::sleep_until(options_.over->begin);
    const flow::InheritedPriority readers(flow::reader_priority(options_.realtime.priority));
    return gloves::begin_again(hands_);
  }

  // Runs the loop until it ends, and leaves its shape in model_.
  void run_loop(RunPicture& picture) {
    flow::DeformLoop& loop = *placed_.loop;
    LoopThread thread(loop, options_);
    report_refusals(thread.grants());
    watch(thread, picture);
    if (ends_) wait_until_taken();
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

  void report_refusals(std::vector<flow::Grant> of_thread) {
    std::move(of_thread.begin(), of_thread.end(), std::back_inserter(grants_));
    for (const auto& line : flow::refusals(grants_))
      cli::note(line);
  }

  // Returns whether no glove will send any more, and the loop has taken all that they sent. Its
  // present tick, for which whoever stops it waits, shows the last of it.
  bool is_exhausted() const {
    if (options_.over) return options_.over->take.script->has_ended();
    return gloves::have_ended(hands_) && placed_.loop->frames().front().ticks_run > 0 &&
           std::all_of(hands_.begin(), hands_.end(),
                       [](const auto& hand) { return hand.ring->size() == 0; });
  }

  // Returns whether the run ends for it. Somebody who looks at a window decides that himself.
  bool ends_with_gloves() {
    if (!is_exhausted()) return false;
    const auto& observers = participants_.observers;
    if (std::none_of(observers.begin(), observers.end(),
                     [](const Observer* observer) { return observer->stays_open(); }))
      return true;
    if (!std::exchange(end_reported_, true))
      report("the recording has ended, and the hands stay as they are; q or closing the window "
             "ends the run");
    return false;
  }

  // The LED shows whether the hands hold the model. What they touch of clay is felt.
  void give_feedback(const flow::Frame& frame) noexcept {
    const bool both = frame.hands[0].present && frame.hands[1].present;
    for (auto& [side, feedback] : feedback_) {
      if (options_.loop.switch_action != flow::SwitchAction::none) feedback.show(frame.held);
      feedback.feel(
          flow::touch_of(frame.contacts.all(), both ? flow::Placement::index_of(side) : 0));
    }
  }

  void watch(const LoopThread& thread, RunPicture& picture) {
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
      if (ends_ || ends_with_gloves()) return;
      if (saving_.is_due_now()) save();
      if (HostClock::now() < next_progress) continue;
      gloves_ = status_of(hands_);
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
  flow::CommandRing commands_{2048}; ///< of all observers
  flow::CommandRing loop_commands_{256};
  std::array<std::optional<flow::WristMove>, 2> wrists_; ///< not passed on yet
  std::optional<flow::Request> refused_;                 ///< the loop had no room for it
  bool refusal_reported_ = false;                        ///< and no request was accepted since
  bool move_refused_ = false;                            ///< the latest, of a wrist; it was said
  bool ends_ = false;                                    ///< somebody has asked for the end
  std::optional<flow::LoopSettings> settings_;           ///< not passed on yet
  std::shared_ptr<const puppet::Rig> puppet_;            ///< not passed on yet
  std::optional<std::uint32_t> taken_puppet_;            ///< likewise, by the take's number
  std::uint32_t wires_ = 0;                              ///< that have been drawn to their end
  std::map<std::uint32_t, std::uint32_t> taken_puppets_; ///< the loop's numbers of the take's
  std::vector<flow::Command> mask_edits_;                ///< likewise, and symmetry
  std::optional<bool> record_;                           ///< to a file, or not; not done yet
  PlacedLoop placed_; ///< outlives what another thread may be making of its model
  RunRecorder recorder_;
  RunModels models_;
  std::uint32_t shown_model_ = 0; ///< of the latest frame
  RunSaving saving_;
  struct Felt {
    Side side;
    gloves::GloveFeedback feedback;
  };
  std::vector<Felt> feedback_; ///< of all gloves
  GloveStatuses gloves_;
  double elapsed_s_ = 0.0;
  std::uint64_t marks_ = 0;
  bool end_reported_ = false;                   ///< that all gloves have ended
  std::array<gloves::StuckNotices, 2> stuck_{}; ///< by flow::Placement::index_of(side)
  std::optional<bool> is_in_;                   ///< the live layers play, in the latest frame
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
