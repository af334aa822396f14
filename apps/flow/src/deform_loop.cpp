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

} // namespace nendo::flow
