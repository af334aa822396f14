#include "timeline/player.hpp"

#include <cmath>
#include <utility>

#include <nendo/deform/undo_memory.hpp>

namespace nendo::timeline {
namespace {

// Times in files are decimals, and a frame's is a quotient: what is so near belongs to it.
constexpr double a_hair = 1e-6; // of a frame

flow::ShapingOptions shaping_options(const Timeline& timeline,
                                     const flow::SculptorSetup& sculptor) {
  flow::ShapingOptions options{sculptor};
  options.most_requests = timeline.events.size() + 1;
  options.held = timeline.held;
  options.pull_is_step = timeline.pull_is_step;
  return options;
}

flow::UndoRoom undo_room() {
  return {0, deform::half_of_memory()};
}

std::shared_ptr<flow::ModelVersion> first_version(const deform::Mesh& model) {
  return std::make_shared<flow::ModelVersion>(0, model, deform::BlockLayout(model.vertices),
                                              undo_room(), nullptr);
}

/// Each subdivision makes at most four corners of one.
bool are_too_many(const std::vector<Event>& events, const deform::Mesh& model) {
  std::size_t corners = model.face_corners.size();
  for (const Event& event : events) {
    if (!event.subdivides) continue;
    if (corners > flow::FinerModel::most_corners) return true;
    corners *= 4;
  }
  return false;
}

} // namespace

Result<std::unique_ptr<Player>> Player::make(Timeline timeline, const deform::Mesh& model) {
  if (std::string wrong = complaint_about(timeline); !wrong.empty())
    return Error{Errc::bad_input, std::move(wrong)};
  if (are_too_many(timeline.events, model))
    return Error{Errc::bad_input, "the model would be too large when it is subdivided so often; "
                                  "take out a subdivide event"};
  std::unique_ptr<Player> player(new Player(std::move(timeline), model));
  player->pose_hands(0.0);
  const deform::FieldStatus status = player->shaping_.begin(player->tips_);
  if (!is_solved(status))
    return Error{Errc::bad_input, "the hands cannot take hold of the model: " +
                                      std::string(deform::describe(status))};
  return player;
}

Player::Player(Timeline timeline, const deform::Mesh& model)
    : timeline_(std::move(timeline)),
      tips_(deform::Points::Zero(3, 5 * static_cast<Eigen::Index>(timeline_.hands.size()))),
      first_{timeline_.sculptor,
             flow::settings_of(timeline_.sculptor, {}, timeline_.units_per_metre)},
      now_(first_), versions_{first_version(model)},
      shaping_(*versions_.front(), tips_.cols(), shaping_options(timeline_, first_)),
      frames_(static_cast<std::uint64_t>(timeline_.duration_s * timeline_.rate_hz + a_hair) + 1) {
  for (const auto& track : timeline_.hands)
    hands_.push_back(
        {track.skeleton(), HandCurve(track.keys), flow::Placement::index_of(track.side)});
  frame_.units_per_metre = timeline_.units_per_metre;
  frame_.held = timeline_.held;
  frame_.settings = shaping_.settings();
  frame_.shape = shaping_.sculptor().rest();
  frame_.fields = shaping_.sculptor().fields();
  for (auto& hand : frame_.hands)
    hand.pose.joints.fill(Eigen::Isometry3d::Identity());
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
  Eigen::Index column = 0;
  for (const Hand& hand : hands_) {
    const Key key = hand.curve.at(time_s);
    flow::HandFrame& shown = frame_.hands[hand.slot];
    shown.angles = key.angles;
    shown.T_stage_wrist = key.wrist_pose();
    shown.pose = hand.skeleton.pose(key.angles, shown.T_stage_wrist);
    shown.present = true;
    shown.samples = made_ + 1;
    tips_.middleCols<5>(column) = timeline_.units_per_metre * shown.pose.fingertip_positions();
    column += 5;
  }
}

void Player::ask(const Event& event) {
  if (event.settings)
    settings_due_ = event.settings; // of several in a frame the last counts, as in the loop
  else if (event.subdivides)
    subdivides_ = true;
  else
    shaping_.ask(event.request);
}

std::shared_ptr<const flow::ModelVersion> Player::model(std::uint32_t number) const noexcept {
  return number < versions_.size() ? versions_[number] : nullptr;
}

/// As the loop does at the end of a tick.
void Player::change_to(const flow::Awaited& awaited, bool is_new_model) {
  now_ = flow::with_settings(now_, first_, awaited.settings, static_cast<int>(hands_.size()),
                             timeline_.units_per_metre);
  flow::ModelVersion& model = *versions_[awaited.model];
  flow::ReadySculptor ready;
  flow::Shaping::prepare(now_, model, tips_.cols(), ready);
  ready.is_new_model = is_new_model;
  if (&model != &shaping_.model()) ready.shape_room[0] = {model.number, model.shape.shape()};
  shaping_.exchange(ready, tips_, frame_, stats_);
}

void Player::subdivide() {
  shaping_.hold_still(tips_, frame_, stats_);
  const auto number = static_cast<std::uint32_t>(versions_.size());
  flow::FinerModel finer(shaping_.model());
  versions_.push_back(finer.finish(number, undo_room()));
  change_to({shaping_.settings(), number}, true);
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
  pose_hands(time_s);
  if (auto* const memory = versions_[shaping_.model().number]->undo_memory.get()) memory->refill();
  shaping_.set_time(from_seconds(time_s));
  const bool asked = ask_what_is_due(time_s);
  frame_.settings = shaping_.settings();
  // The hands have just taken hold here: without a wish there is nothing to do.
  if (made_ > 0 || asked)
    frame_.status = shaping_.shape(tips_, frame_, stats_, settings_due_ || subdivides_);
  if (std::exchange(subdivides_, false)) subdivide();
  if (settings_due_) change_to({*std::exchange(settings_due_, {}), shaping_.model().number});
  if (frame_.awaited) change_to(flow::Awaited(*frame_.awaited)); // by an undo or a redo
  describe(made_++);
  return true;
}

void Player::describe(std::uint64_t number) {
  const auto time_at = [this](std::uint64_t frame) {
    return HostTime{} + from_seconds(time_of(frame));
  };
  ++stats_.ticks;
  if (!is_solved(frame_.status)) ++stats_.failed;
  frame_.tick = number;
  frame_.ticks_run = stats_.ticks;
  frame_.scheduled = frame_.woke = time_at(number);
  if (number > 0) frame_.since_last = frame_.woke - time_at(number - 1);
}

} // namespace nendo::timeline
