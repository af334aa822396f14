// The part of the loop that takes changes in its tick.

#include <nendo/flow/deform_loop.hpp>

#include <algorithm>
#include <utility>

#include <nendo/flow/prepared_change.hpp>
#include <nendo/flow/rig_setup.hpp>
#include <nendo/flow/tips_of_hand.hpp>

namespace nendo::flow {

using deform::Points;

void DeformLoop::take_change() noexcept {
  if (!changes_.take(taken_)) return;
  InputLog* const log = options_.input_log;
  if (log != nullptr) {
    if (taken_->holds_still) log->command(HoldStill{});
    if (taken_->model) log->command(*taken_->model);
    // Whoever does the same in this order is refused neither: puppets are not for whole hands.
    const bool is_by_hands = taken_->settings && flow::is_by_hands(taken_->settings->mode);
    if (taken_->settings && !is_by_hands) log->command(ChangeSettings{*taken_->settings});
    if (taken_->rig) log->command(ChangePuppet{taken_->rig->number});
    if (is_by_hands) log->command(ChangeSettings{*taken_->settings});
  }
  if (!taken_->log || !shaping_.is_held()) return;
  // What was recorded leads to a shape that is committed, so that a replay ends with the same one.
  if (log != nullptr) log->command(Request::commit);
  shaping_.ask(Request::commit);
}

/// After the tick has made its shape.
void DeformLoop::finish_change(Frame& frame) noexcept {
  if (taken_->holds_still) {
    shaping_.hold_still(tips_, frame, stats_);
    if (rig_) std::copy(rig_->values().begin(), rig_->values().end(), still_at_.begin());
  }
  if (taken_->settings) change_filters(*taken_->settings);
  if (taken_->exchanges()) {
    const bool holds_on = shaping_.holds_on(taken_->ready);
    if (taken_->rig) take_rig(*taken_->rig, taken_->ready);
    if (shaping_.is_still())
      held_at_ = still_at_; // of the same size
    else if (!holds_on)
      note_hold();
    Points& other_tips = taken_->ready.tips; // where other points of the hands hold the model
    if (!rig_ && other_tips.cols() != tips_.cols()) place_tips(other_tips);
    taken_->is_refused = !shaping_.exchange(taken_->ready, tips_, frame, stats_);
    if (shaping_.sculptor().control_points() != tips_.cols()) std::swap(tips_, other_tips);
  }
  if (taken_->log) begin_anew(*taken_->log, frame);
}

/// The hands have taken hold where they are.
void DeformLoop::note_hold() noexcept {
  if (rig_) std::copy(rig_->values().begin(), rig_->values().end(), held_at_.begin());
}

/// `rig` then has what was before. If the shape is still held at the values at which the hands took
/// hold of it, these are the starts.
void DeformLoop::take_rig(ReadyRig& rig, ReadySculptor& ready) noexcept {
  if (rig.player) {
    const auto hands = hands_now();
    rig_ ? rig.player->go_on_from(*rig_, rig.from, hands) : rig.player->take_hold(hands);
    for (std::size_t at = 0; at < rig.held_at.size(); ++at)
      if (rig.from[at] < held_at_.size()) rig.held_at[at] = held_at_[rig.from[at]];
    rig.player->rig().place(rig.held_at, ready.starts);
    rig.player->write(rig.tips);
  }
  std::swap(rig_, rig.player);
  std::swap(gestures_, rig.gestures);
  std::swap(mirror_, rig.mirror);
  std::swap(held_at_, rig.held_at);
  std::swap(still_at_, rig.still_at);
  std::swap(tips_, rig.tips);
  if (!rig_) place_tips(tips_);
}

/// The angles, and so the fingertips, may jump; the shape does not, since they take hold anew.
void DeformLoop::change_filters(const LoopSettings& settings) noexcept {
  for (Hand& hand : hands_) {
    const bool closes = closes_pinches(settings.filter, settings.mode);
    if (hand.filter.options() == settings.filter && hand.closes_pinches == closes) continue;
    if (hand.filter.options() != settings.filter) hand.filter = hand::JointFilter(settings.filter);
    hand.closes_pinches = closes;
    hand.pose_by(hand.calibration.of(hand.latest.side));
  }
  place_tips(tips_);
}

void DeformLoop::place_tips(Points& tips) noexcept {
  if (rig_) return rig_->take_hold(hands_now()); // the points stay where they are
  Eigen::Index column = 0;
  const Eigen::Index points = points_of_hand(tips);
  for (const Hand& hand : hands_) {
    if (!hand.is_lowest) continue;
    const hand::HandPose pose = pose_of(hand);
    write_tips(pose, units_per_metre_, points, column, tips);
    column += points;
    place_body(hand, pose);
  }
  if (mirror_) mirror_half(*mirror_, tips);
}

void DeformLoop::Hand::begin_anew() noexcept {
  input.first = latest;
  if (input.wearer.adapt) input.wearer.learned = calibration.learned();
  if (const auto* stuck = calibration.stuck()) input.wearer.stuck = stuck->stuck();
  calibration = hand::ActiveCalibration(input.wearer);
  gate = {};
  filter = hand::JointFilter(filter.options());
  wrist_switch = {};
  follow(input.first);
}

void DeformLoop::begin_anew(LogChange& change, Frame& frame) noexcept {
  LoopState& state = change.state;
  for (std::size_t at = 0; at < hands_.size(); ++at) {
    Hand& hand = hands_[at];
    hand.begin_anew();
    state.inputs[at] = {hand.input.first, hand.input.wearer.learned, hand.input.layer,
                        hand.input.wearer.stuck};
    state.placement.T_stage_wrist[hand.slot] = hand.T_stage_wrist;
  }
  if (rig_) gestures_->reset(*rig_);
  place_tips(tips_);
  switch_on_ = false;
  wire_.clear();
  holds_after_wire_ = false;
  last_due_ = {};                      // as in a loop that begins
  if (rig_) state.rig = rig_->state(); // which has room for it
  shaping_.begin_anew(tips_, change.log != nullptr, frame, stats_);
  note_hold();
  state.held = shaping_.is_held();
  const deform::BlockShape& rest = shaping_.sculptor().rest();
  if (state.shape.block_count() != rest.block_count())
    std::swap(state.shape, change.of_other_model);
  state.shape.follow(rest);
}

void DeformLoop::give_back_change() noexcept {
  if (taken_->log) options_.input_log = taken_->log->log;
  taken_ = nullptr;
  changes_.done();
}

} // namespace nendo::flow
