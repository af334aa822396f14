#include "edit/edit_session.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <nendo/flow/finger_supports.hpp>
#include <nendo/version.hpp>

#include "cli/figures.hpp"
#include "commands/commands.hpp"
#include "edit/edit_actions.hpp"
#include "export/chosen_frames.hpp"
#include "export/gltf_export.hpp"
#include "takes/timeline_frames.hpp"
#include "timeline/edit.hpp"
#include "timeline/timeline.hpp"

namespace nendo::edit {
using namespace timeline;
using forms::EditCommand;
using forms::StripKey;

namespace {

using Selection = std::optional<KeyRef>;

std::string export_name(const std::string& out) {
  return out.substr(0, out.size() - file_ending.size()) + ".glb";
}

} // namespace

/// Exports a timeline as a GLB file on a thread of its own while the timeline is edited further.
class GlbExport {
public:
  /// Starts the export. The file appears only when it is complete.
  GlbExport(const Timeline& timeline, const deform::Mesh& model, const std::string& path)
      : thread_([this, timeline, model, path] {
          const auto frames = takes::TimelineFrames::make(timeline, model);
          const exporting::Choice choice{.rate_hz = exporting::animators_rate_hz, .stop = &stop_};
          exporting::GltfOptions options;
          options.generator = "Nendo " NENDO_VERSION;
          if (frames)
            result_ = exporting::export_gltf(**frames, choice, options, path);
          else
            result_ = frames.error();
          done_ = true;
        }) {}
  /// Stops the export if it is still running, and waits for its thread.
  ~GlbExport() {
    stop_ = true;
    thread_.join();
  }
  GlbExport(const GlbExport&) = delete;
  GlbExport& operator=(const GlbExport&) = delete;

