#include "timeline/player.hpp"

#include <utility>

#include <nendo/deform/undo_memory.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::timeline {
namespace {

// Times in files are decimals, and a frame's is a quotient: what is so near belongs to it.
constexpr double a_hair = 1e-6; // of a frame

std::shared_ptr<flow::HandBodies> bodies_of(const Timeline& timeline, const deform::Mesh& model) {
  std::array<std::optional<hand::HandSkeleton>, 2> by_side;
  for (const HandTrack& track : timeline.hands)
    by_side[flow::Placement::index_of(track.side)] = track.skeleton();
  return flow::make_bodies(by_side, model, timeline.units_per_metre);
}

flow::CoreOptions core_options(const Timeline& timeline, const deform::Mesh& model) {
  flow::CoreOptions options;
  options.setup = {timeline.sculptor,
                   flow::settings_of(timeline.sculptor, {}, timeline.units_per_metre)};
  options.shaping.max_requests = timeline.events.size() + 1;
  options.shaping.held = timeline.held;
  options.shaping.changes_at_once = true;
  for (const HandTrack& track : timeline.hands)
    options.hands.push_back(track.side);
  options.inputs = timeline.hands.size();
  options.bodies = bodies_of(timeline, model);
  options.units_per_metre = timeline.units_per_metre;
  options.rig = timeline.rig;
  options.rig_state = timeline.rig_state;
  if (!timeline.masks.empty() && !timeline.rig) {
    options.rig = timeline.masks.front();
    options.more_rigs.assign(timeline.masks.begin() + 1, timeline.masks.end());
  }
  options.undo_max_bytes = deform::half_of_memory();
  return options;
}

/// Each subdivision makes at most four corners of one, and a copy two.
bool are_too_many(const std::vector<Event>& events, const deform::Mesh& model) {
  std::size_t corners = model.face_corners.size();
  for (const Event& event : events) {
    const bool divides = std::holds_alternative<flow::Subdivide>(event.command);
    if (divides && corners > flow::PendingModel::max_corners) return true;
    const auto* const edit = std::get_if<flow::EditPart>(&event.command);
    if (divides || (edit != nullptr && !edit->removes)) corners *= divides ? 4 : 2;
    if (corners > 4 * flow::PendingModel::max_corners) return true;
  }
  return false;
}

/// Makes the puppet's field along the surface, if it needs one and there is none.
Result<void> complete(Timeline& timeline, const deform::Mesh& model) {
  if (!timeline.rig) return {};
  if (const auto fits = puppet::check_fits(timeline.rig->puppet(), model); !fits)
    return Error{Errc::bad_input, "its puppet does not fit the model: " + fits.error().message};
  if (timeline.sculptor.surface) return {};
  auto surface = flow::surface_for(*timeline.rig, model, deform::BlockLayout(model.vertices),
                                   timeline.sculptor.deformer);
  if (!surface) return Error{Errc::bad_input, "its puppet: " + surface.error().message};
  timeline.sculptor.surface = *std::move(surface);
  return {};
}

} // namespace

Result<std::unique_ptr<Player>> Player::make(Timeline timeline, const deform::Mesh& model) {
  if (std::string wrong = complaint_about(timeline); !wrong.empty())
    return Error{Errc::bad_input, std::move(wrong)};
  if (are_too_many(timeline.events, model))
    return Error{Errc::bad_input, "the model would be too large when it is subdivided so often, or "
                                  "its parts are copied; take out such an event"};
  if (auto fits = complete(timeline, model); !fits) return fits.error();
  const flow::CoreOptions options = core_options(timeline, model);
  std::unique_ptr<Player> player(new Player(std::move(timeline), model, options));
  player->pose_hands(0.0);
  const deform::FieldStatus status = player->core_.begin(player->hands(), player->frame_);
  if (!is_solved(status))
    return Error{Errc::bad_input,
                 "the hands cannot grab the model: " + std::string(deform::describe(status))};
  return player;
}

Player::Player(Timeline timeline, const deform::Mesh& model, const flow::CoreOptions& options)
    : timeline_(std::move(timeline)), hands_(timeline_.hands.begin(), timeline_.hands.end()),
      changes_(model, options), core_(changes_, options), frame_(core_.first_frame()),
      frames_(static_cast<std::uint64_t>(timeline_.duration_s * timeline_.rate_hz + a_hair) + 1) {
  frame_.held = timeline_.held;
}

double Player::time_of(std::uint64_t frame) const noexcept {
  return static_cast<double>(frame) / timeline_.rate_hz;
}

double Player::time_s() const noexcept {
  return time_of(made_ == 0 ? 0 : made_ - 1);
}

double Player::last_time_s() const noexcept {
  return time_of(frames_ - 1);
}

