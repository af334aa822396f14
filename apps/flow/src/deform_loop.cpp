#include "ticker.hpp"
#include <nendo/flow/deform_loop.hpp>

#include <algorithm>
#include <utility>

#include <sched.h>
#include <sys/prctl.h>

namespace nendo::flow {
namespace {

/// Returns the first input of each hand.
std::vector<const HandInput*> hands_of(const std::vector<HandInput>& inputs) {
  std::vector<const HandInput*> hands;
  for (const HandInput& input : inputs)
    if (std::none_of(hands.begin(), hands.end(),
                     [&](const HandInput* hand) { return hand->side == input.side; }))
      hands.push_back(&input);
  return hands;
}

std::shared_ptr<HandBodies> bodies_of(const std::vector<HandInput>& inputs,
                                      const Placement& placement, const deform::Mesh& model) {
  std::array<std::optional<hand::HandSkeleton>, 2> by_side;
  for (const HandInput* hand : hands_of(inputs))
    by_side[Placement::index_of(hand->side)] = hand->skeleton(hand->first.side);
  return make_bodies(by_side, model, placement.units_per_metre, placement.table);
}

CoreOptions core_options(const std::vector<HandInput>& inputs, const Placement& placement,
                         const LoopOptions& options, const deform::Mesh& model) {
  CoreOptions core;
  core.setup = {options.sculptor, options.settings
                                      ? *options.settings
                                      : settings_of(options.sculptor, inputs.front().filter,
                                                    placement.units_per_metre)};
  if (options.commands != nullptr) core.shaping.max_requests = options.commands->capacity();
  core.shaping.held = options.begins_held();
  for (const HandInput* hand : hands_of(inputs))
    core.hands.push_back(hand->side);
  core.inputs = inputs.size();
  core.bodies = bodies_of(inputs, placement, model);
  core.units_per_metre = placement.units_per_metre;
  core.rig = options.rig;
  core.rig_state = options.rig_state;
  core.undo_max_bytes = options.undo_max_bytes;
  return core;
}

} // namespace

DeformLoop::DeformLoop(const deform::Mesh& model, const Placement& placement,
                       const std::vector<HandInput>& hands, const LoopOptions& options,
                       const deform::BlockShape* first)
    : DeformLoop(model, core_options(hands, placement, options, model), hands, placement, options,
                 first) {}

DeformLoop::DeformLoop(const deform::Mesh& model, const CoreOptions& core,
                       const std::vector<HandInput>& hands, const Placement& placement,
                       const LoopOptions& options, const deform::BlockShape* first)
    : changes_(model, core, first),
      ticker_(std::make_unique<Ticker>(changes_, options, core, hands, placement)) {}

DeformLoop::~DeformLoop() = default;

void DeformLoop::run(const std::atomic<bool>& stop, std::uint64_t max_ticks) noexcept {
  ticker_->run(stop, max_ticks);
}

void DeformLoop::tick(std::uint64_t number, HostTime scheduled) noexcept {
  tick(number, scheduled, HostClock::now());
}

void DeformLoop::tick(std::uint64_t number, HostTime scheduled, HostTime woke) noexcept {
  ticker_->tick({number, scheduled, woke});
}

FrameExchange& DeformLoop::frames() noexcept {
  return ticker_->frames();
}

deform::FieldStatus DeformLoop::grab_status() const noexcept {
  return ticker_->grab_status();
}

const LoopStats& DeformLoop::stats() const noexcept {
  return ticker_->stats();
}

const WirePath& DeformLoop::drawn_wire() const noexcept {
  return ticker_->core().completed_wire();
}

deform::Points DeformLoop::final_shape() {
  return ticker_->core().final_shape();
}

deform::Mesh DeformLoop::final_mesh() {
  deform::Mesh mesh = ticker_->core().shaping().model().mesh;
  mesh.vertices = final_shape();
  return mesh;
}

DeformLoop::Ticker::Ticker(ChangeBroker& changes, const LoopOptions& options,
                           const CoreOptions& core, std::vector<HandInput> hands,
                           const Placement& placement)
    : options_(options), changes_(changes.offers()), core_(changes, core),
      inputs_(std::move(hands), placement, changes.settings()), frames_(core_.first_frame()) {
  Frame& frame = frames_.back();
  const ShapingCore::Hands poses = inputs_.pose();
  inputs_.show(stats_, frame);
  grab_status_ = core_.begin(poses, frame);
}

void DeformLoop::Ticker::run(const std::atomic<bool>& stop, std::uint64_t max_ticks) noexcept {
  // Without real-time priority the kernel may delay a wake-up by 50 microseconds unless it is set
  // not to.
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  PaceOptions pace = options_;
  pace.spin = pace.spin && ::sched_getscheduler(0) == SCHED_FIFO;
  Pacer pacer(pace, HostClock::now(), options_.event_count);
  while (pacer.next() < max_ticks) {
    const Pacer::Due due = pacer.wait();
    if (stop.load(std::memory_order_relaxed)) return;
    tick(due);
    if (pacer.end_tick(HostClock::now())) ++stats_.overruns;
    stats_.missed += std::min(pacer.next(), max_ticks) - due.number - 1;
  }
}

void DeformLoop::Ticker::tick(const Pacer::Due& due) noexcept {
  const TickStages& runs = options_.stages;
  TickRecord record{.tick = due.number, .scheduled = due.scheduled, .woke = due.woke};
  record.missed = due.missed;
  record.spun_ns = saturated_ns(due.spun);
  const auto now_ns = [&]() noexcept { return saturated_ns(HostClock::now() - record.woke); };
  begin_change();
  if (runs.input) take_input(record);
  inputs_.advance_layers(record.scheduled);
  record.drained_ns = now_ns();
  Frame& frame = frames_.back();
  if (runs.hands) {
    const ShapingCore::Hands poses = inputs_.pose();
    inputs_.show(stats_, frame);
    core_.place(poses, record.scheduled, change_ != nullptr || stats_.ticks == 0, frame);
  }
  record.posed_ns = now_ns();
  frame.settings = core_.shaping().settings();
  if (stats_.ticks == 0) first_due_ = record.scheduled;
  if (runs.deform)
    core_.shape(record.scheduled - first_due_, change_ != nullptr && change_->ends_stroke(), frame,
                stats_);
  if (change_ != nullptr) finish_change(frame);
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
  // The ring counts what it refuses, for its owner.
  if (options_.records != nullptr) options_.records->try_push(record);
  if (change_ != nullptr) end_change();
}

void DeformLoop::Ticker::begin_change() noexcept {
  if (!changes_.take(change_)) return;
  InputLog* const log = options_.input_log;
  if (log != nullptr) {
    if (change_->holds_still) log->command(HoldStill{});
    if (change_->model) log->command(*change_->model);
    // In this order a replay is refused neither: puppets are not for whole hands.
    const bool is_by_hands = change_->settings && flow::is_by_hands(change_->settings->mode);
    if (change_->settings && !is_by_hands) log->command(ChangeSettings{*change_->settings});
    if (change_->rig) log->command(ChangePuppet{change_->rig->number});
    if (is_by_hands) log->command(ChangeSettings{*change_->settings});
  }
  if (!change_->log || !core_.shaping().is_held()) return;
  // What was recorded leads to a shape that is committed, so that a replay ends with the same one.
  if (log != nullptr) log->command(Request::commit);
  core_.ask(Request::commit);
}

/// After the tick has made its shape.
void DeformLoop::Ticker::finish_change(Frame& frame) noexcept {
  // The angles, and so the fingertips, may jump; the shape does not, since they grab it again.
  if (change_->settings) inputs_.change_filters(*change_->settings);
  core_.finish(*change_, inputs_.pose(), frame, stats_);
  if (!change_->log) return;
  switch_on_ = false;
  inputs_.restart(change_->log->state);
  core_.restart(*change_->log, inputs_.pose(), frame, stats_);
}

void DeformLoop::Ticker::end_change() noexcept {
  if (change_->log) options_.input_log = change_->log->log;
  change_ = nullptr;
  changes_.done();
}

void DeformLoop::Ticker::describe(const TickRecord& record, Frame& frame) noexcept {
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

void DeformLoop::Ticker::record_latencies(const TickRecord& record) noexcept {
  const HostTime done = record.published();
  stats_.wake_latency.record(record.woke - record.scheduled);
  stats_.work.record(done - record.woke);
  inputs_.record_latencies(done, stats_);
}

} // namespace nendo::flow
