#include <nendo/flow/deform_loop.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

#include <sched.h>
#include <sys/prctl.h>

namespace nendo::flow {

using deform::Points;

namespace {

Frame first_frame(const deform::BlockShape& shape, const deform::FieldSequence& fields,
                  double units_per_metre) {
  Frame frame;
  frame.units_per_metre = units_per_metre;
  frame.shape = shape;
  frame.fields = fields;
  for (auto& hand : frame.hands)
    hand.pose.joints.fill(Eigen::Isometry3d::Identity());
  return frame;
}

hand::CalibrationInForce calibration_of(const HandInput& input) noexcept {
  if (input.adapt) return hand::CalibrationInForce(*input.adapt);
  return {input.first.side, input.calibration, input.swapped};
}

HostClock::duration duration_of(double seconds) noexcept {
  return std::chrono::duration_cast<HostClock::duration>(std::chrono::duration<double>(seconds));
}

} // namespace

DeformLoop::DeformLoop(const deform::Mesh& model, const Placement& placement,
                       std::vector<HandInput> hands, const LoopOptions& options)
    : options_(options), units_per_metre_(placement.units_per_metre),
      tips_(Points::Zero(3, 5 * static_cast<Eigen::Index>(hands.size()))),
      sculptor_(model.vertices, tips_.cols(), options.sculptor),
      held_(options.switch_action != SwitchAction::grab), hold_wanted_(held_),
      frames_(first_frame(sculptor_.rest(), sculptor_.fields(), placement.units_per_metre)) {
  assert(!hands.empty() && hands.size() <= 2);
  for (auto& input : hands) {
    const std::size_t slot = Placement::index_of(input.skeleton.side());
    const hand::CalibrationInForce calibration = calibration_of(input);
    const hand::JointFilter filter(input.filter);
    hands_.push_back(
        {std::move(input), slot, placement.T_stage_wrist[slot], calibration, {}, filter});
    hands_.back().follow(hands_.back().input.first);
  }
  compute_hands(frames_.back());
  grab_status_ = sculptor_.grab(tips_);
}

void DeformLoop::Hand::follow(const GloveSample& sample) noexcept {
  const hand::Calibration& in_force = calibration.follow(sample);
  latest = input.gated ? gate.pass(sample, in_force) : sample;
  const HostTime time = latest.has_device_time ? latest.measured : latest.arrival;
  angles = filter.pass(hand::joint_angles(latest, in_force), time);
}

const hand::HandSkeleton& DeformLoop::Hand::skeleton() const noexcept {
  const bool swapped = latest.side != input.first.side && input.swapped_skeleton;
  return swapped ? *input.swapped_skeleton : input.skeleton;
}

void DeformLoop::take_samples(TickRecord& record) noexcept {
  const HostTime now = record.woke;
  HostTime newest{};
  std::uint8_t number = 0;
  for (auto& hand : hands_) {
    const std::size_t count = hand.input.ring->drain([&](const GloveSample& sample) noexcept {
      if (options_.tape != nullptr) options_.tape->sample(number, sample);
      hand.follow(sample);
      if (!hand.wrist_switch.turned_on(sample.wrist_switch, sample.arrival)) return;
      ++stats_.switch_uses[hand.slot];
      if (options_.switch_action == SwitchAction::toggle) hold_wanted_ = !hold_wanted_;
      if (options_.switch_action == SwitchAction::commit) commit_due_ = true;
    });
    ++number;
    hand.fresh = count > 0;
    if (hand.fresh) {
      const HostTime arrival = hand.latest.arrival;
      newest = std::max(newest, arrival);
      record.input = record.samples == 0 ? arrival : std::min(record.input, arrival);
      record.samples += static_cast<std::uint32_t>(count);
    }
    stats_.samples[hand.slot] += count;
    stats_.spikes[hand.slot] = hand.gate.spikes();
    if (const auto* learned = hand.calibration.adaptation())
      stats_.ranges[hand.slot] = learned->ranges();
    const bool silent = now - hand.latest.arrival > options_.silent_after;
    if (silent && !hand.silent) ++stats_.silences[hand.slot];
    hand.silent = silent;
  }
  if (options_.policy == OverrunPolicy::sample && record.samples > 0) record.scheduled = newest;
  follow_switches();
}

void DeformLoop::follow_switches() noexcept {
  if (options_.switch_action != SwitchAction::grab) return;
  const bool on = std::any_of(hands_.begin(), hands_.end(),
                              [](const Hand& hand) { return hand.wrist_switch.is_on(); });
  if (on != switch_on_) hold_wanted_ = on; // in between, requests are heard
  switch_on_ = on;
}

void DeformLoop::take_requests() noexcept {
  if (options_.requests == nullptr) return;
  options_.requests->drain([this](Request request) noexcept {
    if (options_.tape != nullptr) options_.tape->request(request);
    if (request == Request::grab) hold_wanted_ = true;
    if (request == Request::let_go) hold_wanted_ = false;
    if (request == Request::commit) commit_due_ = held_;
    if (request == Request::undo) ++undos_due_;
  });
}

void DeformLoop::take_wrists() noexcept {
  if (options_.wrists == nullptr) return;
  options_.wrists->drain([this](const WristMove& move) noexcept {
    if (!move.is_usable()) return;
    if (options_.tape != nullptr) options_.tape->wrist(move);
    for (Hand& hand : hands_)
      if (hand.slot == Placement::index_of(move.side)) hand.T_stage_wrist = move.T_stage_wrist();
  });
}

void DeformLoop::compute_hands(Frame& frame) noexcept {
  Eigen::Index column = 0;
  for (const auto& hand : hands_) {
    HandFrame& shown = frame.hands[hand.slot];
    shown.angles = hand.angles;
    shown.pose = hand.skeleton().pose(hand.angles, hand.T_stage_wrist);
    shown.T_stage_wrist = hand.T_stage_wrist;
    shown.present = true;
    shown.silent = hand.silent;
    shown.samples = stats_.samples[hand.slot];
    tips_.middleCols<5>(column) = units_per_metre_ * shown.pose.fingertip_positions();
    column += 5;
  }
}

deform::FieldStatus DeformLoop::shape(Frame& frame) noexcept {
  for (; undos_due_ > 0; --undos_due_) {
    if (is_solved(sculptor_.undo(tips_))) {
      ++stats_.undos;
    } else {
      held_ = false; // taken hold of again as soon as that can be
    }
  }
  if (!held_ && hold_wanted_) {
    held_ = is_solved(sculptor_.grab(tips_));
    if (held_) ++stats_.grabs;
  }
  if (!held_) {
    frame.shape.follow(sculptor_.rest());
    frame.fields.clear();
    frame.chain = {};
    return deform::FieldStatus::ok;
  }
  const bool commits = commit_due_ || !hold_wanted_; // letting go keeps what has been shaped
  const deform::FieldStatus status =
      commits ? sculptor_.finish(tips_, frame.shape) : sculptor_.update(tips_, frame.shape);
  frame.fields.follow(sculptor_.fields());
  record_chain(frame.chain);
  // What cannot be committed now stays held, and is tried again at the next tick.
  if (commits && is_solved(status) && is_solved(sculptor_.commit(tips_))) {
    ++stats_.commits;
    commit_due_ = false;
    held_ = hold_wanted_;
  }
  return status;
}

void DeformLoop::record_chain(deform::ChainReport& chain) noexcept {
  chain = sculptor_.report();
  stats_.most_links = std::max(stats_.most_links, chain.links);
  stats_.most_bound = std::max(stats_.most_bound, chain.whole_bound);
  stats_.least_determinant = std::min(stats_.least_determinant, chain.least_determinant);
  if (chain.held_pairs > 0) ++stats_.held_apart_ticks;
}

void DeformLoop::tick(const Pacer::Due& due) noexcept {
  const TickStages& runs = options_.stages;
  TickRecord record{.tick = due.number, .scheduled = due.scheduled, .woke = due.woke};
  record.missed = due.missed;
  record.spun_ns = saturated_ns(due.spun);
  const auto now_ns = [&]() noexcept { return saturated_ns(HostClock::now() - record.woke); };
  if (runs.input) {
    take_requests();
    take_wrists();
    take_samples(record);
  }
  record.drained_ns = now_ns();
  Frame& frame = frames_.back();
  if (runs.hands) compute_hands(frame);
  record.posed_ns = now_ns();
  if (runs.deform) frame.status = shape(frame);
  record.solved_ns = now_ns();
  describe(record, frame);
  if (runs.publish) {
    for (FrameSink* sink : options_.sinks)
      sink->show(frame);
    frames_.publish();
  }
  record.published_ns = now_ns();
  record_latencies(record);
  if (options_.tape != nullptr) options_.tape->tick(record.tick, record.scheduled, record.woke);
  if (options_.records != nullptr) options_.records->try_push(record);
}

void DeformLoop::describe(const TickRecord& record, Frame& frame) noexcept {
  ++stats_.ticks;
  if (!is_solved(frame.status)) ++stats_.failed;
  frame.tick = record.tick;
  frame.ticks = stats_.ticks;
  frame.missed = stats_.missed;
  frame.commits = stats_.commits;
  frame.undos = stats_.undos;
  frame.held = held_;
  frame.scheduled = record.scheduled;
  frame.woke = record.woke;
  frame.since_last =
      last_woke_ == HostTime{} ? HostClock::duration::zero() : record.woke - last_woke_;
  last_woke_ = record.woke;
}

void DeformLoop::record_latencies(const TickRecord& record) noexcept {
  const HostTime done = record.published();
  stats_.wake_latency.record(record.woke - record.scheduled);
  stats_.work.record(done - record.woke);
  for (const auto& hand : hands_) {
    if (!hand.fresh) continue;
    stats_.end_to_end.record(done - hand.latest.arrival);
    if (hand.filter.options().kind == hand::FilterKind::off) continue;
    const hand::FilterLatency latency = hand.filter.latency();
    stats_.filter_moving.record(duration_of(latency.moving_s));
    stats_.filter_worst.record(duration_of(latency.worst_s));
  }
}

void DeformLoop::run(const std::atomic<bool>& stop, std::uint64_t most_ticks) noexcept {
  // Without real-time priority the kernel may delay a wake-up by 50 microseconds unless it is told
  // not to.
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  PaceOptions pace = options_;
  pace.spin = pace.spin && ::sched_getscheduler(0) == SCHED_FIFO;
  Pacer pacer(pace, HostClock::now(), options_.bell);
  while (pacer.next() < most_ticks) {
    const Pacer::Due due = pacer.wait();
    if (stop.load(std::memory_order_relaxed)) return;
    tick(due);
    if (pacer.end_tick(HostClock::now())) ++stats_.overruns;
    stats_.missed += std::min(pacer.next(), most_ticks) - due.number - 1;
  }
}

Placement DeformLoop::placement() const {
  Placement placement;
  placement.units_per_metre = units_per_metre_;
  for (const Hand& hand : hands_)
    placement.T_stage_wrist[hand.slot] = hand.T_stage_wrist;
  return placement;
}

Points DeformLoop::final_shape() {
  deform::BlockShape shape = sculptor_.rest();
  if (held_) sculptor_.finish(tips_, shape);
  Points vertices;
  layout().unpack(shape, vertices);
  return vertices;
}

} // namespace nendo::flow