void Player::pose_hands(double time_s) {
  for (const MovingHand& hand : hands_) {
    const std::size_t slot = flow::Placement::index_of(hand.skeleton.side());
    const puppet::HandState& pose = poses_[slot] = hand.at(time_s);
    flow::HandFrame& shown = frame_.hands[slot];
    shown.angles = pose.angles;
    shown.T_stage_wrist = pose.T_world_wrist;
    shown.pose = pose.pose;
    shown.present = true;
    shown.samples = made_ + 1;
  }
}

flow::ShapingCore::Hands Player::hands() const noexcept {
  flow::ShapingCore::Hands hands{};
  for (const MovingHand& hand : hands_) {
    const std::size_t slot = flow::Placement::index_of(hand.skeleton.side());
    hands[slot] = &poses_[slot];
  }
  return hands;
}

void Player::ask(const Event& event) {
  const flow::Command& command = event.command;
  if (const auto* change = std::get_if<flow::ChangeSettings>(&command))
    settings_due_ = change->settings; // of several in a frame the last counts, as in the loop
  if (const auto* change = std::get_if<flow::ChangePuppet>(&command)) masks_due_ = change->number;
  if (const auto change = flow::model_asked_by(command)) model_due_ = change;
  if (const auto* change = std::get_if<flow::ChangeModel>(&command)) model_due_ = *change;
  core_.apply(command, hands());
}

/// Does the changes of this frame, as the loop does at the end of a tick.
void Player::make_changes() {
  if (const auto change = std::exchange(model_due_, {})) make_model(*change);
  const auto masks = std::exchange(masks_due_, {});
  const auto settings = std::exchange(settings_due_, {});
  if (masks && !changes_.change_puppet(*masks)) was_refused_ = true;
  if (settings && !changes_.change_settings(*settings)) was_refused_ = true;
  finish_change();
  if (!frame_.awaited) return; // by an undo or a redo
  static_cast<void>(changes_.change_to(flow::Awaited(*frame_.awaited)));
  finish_change();
}

void Player::make_model(const flow::ChangeModel& change) {
  static_cast<void>(changes_.hold_still());
  finish_change();
  std::span<const deform::WirePlace> wire;
  if (change.source == flow::ModelSource::cut) wire = timeline_.wires[change.number];
  auto finer = flow::PendingModel::make(changes_.newest_model(), change, wire);
  if (!finer)
    changes_.keep_model();
  else if (!changes_.change_model(*finer))
    was_refused_ = true;
  was_refused_ = was_refused_ || !finer;
  finish_change();
}

/// Takes the change that was asked for, if there is one.
void Player::finish_change() {
  flow::PreparedChange* change = nullptr;
  if (!changes_.offers().take(change)) return;
  core_.finish(*change, hands(), frame_, stats_);
  changes_.offers().done();
  changes_.is_changing(); // undoes what the change replaced
}

bool Player::ask_what_is_due(double time_s) {
  const std::size_t first = next_event_;
  const double until_s = time_s + a_hair / timeline_.rate_hz;
  while (next_event_ < timeline_.events.size() &&
         (timeline_.events[next_event_].time_s <= until_s || made_ + 1 == frames_))
    ask(timeline_.events[next_event_++]);
  return next_event_ > first;
}

bool Player::has_frame_by(double time_s) const noexcept {
  return made_ < frames_ && time_of(made_) <= time_s + a_hair / timeline_.rate_hz;
}

bool Player::next() {
  if (made_ == frames_) return false;
  const double time_s = time_of(made_);
  // A puppet's commands find the hands as they were, as in the loop.
  const bool asked = ask_what_is_due(time_s);
  pose_hands(time_s);
  std::optional<HostTime> time;
  if (made_ > 0) time = HostTime{} + from_seconds(time_s); // a loop has no tick before
  core_.place(hands(), time, true, frame_);
  changes_.refill_undo();
  frame_.settings = core_.shaping().settings();
  // The hands have just grabbed here: without a wish there is nothing to do.
  if (made_ > 0 || asked)
    core_.shape(from_seconds(time_s), settings_due_ || masks_due_ || model_due_, frame_, stats_);
  make_changes();
  describe(made_++);
  return true;
}

void Player::describe(std::uint64_t number) {
  const auto time_at = [this](std::uint64_t frame) {
    return HostTime{} + from_seconds(time_of(frame));
  };
  ++stats_.ticks;
  if (!is_solved(frame_.status) || std::exchange(was_refused_, false)) ++stats_.failed;
  frame_.tick = number;
  frame_.ticks_run = stats_.ticks;
  frame_.scheduled = frame_.woke = time_at(number);
  if (number > 0) frame_.since_last = frame_.woke - time_at(number - 1);
}

} // namespace nendo::timeline
