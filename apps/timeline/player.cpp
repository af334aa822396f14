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
  flow::ShapingOptions options{sculptor, deform::half_of_memory()};
  options.sculptor.options.deformer.undo_bytes = 0;
  options.most_requests = timeline.events.size() + 1;
  options.held = timeline.held;
  return options;
}

} // namespace

Result<std::unique_ptr<Player>> Player::make(Timeline timeline, const deform::Mesh& model) {
  if (std::string wrong = complaint_about(timeline); !wrong.empty())
    return Error{Errc::bad_input, std::move(wrong)};
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
      now_(first_), shaping_(model.vertices, tips_.cols(), shaping_options(timeline_, first_)),
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
  else
    shaping_.ask(event.request);
}

/// As the loop does at the end of a tick.
void Player::change(const flow::LoopSettings& settings) {
  now_ = flow::with_settings(now_, first_, settings, static_cast<int>(hands_.size()),
                             timeline_.units_per_metre);
  flow::ReadySculptor ready = shaping_.prepare(now_);
  shaping_.exchange(ready, tips_, frame_, stats_);
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
  shaping_.refill_undo();
  shaping_.set_time(from_seconds(time_s));
  const bool asked = ask_what_is_due(time_s);
  frame_.settings = shaping_.settings();
  // The hands have just taken hold here: without a wish there is nothing to do.
  if (made_ > 0 || asked)
    frame_.status = shaping_.shape(tips_, frame_, stats_, settings_due_.has_value());
  if (settings_due_) change(*std::exchange(settings_due_, {}));
  if (frame_.awaited) change(*frame_.awaited); // by an undo or a redo
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
