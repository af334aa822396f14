#include "timeline/player.hpp"

#include <cmath>
#include <utility>

#include <nendo/deform/undo_memory.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/finger_supports.hpp>
#include <nendo/flow/rig_setup.hpp>
#include <nendo/flow/tips_of_hand.hpp>

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
  options.changes_at_once = true;
  return options;
}

/// The bodies of all hands, left hand first.
std::shared_ptr<flow::HandBodies> bodies_of(const Timeline& timeline, const deform::Mesh& model) {
  std::vector<hand::HandSkeleton> hands;
  for (const Side side : {Side::left, Side::right})
    for (const auto& track : timeline.hands)
      if (track.side == side) hands.push_back(track.skeleton());
  const double units = timeline.units_per_metre;
  return std::make_shared<flow::HandBodies>(hands, units, flow::table_under(model, units));
}

flow::SculptorSetup first_setup(const Timeline& timeline,
                                std::shared_ptr<const flow::HandBodies> bodies) {
  flow::SculptorSetup setup{timeline.sculptor,
                            flow::settings_of(timeline.sculptor, {}, timeline.units_per_metre)};
  if (timeline.rig)
    setup.options.hold = flow::Hold::fingertips; // its points hold
  else
    setup.options.bodies = std::move(bodies); // if masks are in the way, only for later
  return setup;
}

flow::UndoRoom undo_room() {
  return {0, deform::half_of_memory()};
}

std::shared_ptr<flow::ModelVersion> first_version(const deform::Mesh& model) {
  return std::make_shared<flow::ModelVersion>(0, model, deform::BlockLayout(model.vertices),
                                              undo_room(), nullptr);
}

/// Each subdivision makes at most four corners of one, and a copy two.
bool are_too_many(const std::vector<Event>& events, const deform::Mesh& model) {
  std::size_t corners = model.face_corners.size();
  for (const Event& event : events) {
    const bool divides = std::holds_alternative<flow::Subdivide>(event.command);
    if (divides && corners > flow::FinerModel::most_corners) return true;
    const auto* const edit = std::get_if<flow::EditPart>(&event.command);
    if (divides || (edit != nullptr && !edit->removes)) corners *= divides ? 4 : 2;
    if (corners > 4 * flow::FinerModel::most_corners) return true;
  }
  return false;
}

/// Makes the puppet's field along the surface, if it needs one and there is none, and its masks.
Result<void> complete(Timeline& timeline, const deform::Mesh& model) {
  const puppet::Rig* const rig = timeline.rig ? timeline.rig.get() : timeline.masks_numbered(0);
  if (rig != nullptr)
    flow::set_masks(rig, model, deform::BlockLayout(model.vertices), timeline.sculptor);
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

Eigen::Index points_at_first(const Timeline& timeline) {
  const puppet::Rig* const rig = timeline.rig ? timeline.rig.get() : timeline.masks_numbered(0);
  flow::SculptorOptions sculptor = timeline.sculptor;
  sculptor.mirror = flow::mirror_of(rig);
  return flow::control_points_of(rig, sculptor, static_cast<Eigen::Index>(timeline.hands.size()));
}

} // namespace

Result<std::unique_ptr<Player>> Player::make(Timeline timeline, const deform::Mesh& model) {
  if (std::string wrong = complaint_about(timeline); !wrong.empty())
    return Error{Errc::bad_input, std::move(wrong)};
  if (are_too_many(timeline.events, model))
    return Error{Errc::bad_input, "the model would be too large when it is subdivided so often, or "
                                  "its parts are copied; take out such an event"};
  if (auto fits = complete(timeline, model); !fits) return fits.error();
  std::unique_ptr<Player> player(new Player(std::move(timeline), model));
  player->pose_hands(0.0);
  if (player->puppet_) player->puppet_->take_hold();
  player->play_puppet();
  const deform::FieldStatus status = player->shaping_.begin(player->tips_);
  if (!is_solved(status))
    return Error{Errc::bad_input, "the hands cannot take hold of the model: " +
                                      std::string(deform::describe(status))};
  return player;
}

