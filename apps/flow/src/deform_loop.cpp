#include <nendo/flow/deform_loop.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

#include <sched.h>
#include <sys/prctl.h>

#include <nendo/flow/finger_supports.hpp>
#include <nendo/flow/rig_setup.hpp>
#include <nendo/flow/tips_of_hand.hpp>
#include <nendo/hand/pinch_closing.hpp>

namespace nendo::flow {

using deform::Points;

namespace {

/// points: of a puppet, 0 without one.
Frame first_frame(const Shaping& shaping, Eigen::Index points, double units_per_metre) {
  Frame frame;
  frame.settings = shaping.settings();
  frame.units_per_metre = units_per_metre;
  frame.shape = shaping.sculptor().rest();
  frame.fields = shaping.sculptor().fields();
  frame.surface.vectors.setZero(3, 2 * points);
  for (auto& hand : frame.hands)
    hand.pose.joints.fill(Eigen::Isometry3d::Identity());
  return frame;
}

/// The bodies of all hands, left hand first.
std::shared_ptr<HandBodies> bodies_of(std::span<const HandInput> inputs, const Placement& placement,
                                      const deform::Mesh& model) {
  std::vector<hand::HandSkeleton> hands;
  for (const Side side : {Side::left, Side::right}) {
    const auto lowest = std::find_if(inputs.begin(), inputs.end(),
                                     [&](const HandInput& hand) { return hand.side == side; });
    if (lowest != inputs.end()) hands.push_back(lowest->skeleton(lowest->first.side));
  }
  const double units = placement.units_per_metre;
  return std::make_shared<HandBodies>(
      hands, units, placement.table ? *placement.table : table_under(model, units));
}

SculptorSetup first_setup(const LoopOptions& options, const HandInput& hand,
                          const ModelVersion& model, std::shared_ptr<const HandBodies> bodies,
                          double units_per_metre) {
  SculptorSetup setup{options.sculptor,
                      options.settings
                          ? *options.settings
                          : settings_of(options.sculptor, hand.filter, units_per_metre)};
  const puppet::Rig* const rig = options.rig.get();
  if (is_played(rig)) setup.options.hold = Hold::fingertips; // its points hold
  if (can_press(rig)) setup.options.bodies = std::move(bodies);
  set_masks(rig, model.mesh, model.layout(), setup.options);
  if (!is_played(rig) || setup.options.surface) return setup;
  if (auto surface =
          surface_for(*options.rig, model.mesh, model.layout(), options.sculptor.deformer))
    setup.options.surface = *std::move(surface);
  return setup;
}

/// Of all hands. Symmetry adds their images.
Eigen::Index points_at_first(const LoopOptions& options, std::size_t hands) {
  SculptorOptions sculptor = options.sculptor;
  sculptor.mirror = mirror_of(options.rig.get());
  return control_points_of(options.rig.get(), sculptor, static_cast<Eigen::Index>(hands));
}

std::vector<std::unique_ptr<ModelVersion>> first_version(const deform::Mesh& model,
                                                         const LoopOptions& options,
                                                         const deform::BlockShape* first) {
  const UndoRoom undo{options.sculptor.deformer.undo_bytes, options.undo_most_bytes};
  std::vector<std::unique_ptr<ModelVersion>> versions;
  versions.push_back(
      std::make_unique<ModelVersion>(0, model, deform::BlockLayout(model.vertices), undo, first));
  return versions;
}

ShapingOptions shaping_options(const LoopOptions& options, const SculptorSetup& sculptor) {
  ShapingOptions shaping{sculptor};
  if (options.commands != nullptr) shaping.most_requests = options.commands->capacity();
  shaping.held = options.begins_held();
  shaping.pull_is_step = options.pull_is_step;
  return shaping;
}

} // namespace

bool are_usable(std::span<const HandInput> inputs) noexcept {
  for (auto input = inputs.begin(); input != inputs.end(); ++input)
    if (!input->layer && std::any_of(inputs.begin(), input, [&](const HandInput& before) {
          return before.side == input->side;
        }))
      return false;
  return !inputs.empty() && inputs.size() <= most_inputs;
}

std::size_t count_hands(std::span<const HandInput> inputs) noexcept {
  const bool has_other = std::any_of(inputs.begin(), inputs.end(), [&](const HandInput& input) {
    return input.side != inputs.front().side;
  });
  return inputs.empty() ? 0 : 1 + static_cast<std::size_t>(has_other);
}

DeformLoop::DeformLoop(const deform::Mesh& model, const Placement& placement,
                       std::vector<HandInput> hands, const LoopOptions& options,
                       const deform::BlockShape* first)
    : options_(options), units_per_metre_(placement.units_per_metre),
      mirror_(mirror_of(options.rig.get())),
      tips_(Points::Zero(3, points_at_first(options, count_hands(hands)))),
      bodies_(bodies_of(hands, placement, model)), versions_(first_version(model, options, first)),
      first_(first_setup(options, hands.front(), *versions_.front(), bodies_,
                         placement.units_per_metre)),
      first_rig_(options.rig), puppets_{options.rig}, asked_model_(versions_.front().get()),
      shaping_(*asked_model_, tips_.cols(), shaping_options(options, first_)), asked_(first_),
      frames_(first_frame(shaping_, is_played(options.rig.get()) ? tips_.cols() : 0,
                          placement.units_per_metre)) {
  assert(are_usable(hands));
  for (auto& input : hands) {
    const std::size_t slot = Placement::index_of(input.side);
    const std::array skeletons{input.skeleton(Side::left), input.skeleton(Side::right)};
    const hand::ActiveCalibration calibration(input.wearer);
    const hand::JointFilter filter(input.filter);
    hands_.push_back({std::move(input),
                      slot,
                      placement.T_stage_wrist[slot],
                      skeletons,
                      calibration,
                      {},
                      filter});
    Hand& hand = hands_.back();
    hand.closes_pinches = closes_pinches(hand.input.filter, first_.settings.mode);
    hand.follow(hand.input.first);
    for (Hand& before : hands_) {
      if (&before == &hand || before.slot != slot) continue;
      hand.is_lowest = false;
      before.is_topmost = false;
    }
    auto& layer = hand.input.layer;
    if (layer && hand.is_lowest && !layer->below) layer->below = hand.angles;
  }
  if (is_played(options.rig.get())) {
    rig_.emplace(options.rig);
    gestures_.emplace(*options.rig);
    rig_->set_state(options.rig_state);
    rig_->take_hold(hands_now());
    held_at_.resize(rig_->values().size());
    still_at_ = held_at_;
  } else {
    tip_supports_ = of_one_side(first_.options.deformer.supports, 5 * hand_count());
  }
  compute_hands(frames_.back());
  grab_status_ = shaping_.begin(tips_);
  note_hold();
}

DeformLoop::~DeformLoop() = default;

void DeformLoop::Hand::follow(const GloveSample& sample) noexcept {
  const hand::Calibration& active = calibration.follow(sample);
  latest = input.gated ? gate.pass(sample, active) : sample;
  pose_by(active);
}

void DeformLoop::Hand::pose_by(const hand::Calibration& active) noexcept {
  angles = filter.pass(hand::joint_angles(latest, active, left_out()), latest.time());
  if (closes_pinches) angles = hand::close_pinches(angles, skeleton(), latest.present, left_out());
}

/// Takes a sample of that input.
void DeformLoop::take(std::uint8_t number, const GloveSample& sample) noexcept {
  Hand& hand = hands_[number];
  if (options_.input_log != nullptr) options_.input_log->sample(number, sample);
  hand.follow(sample);
  if (!hand.wrist_switch.turned_on(sample.wrist_switch, sample.arrival)) return;
  ++stats_.switch_uses[hand.slot];
  if (has_clutch(hand)) return rig_->toggle_clutch(hand.input.side, hands_now());
  if (options_.switch_action == SwitchAction::toggle) shaping_.toggle_hold();
  if (options_.switch_action == SwitchAction::commit) shaping_.commit_when_held();
}

void DeformLoop::take_script(HostTime scheduled) noexcept {
  if (options_.script == nullptr) return;
  const HostClock::duration since_first =
      stats_.ticks == 0 ? HostClock::duration::zero() : scheduled - first_due_;
  options_.script->play(since_first, [this](const InputLogEntry& entry) noexcept {
    if (const auto* taken = std::get_if<TakenSample>(&entry)) {
      if (taken->hand >= hands_.size()) return;
      take(taken->hand, taken->sample);
      const Hand& hand = hands_[taken->hand];
      if (hand.is_topmost) ++stats_.samples[hand.slot];
    } else if (const auto* command = std::get_if<Command>(&entry)) {
      apply(*command);
    }
  });
}

void DeformLoop::take_samples(TickRecord& record) noexcept {
  HostTime newest{};
  std::uint8_t number = 0;
  for (auto& hand : hands_) {
    const std::size_t count = hand.input.ring == nullptr
                                  ? 0
                                  : hand.input.ring->drain([&](const GloveSample& sample) noexcept {
                                      take(number, sample);
                                    });
    ++number;
    hand.fresh = count > 0;
    if (hand.fresh) {
      if (hand.input.wrist_path)
        apply(WristMove::to(hand.input.side,
                            hand.input.wrist_path->at(to_seconds(hand.latest.device_time))));
      const HostTime arrival = hand.latest.arrival;
      newest = std::max(newest, arrival);
      record.input = record.samples == 0 ? arrival : std::min(record.input, arrival);
      record.samples += static_cast<std::uint32_t>(count);
    }
    this->count(hand, count, record.woke);
  }
  if (options_.policy == OverrunPolicy::sample && record.samples > 0) record.scheduled = newest;
  follow_switches();
}

/// By the times at which ticks are due, so that a replay does the same.
void DeformLoop::let_layers_pass(HostTime scheduled) noexcept {
  const HostClock::duration time =
      last_due_ == HostTime{} ? HostClock::duration::zero() : scheduled - last_due_;
  last_due_ = scheduled;
  for (Hand& hand : hands_)
    if (hand.input.layer) hand.input.layer->pass(time);
}

/// Returns the angles of a hand, with all layers over it.
hand::JointAngles DeformLoop::angles_of(const Hand& lowest) const noexcept {
  hand::JointAngles angles = lowest.input.layer ? *lowest.input.layer->below : lowest.angles;
  for (const Hand& hand : hands_)
    if (hand.slot == lowest.slot && hand.input.layer)
      hand.input.layer->play_over(hand.angles, angles);
  return angles;
}

hand::HandPose DeformLoop::pose_of(const Hand& lowest) const noexcept {
  return lowest.skeleton().pose(angles_of(lowest), lowest.T_stage_wrist);
}

/// A hand is, if all that play it are.
bool DeformLoop::is_silent(std::size_t slot) const noexcept {
  return std::all_of(hands_.begin(), hands_.end(),
                     [&](const Hand& hand) { return hand.slot != slot || hand.silent; });
}

void DeformLoop::follow_switches() noexcept {
  if (options_.switch_action != SwitchAction::grab) return;
  const bool on = std::any_of(hands_.begin(), hands_.end(), [this](const Hand& hand) {
    return hand.wrist_switch.is_on() && !has_clutch(hand);
  });
  if (on != switch_on_) // in between, requests are heard
    shaping_.ask(on ? Request::grab : Request::let_go);
  switch_on_ = on;
}

/// Tells whether the hand's wrist switch is the clutch of a puppet, and so nothing else.
bool DeformLoop::has_clutch(const Hand& hand) const noexcept {
  return rig_ && rig_->rig().puppet().clutch.means[hand.slot] == puppet::ClutchMeans::wrist_switch;
}

void DeformLoop::take_commands(HostTime scheduled) noexcept {
  if (const auto& wire = options_.wire_time) {
    const double now_s = stats_.ticks == 0 ? 0.0 : seconds_between(first_due_, scheduled);
    const bool draws = now_s >= wire->from_s && now_s < wire->to_s;
    if (std::exchange(draws_in_time_, draws) != draws) apply(DrawWire{draws, wire->blade});
  }
  if (options_.commands == nullptr) return;
  options_.commands->drain([this](const Command& command) noexcept { apply(command); });
}

void DeformLoop::apply(const Command& command) noexcept {
  const auto* const request = std::get_if<Request>(&command);
  const auto* const move = std::get_if<WristMove>(&command);
  if (!is_for_loop(command) || (move != nullptr && !move->is_usable())) return;
  if (is_for_puppet(command) && !rig_) return;
  if (options_.input_log != nullptr) options_.input_log->command(command);
  if (rig_ && command == Command(Request::take_hold)) return rig_->take_hold(hands_now());
  if (request != nullptr) return shaping_.ask(*request);
  if (is_for_puppet(command)) return set_rig(command);
  if (const auto* wire = std::get_if<DrawWire>(&command)) return draw_blade(*wire);
  if (const auto* layer = std::get_if<SetLayer>(&command))
    if (layer->input < hands_.size() && hands_[layer->input].input.layer)
      hands_[layer->input].input.layer->on = layer->on;
  if (move == nullptr) return; // a mark is only logged
  for (Hand& hand : hands_)
    if (hand.slot == Placement::index_of(move->side)) hand.T_stage_wrist = move->pose();
}

void DeformLoop::compute_hands(Frame& frame) noexcept {
  Eigen::Index column = 0;
  const Eigen::Index points = points_of_hand(tips_);
  frame.layers_on = 0;
  for (std::size_t at = 0; at < hands_.size(); ++at) {
    const Hand& hand = hands_[at];
    if (hand.input.layer && hand.input.layer->on) frame.layers_on |= 1U << at;
    if (!hand.is_lowest) continue;
    HandFrame& shown = frame.hands[hand.slot];
    shown.angles = angles_of(hand);
    shown.pose = hand.skeleton().pose(shown.angles, hand.T_stage_wrist);
    shown.swapped = hand.latest.side != hand.input.first.side;
    shown.T_stage_wrist = hand.T_stage_wrist;
    shown.present = true;
    shown.silent = is_silent(hand.slot);
    shown.samples = stats_.samples[hand.slot];
    shown.left_out = hand.left_out();
    if (rig_) {
      hand_states_[hand.slot] = {shown.angles, shown.pose, hand.T_stage_wrist};
      continue;
    }
    write_tips(shown.pose, units_per_metre_, points, column, tips_);
    column += points;
    if (is_by_hands(shaping_.sculptor().mode()) || taken_ != nullptr || stats_.ticks == 0)
      place_body(hand, shown.pose);
  }
  follow_blade(frame);
  if (!(frame.wire == wire_)) frame.wire = wire_;
  if (rig_) play_rig();
  if (mirror_) mirror_half(*mirror_, tips_);
  tell_rig(frame);
}

/// Hands that hold still press where they stopped, until they go on.
void DeformLoop::place_body(const Hand& hand, const hand::HandPose& pose) noexcept {
  if (!shaping_.is_still()) bodies_->follow(bodies_->count() == 2 ? hand.slot : 0, pose);
}

void DeformLoop::tick(const Pacer::Due& due) noexcept {
  const TickStages& runs = options_.stages;
  TickRecord record{.tick = due.number, .scheduled = due.scheduled, .woke = due.woke};
  record.missed = due.missed;
  record.spun_ns = saturated_ns(due.spun);
  const auto now_ns = [&]() noexcept { return saturated_ns(HostClock::now() - record.woke); };
  take_change();
  if (runs.input) {
    take_commands(record.scheduled);
    take_script(record.scheduled);
    take_samples(record);
  }
  let_layers_pass(record.scheduled);
  record.drained_ns = now_ns();
  due_ = record.scheduled;
  Frame& frame = frames_.back();
  if (runs.hands) compute_hands(frame);
  record.posed_ns = now_ns();
  frame.settings = shaping_.settings();
  if (stats_.ticks == 0) first_due_ = record.scheduled;
  shaping_.set_time(record.scheduled - first_due_);
  if (runs.deform) {
    const bool completes = taken_ != nullptr && taken_->ends_stroke();
    const std::uint64_t holds = shaping_.sculptor().holds();
    frame.status = shaping_.shape(tips_, frame, stats_, completes);
    if (shaping_.sculptor().holds() != holds) note_hold();
  }
  if (taken_ != nullptr) finish_change(frame);
  record.solved_ns = now_ns();
  describe(record, frame);
  if (runs.publish) {
    for (FrameSink* sink : options_.sinks)
      sink->show(frame);
    frames_.publish();
  }
  record.published_ns = now_ns();
  record_latencies(record);
  if (options_.input_log != nullptr)
    options_.input_log->tick(record.tick, record.scheduled, record.woke);
  if (options_.records != nullptr) options_.records->try_push(record);
  if (taken_ != nullptr) give_back_change();
}

void DeformLoop::describe(const TickRecord& record, Frame& frame) noexcept {
  ++stats_.ticks;
  if (!is_solved(frame.status)) ++stats_.failed;
  frame.tick = record.tick;
  frame.ticks_run = stats_.ticks;
  frame.missed = stats_.missed;
  frame.scheduled = record.scheduled;
  frame.woke = record.woke;
  frame.since_last =
      last_woke_ == HostTime{} ? HostClock::duration::zero() : record.woke - last_woke_;
  last_woke_ = record.woke;
}

void DeformLoop::run(const std::atomic<bool>& stop, std::uint64_t most_ticks) noexcept {
  // Without real-time priority the kernel may delay a wake-up by 50 microseconds unless it is told
  // not to.
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  PaceOptions pace = options_;
  pace.spin = pace.spin && ::sched_getscheduler(0) == SCHED_FIFO;
  Pacer pacer(pace, HostClock::now(), options_.event_count);
  while (pacer.next() < most_ticks) {
    const Pacer::Due due = pacer.wait();
    if (stop.load(std::memory_order_relaxed)) return;
    tick(due);
    if (pacer.end_tick(HostClock::now())) ++stats_.overruns;
    stats_.missed += std::min(pacer.next(), most_ticks) - due.number - 1;
  }
}

Points DeformLoop::final_shape() {
  return shaping_.final_shape(tips_);
}

deform::Mesh DeformLoop::final_mesh() {
  deform::Mesh mesh = shaping_.model().mesh;
  mesh.vertices = final_shape();
  return mesh;
}

} // namespace nendo::flow
