// The part of the loop that takes changes: on the loop's side in the tick, and on the side of the
// thread that asks for them.

#include <nendo/flow/loop_change.hpp>

#include <utility>

#include <nendo/base/relax.hpp>
#include <nendo/flow/deform_loop.hpp>

namespace nendo::flow {
namespace {

constexpr HostClock::duration one_step = std::chrono::seconds(1);

} // namespace

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
void DeformLoop::finish_change(HostTime scheduled, Frame& frame) noexcept {
  if (taken_->settings) {
    const bool is_step = !changed_at_ || scheduled - *changed_at_ >= one_step;
    settings_in_force_ = *taken_->settings;
    change_filters(settings_in_force_.filter);
    shaping_.exchange(taken_->ready, settings_in_force_, tips_, is_step, frame, stats_);
    changed_at_ = scheduled;
  }
  if (taken_->log) begin_anew(*taken_->log, frame);
}

/// The angles, and so the fingertips, may jump; the shape does not, since they take hold anew.
void DeformLoop::change_filters(const hand::FilterOptions& filter) noexcept {
  Eigen::Index column = 0;
  for (Hand& hand : hands_) {
    if (hand.filter.options() != filter) {
      hand.filter = hand::JointFilter(filter);
      const auto& calibration = hand.calibration.of(hand.latest.side);
      hand.angles = hand.filter.pass(hand::joint_angles(hand.latest, calibration), hand.time());
    }
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
  Eigen::Index column = 0;
  for (std::size_t at = 0; at < hands_.size(); ++at) {
    Hand& hand = hands_[at];
    hand.begin_anew();
    state.latest[at] = hand.input.first;
    state.learned[at] = hand.input.wearer.learned;
    state.placement.T_stage_wrist[hand.slot] = hand.T_stage_wrist;
    tips_.middleCols<5>(column) = units_per_metre_ * hand.pose().fingertip_positions();
    column += 5;
  }
  switch_on_ = false;
  changed_at_.reset();
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
  if (settings == settings_) return true;
  LoopChange& change = next_change();
  if (!change.settings) {
    change.settings_before = settings_;
    change.sculptor_before = sculptor_options_;
  }
  // Settings that the loop has not taken are as if nobody had asked for them.
  settings_ = settings;
  if (settings == change.settings_before) {
    sculptor_options_ = change.sculptor_before;
    change.settings.reset();
    change.ready = {};
  } else {
    sculptor_options_ = settings == first_settings_
                            ? first_sculptor_
                            : with_settings(change.sculptor_before, settings,
                                            static_cast<int>(hands_.size()), units_per_metre_);
    change.ready = shaping_.prepare(sculptor_options_);
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
      states_.back().settings = settings_; // nobody has asked for others since
      states_.back().sculptor = sculptor_options_;
      // From here on, as a replay that begins here.
      first_settings_ = settings_;
      first_sculptor_ = sculptor_options_;
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
