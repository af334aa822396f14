// The part of the loop that takes changes: on the loop's side in the tick, and on the side of the
// thread that asks for them.

#include <nendo/flow/loop_change.hpp>

#include <utility>

#include <nendo/base/relax.hpp>
#include <nendo/flow/deform_loop.hpp>

namespace nendo::flow {

// The loop's side.

void DeformLoop::take_change() noexcept {
  if (!changes_.take(taken_)) return;
  InputLog* const log = options_.input_log;
  if (log != nullptr && taken_->settings) log->command(ChangeSettings{*taken_->settings});
  if (!taken_->log || !shaping_.is_held()) return;
  // What was recorded leads to a shape that is committed, so that a replay ends with the same one.
  if (log != nullptr) log->command(Request::commit);
  shaping_.ask(Request::commit);
}

/// After the tick has made its shape.
void DeformLoop::finish_change(Frame& frame) noexcept {
  if (taken_->settings) {
    change_filters(taken_->settings->filter);
    shaping_.exchange(taken_->ready, tips_, frame, stats_);
  }
  if (taken_->log) begin_anew(*taken_->log, frame);
}

/// The angles, and so the fingertips, may jump; the shape does not, since they take hold anew.
void DeformLoop::change_filters(const hand::FilterOptions& filter) noexcept {
  for (Hand& hand : hands_) {
    if (hand.filter.options() == filter) continue;
    hand.filter = hand::JointFilter(filter);
    const auto& calibration = hand.calibration.of(hand.latest.side);
    hand.angles = hand.filter.pass(hand::joint_angles(hand.latest, calibration), hand.time());
  }
  place_tips();
}

void DeformLoop::place_tips() noexcept {
  Eigen::Index column = 0;
  for (const Hand& hand : hands_) {
    tips_.middleCols<5>(column) = units_per_metre_ * hand.pose().fingertip_positions();
    column += 5;
  }
}

void DeformLoop::Hand::begin_anew() noexcept {
  input.first = latest;
  const hand::RangeAdaptation* const adaptation = calibration.adaptation();
  if (adaptation != nullptr) input.wearer.learned = adaptation->learned();
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
    state.latest[at] = hand.input.first;
    state.learned[at] = hand.input.wearer.learned;
    state.placement.T_stage_wrist[hand.slot] = hand.T_stage_wrist;
  }
  place_tips();
  switch_on_ = false;
  shaping_.begin_anew(tips_, change.log != nullptr, frame, stats_);
  state.held = shaping_.is_held();
  state.shape.follow(shaping_.sculptor().rest());
}

void DeformLoop::give_back_change() noexcept {
  if (taken_->log) options_.input_log = taken_->log->log;
  taken_ = nullptr;
  changes_.done();
}

// The side of the thread that asks.

bool DeformLoop::change_settings(const LoopSettings& settings) {
  if (!settings.are_usable()) return false;
  if (settings == asked_.settings) return true;
  LoopChange& change = next_change();
  if (!change.settings) change.before = asked_;
  // Settings that the loop has not taken are as if nobody had asked for them.
  if (settings == change.before.settings) {
    asked_ = change.before;
    change.settings.reset();
    change.ready = {};
  } else {
    asked_ = with_settings(change.before, first_, settings, static_cast<int>(hands_.size()),
                           units_per_metre_);
    change.ready = shaping_.prepare(asked_);
    change.settings = settings;
  }
  offer_change();
  return true;
}

void DeformLoop::change_log(InputLog* log, const deform::BlockShape& like) {
  LoopChange& change = next_change();
  LogChange begins;
  begins.log = log;
  begins.state.placement.units_per_metre = units_per_metre_;
  begins.state.shape = like;
  change.log = std::move(begins);
  offer_change();
}

/// Takes the change back that the loop has not taken yet, or makes another.
LoopChange& DeformLoop::next_change() {
  if (is_offered_ && changes_.withdraw()) is_offered_ = false;
  while (is_changing()) // the loop is in its tick
    relax();
  if (!change_) change_ = std::make_unique<LoopChange>();
  return *change_;
}

void DeformLoop::offer_change() {
  if (!change_->settings && !change_->log) return change_.reset();
  changes_.offer(change_.get());
  is_offered_ = true;
}

bool DeformLoop::is_changing() {
  if (is_offered_ && changes_.is_done()) {
    is_offered_ = false;
    if (change_->log) {
      states_.push_back(std::move(change_->log->state));
      states_.back().sculptor = asked_; // nobody has asked for others since
      first_ = asked_;                  // from here on, as a replay that begins here
    }
    change_.reset();
  }
  return is_offered_;
}

std::optional<LoopState> DeformLoop::take_state() {
  is_changing();
  if (states_.empty()) return std::nullopt;
  LoopState state = std::move(states_.front());
  states_.erase(states_.begin());
  return state;
}

} // namespace nendo::flow
