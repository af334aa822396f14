#include <nendo/flow/deform_loop.hpp>

#include <algorithm>
#include <utility>

#include "ticker.hpp"

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

BrokerOptions broker_options(const std::vector<HandInput>& inputs, const Placement& placement,
                             const LoopOptions& options, std::shared_ptr<const HandBodies> bodies) {
  BrokerOptions broker;
  broker.setup = {options.sculptor, options.settings
                                        ? *options.settings
                                        : settings_of(options.sculptor, inputs.front().filter,
                                                      placement.units_per_metre)};
  broker.rig = options.rig;
  broker.bodies = std::move(bodies);
  broker.hands = count_hands(inputs);
  broker.inputs = inputs.size();
  broker.units_per_metre = placement.units_per_metre;
  broker.undo_most_bytes = options.undo_most_bytes;
  return broker;
}

CoreOptions core_options(const std::vector<HandInput>& inputs, const LoopOptions& options,
                         double units_per_metre, const SculptorSetup& setup,
                         std::shared_ptr<HandBodies> bodies) {
  CoreOptions core{{setup}, {}, std::move(bodies), units_per_metre, options.rig};
  if (options.commands != nullptr) core.shaping.most_requests = options.commands->capacity();
  core.shaping.held = options.begins_held();
  core.shaping.pull_is_step = options.pull_is_step;
  for (const HandInput* hand : hands_of(inputs))
    core.hands.push_back(hand->side);
  core.rig_state = options.rig_state;
  return core;
}

} // namespace

DeformLoop::DeformLoop(const deform::Mesh& model, const Placement& placement,
                       const std::vector<HandInput>& hands, const LoopOptions& options,
                       const deform::BlockShape* first)
    : DeformLoop(model, placement, hands, options, first, bodies_of(hands, placement, model)) {}

DeformLoop::DeformLoop(const deform::Mesh& model, const Placement& placement,
                       const std::vector<HandInput>& hands, const LoopOptions& options,
                       const deform::BlockShape* first, const std::shared_ptr<HandBodies>& bodies)
    : changes_(model, broker_options(hands, placement, options, bodies), first),
      ticker_(std::make_unique<Ticker>(
          changes_, options,
          core_options(hands, options, placement.units_per_metre, changes_.setup(), bodies), hands,
          placement)) {}

DeformLoop::~DeformLoop() = default;

void DeformLoop::run(const std::atomic<bool>& stop, std::uint64_t most_ticks) noexcept {
  ticker_->run(stop, most_ticks);
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

} // namespace nendo::flow