  /// Returns the result of the export, or nothing while it is running. Errors: those of
  /// export_gltf().
  std::optional<Result<exporting::Exported>> result() const {
    if (!done_) return std::nullopt;
    return result_;
  }

private:
  std::atomic<bool> stop_ = false;
  std::atomic<bool> done_ = false;
  std::optional<Result<exporting::Exported>> result_; ///< once done_
  std::thread thread_;
};

EditSession::EditSession(Timeline timeline, deform::Mesh model, std::string out)
    : model_(std::move(model)), out_(std::move(out)), export_file_(export_name(out_)),
      history_(std::move(timeline)), cache_(model_),
      pictures_(history_.timeline().units_per_metre) {
  follow_history();
}

EditSession::~EditSession() = default;

void EditSession::report(std::string message, bool refused) {
  view_.message = std::move(message);
  view_.refused = refused;
}

void EditSession::report(const Result<void>& done, const std::string& message) {
  report(done ? message : done.error().message, !done);
}

Selection EditSession::key_of(const StripKey& key) const {
  const auto& hands = history_.timeline().hands;
  if (key.lane >= hands.size()) return std::nullopt;
  return KeyRef{hands[key.lane].side, key.key};
}

commands::EditFacts EditSession::facts() const noexcept {
  return {head_.is_playing(), history_.can_undo(), history_.can_redo(), export_ != nullptr,
          history_.selected().has_value()};
}

void EditSession::handle(const forms::EditActions& actions) {
  if (actions.select) {
    history_.keep(); // a trial with another key
    select(key_of(*actions.select));
  }
  if (actions.seek_s) seek(*actions.seek_s);
  if (actions.speed) head_.set_speed(*actions.speed);
  if (actions.tried) std::visit([this](const auto& tried) { try_out(tried); }, *actions.tried);
  if (!actions.cells.empty()) set_cells(actions.cells);
  if (actions.keep) history_.keep();
  if (actions.drop) {
    history_.drop();
    select(history_.selected());
    report("given up");
  }
  if (actions.retiming) retime(*actions.retiming);
  for (const EditCommand command : actions.commands)
    handle(command);
  follow_history();
}

void EditSession::handle(EditCommand command) {
  // A trial that changed nothing is no step to undo.
  if (command == EditCommand::undo || command == EditCommand::redo) history_.keep();
  if (const char* const refusal = commands::row_of(command).refusal_in(facts()))
    return report(refusal, true);
  execute(command);
}

void EditSession::execute(EditCommand command) {
  constexpr double faster = 1.25;
  switch (command) {
  case EditCommand::play:
    return head_.toggle(head_limit_s());
  case EditCommand::to_begin:
    return seek(0.0);
  case EditCommand::to_end:
    return seek(head_limit_s());
  case EditCommand::previous_key:
    return go_to_neighbour(false);
  case EditCommand::next_key:
    return go_to_neighbour(true);
  case EditCommand::previous_frame:
    return step(-1.0);
  case EditCommand::next_frame:
    return step(1.0);
  case EditCommand::slower:
    return head_.set_speed(head_.speed() / faster);
  case EditCommand::faster:
    return head_.set_speed(head_.speed() * faster);
  case EditCommand::loop:
    return head_.set_loops(!head_.loops());
  case EditCommand::add_key:
    return add_keys();
  case EditCommand::copy_key:
    return copy_key();
  case EditCommand::delete_key:
    return delete_key();
  case EditCommand::select_none:
    return history_.select({});
  case EditCommand::mirror:
    return mirror();
  case EditCommand::undo:
    return step_history(false);
  case EditCommand::redo:
    return step_history(true);
  case EditCommand::save:
    return save();
  case EditCommand::export_glb:
    return begin_export();
  }
}

/// The head goes with the selected key, if it was at it.
void EditSession::step_history(bool redoes) {
  redoes ? history_.redo() : history_.undo();
  report(redoes ? "redone" : "undone");
  if (view_.at_selected) select(history_.selected());
}

void EditSession::advance(double elapsed_s) {
  head_.advance(elapsed_s, head_limit_s());
  follow_export();
}

void EditSession::seek(double time_s) {
  head_.pause();
  head_.seek(time_s, head_limit_s());
}

void EditSession::select(const Selection& key) {
  history_.select(key);
  if (history_.selected()) seek(find_key(history_.timeline(), *history_.selected())->time_s);
}

/// Goes to a key of the selected key's hand, or with none selected of either hand.
void EditSession::go_to_neighbour(bool next) {
  const auto& selected = history_.selected();
  const auto side = selected ? std::optional(selected->side) : std::nullopt;
  const auto key = (next ? key_after : key_before)(history_.timeline(), head_.time_s(), side);
  if (!key) return report(next ? "there is no later key" : "there is no earlier key", true);
  select(key);
}

void EditSession::step(double frames) {
  constexpr double a_hair = 1e-6; // of a frame: one that the head is on counts as here
  const double rate_hz = history_.timeline().rate_hz;
  const double at = head_.time_s() * rate_hz;
  const double here = frames < 0.0 ? std::ceil(at - a_hair) : std::floor(at + a_hair);
  seek((here + frames) / rate_hz);
}

void EditSession::save() {
  history_.keep();
  const auto written = write_timeline(out_, history_.timeline());
  if (written) history_.saved();
  report(written, "saved to " + out_);
}

void EditSession::begin_export() {
  history_.keep();
  export_ = std::make_unique<GlbExport>(history_.timeline(), model_, export_file_);
  report("exporting to " + export_file_);
}

void EditSession::follow_export() {
  const auto result = export_ ? export_->result() : std::nullopt;
  if (!result) return;
  export_.reset();
  if (*result)
    report(export_file_ + ": " + cli::fixed(static_cast<double>((*result)->bytes) / 1e6, 1) +
           " MB");
  else
    report(Result<void>((*result).error()), {});
}

/// What is made of the timeline, of the latest.
void EditSession::follow_history() {
  if (followed_ == history_.revision()) return;
  followed_ = history_.revision();
  const Timeline& timeline = history_.timeline();
  cache_.follow(timeline);
  hands_.clear();
  view_.lanes.clear();
  view_.marks.clear();
  for (const HandTrack& hand : timeline.hands) {
    hands_.emplace_back(hand);
    auto& lane = view_.lanes.emplace_back();
    lane.side = hand.side;
    for (const Key& key : hand.keys)
      lane.keys_s.push_back(key.time_s);
  }
  for (const Event& event : timeline.events)
    view_.marks.push_back({event.time_s, in_words(timeline, event)});
  view_.file = out_;
  view_.duration_s = timeline.duration_s;
  view_.rate_hz = timeline.rate_hz;
  scene_frame_.radius_m =
      flow::radii_on_stage(timeline.sculptor.deformer.supports, timeline.units_per_metre);
  head_.seek(head_.time_s(), timeline.duration_s);
}

const forms::TimelineView& EditSession::view() {
  const Timeline& timeline = history_.timeline();
  view_.head_s = head_.time_s();
  view_.loops = head_.loops();
  view_.speed = head_.speed();
  view_.selected.reset();
  view_.at_selected = false;
  if (const auto& key = history_.selected()) {
    const auto lane = static_cast<std::size_t>(timeline.track(key->side) - timeline.hands.data());
    view_.selected = StripKey{lane, key->key};
    view_.at_selected = find_key(timeline, *key)->time_s == view_.head_s && !head_.is_playing();
  }
  view_.modified = history_.is_modified();
  view_.facts = facts();
  const auto progress = cache_.progress();
  view_.computing = !progress.done;
  view_.computed_s = progress.until_s;
  const auto found = shape();
  view_.shape_is_old = !found.fresh;
  follow_functions(found.shape.get());
  follow_pictures();
  if (progress.error) report(Result<void>(*progress.error), {});
  return view_;
}

/// The previous cells keep their pictures until others are drawn.
void EditSession::set_cells(std::vector<forms::StripPicture> cells) {
  for (forms::StripPicture& cell : cells)
    for (const forms::StripPicture& before : view_.pictures)
      if (before.from_s == cell.from_s && before.to_s == cell.to_s) cell.image = before.image;
  view_.pictures = std::move(cells);
}

void EditSession::follow_pictures() {
  std::vector<ShapePictures::Shape> shapes;
  for (const forms::StripPicture& cell : view_.pictures) {
    const auto found = cache_.nearest((cell.from_s + cell.to_s) / 2.0);
    shapes.push_back(found.fresh ? found.shape : nullptr);
  }
  const auto pictures = pictures_.of(shapes);
  for (std::size_t at = 0; at < pictures.size(); ++at)
    if (pictures[at] != nullptr) view_.pictures[at].image = pictures[at];
  has_all_pictures_ = !pictures.empty() && std::ranges::find(pictures, nullptr) == pictures.end();
}

/// Reads the curves again when more shapes are made.
void EditSession::follow_functions(const timeline::CachedShape* at_head) {
  const Timeline& timeline = history_.timeline();
  if (at_head == nullptr || at_head->functions.empty()) return view_.functions.clear();
  view_.functions.resize(at_head->functions.size());
  for (std::size_t at = 0; at < view_.functions.size(); ++at)
    view_.functions[at].value = static_cast<double>(at_head->functions[at]);
  const CurvesOf now{view_.computed_s, followed_};
  if (std::exchange(curves_of_, now) == now) return;
  constexpr std::size_t points = 240;
  const auto shapes = cache_.all();
  for (std::size_t at = 0; at < view_.functions.size(); ++at) {
    forms::FunctionCurve& curve = view_.functions[at];
    curve.name = timeline.rig->puppet().functions[at].name;
    curve.over_time.clear();
    std::size_t next = 0; // the first shape that is not before the point
    for (std::size_t point = 0; point < points; ++point) {
      const double time_s = timeline.duration_s * static_cast<double>(point) / (points - 1);
      while (next < shapes.size() && shapes[next]->time_s < time_s)
        ++next;
      if (next == shapes.size()) break;
      curve.over_time.push_back(shapes[next]->functions[at]);
    }
    curve.over_time.resize(points, curve.over_time.empty() ? 0.0F : curve.over_time.back());
  }
}

std::array<std::optional<puppet::HandState>, 2> EditSession::hands() const {
  std::array<std::optional<puppet::HandState>, 2> hands;
  for (const MovingHand& hand : hands_)
    hands[flow::Placement::index_of(hand.skeleton.side())] = hand.at(head_.time_s());
  return hands;
}

const render::SceneFrame& EditSession::scene_frame() {
  const auto found = shape();
  scene_frame_.time_s = head_.time_s();
  // Fingertips that play a puppet do not touch the model.
  scene_frame_.held =
      found.shape != nullptr && found.shape->held && history_.timeline().rig == nullptr;
  if (found.shape != nullptr) scene_frame_.radius_m = found.shape->radius_m;
  scene_frame_.hands = {};
  for (const MovingHand& hand : hands_) {
    render::SceneHand seen{hand.at(scene_frame_.time_s).pose, {}};
    const hand::HandPose& held =
        scene_frame_.held ? hand.at(found.shape->held_since_s).pose : seen.pose;
    seen.starts = held.fingertip_positions();
    scene_frame_.hands[flow::Placement::index_of(hand.skeleton.side())] = seen;
  }
  return scene_frame_;
}

namespace {

Result<Selection> after(const Result<void>& done, const Selection& selected) {
  if (!done) return done.error();
  return selected;
}

Error nothing_selected() {
  return {Errc::usage, commands::no_key};
}

} // namespace

void EditSession::try_out(const forms::KeyDrag& drag) {
  const auto key = key_of(drag.key);
  if (!key) return;
  const auto done = history_.try_out([&](Timeline& timeline) -> Result<Selection> {
    const auto moved = drag.copy ? timeline::copy_key(timeline, key->side, key->key, drag.to_s)
                                 : move_key(timeline, key->side, key->key, drag.to_s);
    return after(moved, key_at(timeline, key->side, drag.to_s));
  });
  report(done, (drag.copy ? "copied to " : "moved to ") + cli::fixed(drag.to_s, 3) + " s");
  if (done) seek(drag.to_s);
}

void EditSession::try_out(const forms::TipDrag& drag) {
  const Selection key = history_.selected();
  TipSet set;
  const auto done = history_.try_out([&](Timeline& timeline) -> Result<Selection> {
    if (!key) return nothing_selected();
    // Out of reach is reported, and the finger goes as far as it can.
    const auto bent = timeline::set_tip(timeline, key->side, key->key, drag.finger, drag.target_m,
                                        std::numeric_limits<double>::infinity());
    if (!bent) return bent.error();
    set = *bent;
    return key;
  });
  constexpr double fine_m = 1e-3;
  report(done, std::string(name_of(drag.finger)) +
                   (set.off_m > fine_m ? " tip: out of reach, " : " tip: ") +
                   cli::fixed(1e3 * set.off_m, 3) + " mm off");
}

void EditSession::try_out(const forms::KeyBlend& blend) {
  const Selection key = history_.selected();
  report(history_.try_out([&](Timeline& timeline) -> Result<Selection> {
    if (!key) return nothing_selected();
    return after(blend_key(timeline, key->side, key->key, blend.factor), key);
  }),
         "blended with its neighbours, " + cli::fixed(blend.factor, 2));
}

/// Of the selected key's hand; with none selected, of all hands that have none there.
void EditSession::add_keys() {
  const Selection selected = history_.selected();
  const double at_s = head_.time_s();
  report(history_.apply([&](Timeline& timeline) -> Result<Selection> {
    Result<Selection> added = nothing_selected(); // replaced, for there is a hand
    for (const HandTrack& hand : std::vector(timeline.hands)) {
      if (selected && selected->side != hand.side) continue;
      const auto done = add_key(timeline, hand.side, at_s);
      if (done)
        added = Selection(key_at(timeline, hand.side, at_s));
      else if (!added)
        added = done.error();
    }
    return added;
  }),
         "a key more, at " + cli::fixed(at_s, 3) + " s");
}

void EditSession::delete_key() {
  const KeyRef key = *history_.selected();
  report(history_.apply([&](Timeline& timeline) {
    return after(timeline::delete_key(timeline, key.side, key.key), std::nullopt);
  }),
         "deleted");
}

void EditSession::copy_key() {
  const KeyRef key = *history_.selected();
  const double to_s = head_.time_s();
  report(history_.apply([&](Timeline& timeline) {
    const auto copied = timeline::copy_key(timeline, key.side, key.key, to_s);
    return after(copied, key_at(timeline, key.side, to_s));
  }),
         "copied to " + cli::fixed(to_s, 3) + " s");
}

void EditSession::mirror() {
  Selection key = history_.selected();
  if (key) key->side = opposite(key->side);
  report(history_.apply([&](Timeline& timeline) {
    return after(timeline::mirror(timeline, takes::middle_plane_m(timeline, model_)), key);
  }),
         "mirrored");
}

void EditSession::retime(const forms::Retiming& times) {
  report(history_.apply([&](Timeline& timeline) {
    return after(timeline::retime(timeline, times.scale, times.from_s, times.to_s),
                 history_.selected());
  }),
         "re-timed, " + cli::fixed(times.scale, 3) + " times as long");
}

} // namespace nendo::edit