Player::Player(Timeline timeline, const deform::Mesh& model)
    : timeline_(std::move(timeline)), tips_(deform::Points::Zero(3, points_at_first(timeline_))),
      bodies_(bodies_of(timeline_, model)), first_(first_setup(timeline_, bodies_)), now_(first_),
      versions_{first_version(model)},
      shaping_(*versions_.front(), tips_.cols(), shaping_options(timeline_, first_)),
      frames_(static_cast<std::uint64_t>(timeline_.duration_s * timeline_.rate_hz + a_hair) + 1) {
  for (const auto& track : timeline_.hands)
    hands_.push_back({track.side, track.skeleton(), HandCurve(track.keys),
                      flow::Placement::index_of(track.side)});
  if (timeline_.rig) puppet_.emplace(timeline_);
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
  for (const Hand& hand : hands_) {
    const Key key = hand.curve.at(time_s);
    flow::HandFrame& shown = frame_.hands[hand.slot];
    shown.angles = key.angles;
    shown.T_stage_wrist = key.wrist_pose();
    shown.pose = hand.skeleton.pose(key.angles, shown.T_stage_wrist);
    shown.present = true;
    shown.samples = made_ + 1;
    if (puppet_)
      puppet_->pose(hand.side, {shown.angles, shown.pose, shown.T_stage_wrist});
    else
      bodies_->follow(bodies_->count() == 2 ? hand.slot : 0, shown.pose);
  }
  if (puppet_) return;
  const puppet::Rig* const masks = timeline_.masks_numbered(shaping_.puppet());
  place_tips(tips_, masks);
  frame_.symmetric = flow::mirror_of(masks).has_value();
}

/// Where the hands are in this frame, with those masks.
void Player::place_tips(deform::Points& tips, const puppet::Rig* masks) const noexcept {
  const auto mirror = flow::mirror_of(masks);
  const Eigen::Index points =
      tips.cols() / ((mirror ? 2 : 1) * static_cast<Eigen::Index>(hands_.size()));
  Eigen::Index column = 0;
  for (const Hand& hand : hands_) {
    flow::write_tips(frame_.hands[hand.slot].pose, timeline_.units_per_metre, points, column, tips);
    column += points;
  }
  if (mirror) flow::mirror_half(*mirror, tips);
}

void Player::play_puppet() {
  if (!puppet_) return;
  std::optional<HostTime> time;
  if (made_ > 0) time = HostTime{} + from_seconds(time_of(made_)); // a loop has no tick before
  puppet_->play(shaping_.is_held(), time);
  const puppet::RigPlayer& player = puppet_->player();
  player.write(tips_);
  for (const Side side : {Side::left, Side::right})
    frame_.let_go[flow::Placement::index_of(side)] = player.has_let_go(side);
  frame_.symmetric = player.state().symmetric;
  frame_.function_count = static_cast<std::uint32_t>(player.values().size());
  for (std::size_t at = 0; at < player.values().size(); ++at)
    frame_.functions[at] = static_cast<float>(player.values()[at]);
}

void Player::ask(const Event& event) {
  const flow::Command& command = event.command;
  if (const auto* change = std::get_if<flow::ChangeSettings>(&command))
    settings_due_ = change->settings; // of several in a frame the last counts, as in the loop
  if (const auto* change = std::get_if<flow::ChangePuppet>(&command)) masks_due_ = change->number;
  if (const auto change = flow::model_asked_by(command)) model_due_ = change;
  if (const auto* change = std::get_if<flow::ChangeModel>(&command)) model_due_ = *change;
  const auto* request = std::get_if<flow::Request>(&command);
  // A puppet's hands take hold of its functions.
  if (request != nullptr && !(puppet_ && *request == flow::Request::take_hold))
    shaping_.ask(*request);
  if (puppet_) puppet_->apply(command);
}

std::shared_ptr<const flow::ModelVersion> Player::model(std::uint32_t number) const noexcept {
  return number < versions_.size() ? versions_[number] : nullptr;
}

/// Of a puppet. Returns false, and changes nothing, if its points are too near to each other.
bool Player::set_surface(flow::SculptorOptions& sculptor, const flow::ModelVersion& model) const {
  if (!timeline_.rig) return true;
  auto surface = flow::surface_for(*timeline_.rig, model.mesh, model.layout(), sculptor.deformer);
  if (!surface) return false;
  sculptor.surface = *std::move(surface);
  return true;
}

/// What first_ would be with those masks.
flow::SculptorSetup Player::first_with(std::uint32_t masks) const {
  if (masks == 0) return first_;
  const auto hands = static_cast<Eigen::Index>(hands_.size());
  return flow::with_control_points(first_,
                                   flow::of_one_side(first_.options.deformer.supports, 5 * hands),
                                   timeline_.masks_numbered(masks), hands);
}

/// As the loop does at the end of a tick. Returns false, and goes on as it was, if nothing can be
/// done with the settings.
bool Player::change_to(const flow::Awaited& awaited, bool is_new_model) {
  const puppet::Rig* const rig =
      puppet_ ? timeline_.rig.get() : timeline_.masks_numbered(awaited.puppet);
  if (flow::is_by_hands(awaited.settings.mode) && !flow::can_press(rig)) return false;
  flow::ModelVersion& model = *versions_[awaited.model];
  const flow::LoopSettings& before = shaping_.settings();
  const int hands = puppet_ ? 0 : static_cast<int>(hands_.size());
  const bool other_masks = awaited.puppet != shaping_.puppet();
  const flow::SculptorSetup first = first_with(awaited.puppet);
  flow::SculptorSetup wanted = flow::with_settings(
      other_masks ? first : now_, first, awaited.settings, hands, timeline_.units_per_metre);
  wanted.options.surface = now_.options.surface; // the first one may be another version's
  wanted.options.deformer.mask = now_.options.deformer.mask;
  const bool same = &model == &shaping_.model() && awaited.settings.kernel == before.kernel &&
                    awaited.settings.radius_m == before.radius_m;
  if (!same && !set_surface(wanted.options, model)) return false;
  if (other_masks || &model != &shaping_.model())
    flow::set_masks(rig, model.mesh, model.layout(), wanted.options);
  now_ = std::move(wanted);
  if (puppet_ && awaited.settings != before) puppet_->take_hold();
  flow::ReadySculptor ready;
  const Eigen::Index points =
      puppet_ ? tips_.cols() : flow::control_points_of(rig, now_.options, hands);
  flow::Shaping::prepare(now_, model, points, ready);
  ready.puppet = awaited.puppet;
  ready.puppet_step =
      flow::kind_of_edit(timeline_.masks_numbered(shaping_.puppet()), puppet_ ? nullptr : rig);
  ready.is_new_model = is_new_model;
  if (&model != &shaping_.model()) ready.shape_room[0] = {model.number, model.shape.shape()};
  if (other_masks) {
    tips_.setZero(3, points);
    place_tips(tips_, rig);
    frame_.symmetric = flow::mirror_of(rig).has_value();
  } else if (ready.tips.cols() != tips_.cols()) {
    place_tips(ready.tips, rig);
  }
  shaping_.exchange(ready, tips_, frame_, stats_);
  if (shaping_.sculptor().control_points() != tips_.cols()) std::swap(tips_, ready.tips);
  return true;
}

void Player::make_model(const flow::ChangeModel& change) {
  shaping_.hold_still(tips_, frame_, stats_);
  const auto number = static_cast<std::uint32_t>(versions_.size());
  std::span<const deform::WirePlace> wire;
  if (change.source == flow::ModelSource::cut) wire = timeline_.wires[change.number];
  auto finer = flow::FinerModel::make(shaping_.model(), change, wire);
  auto made = finer ? finer->finish(number, undo_room())
                    : Result<std::unique_ptr<flow::ModelVersion>>(finer.error());
  if (made) {
    versions_.push_back(*std::move(made));
    if (change_to({shaping_.settings(), number, shaping_.puppet()}, true)) return;
    versions_.pop_back();
    was_refused_ = true;
  }
  was_refused_ = was_refused_ || !finer;
  change_to({shaping_.settings(), shaping_.model().number, shaping_.puppet()});
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
  // What a puppet is told finds the hands as they were, as in the loop.
  const bool asked = ask_what_is_due(time_s);
  pose_hands(time_s);
  play_puppet();
  if (auto* const memory = versions_[shaping_.model().number]->undo_memory.get()) memory->refill();
  shaping_.set_time(from_seconds(time_s));
  frame_.settings = shaping_.settings();
  // The hands have just taken hold here: without a wish there is nothing to do.
  if (made_ > 0 || asked)
    frame_.status =
        shaping_.shape(tips_, frame_, stats_, settings_due_ || masks_due_ || model_due_);
  if (const auto change = std::exchange(model_due_, {})) make_model(*change);
  if (settings_due_ || masks_due_) {
    const flow::Awaited wanted{std::exchange(settings_due_, {}).value_or(shaping_.settings()),
                               shaping_.model().number,
                               std::exchange(masks_due_, {}).value_or(shaping_.puppet())};
    if (!change_to(wanted)) was_refused_ = true;
  }
  if (frame_.awaited) change_to(flow::Awaited(*frame_.awaited)); // by an undo or a redo
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
