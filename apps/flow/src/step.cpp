#include <nendo/flow/step.hpp>

#include <nendo/flow/loop_settings.hpp>

namespace nendo::flow {
namespace {

constexpr std::array<std::string_view, 21> step_names{
    "stroke",   "reset",     "mode",  "kernel", "radius", "folding", "filter",
    "settings", "subdivide", "brush", "puppet", "volume", "hold",    "mask",
    "symmetry", "refine",    "cut",   "join",   "copy",   "remove",  "topology"};

} // namespace

std::string_view name_of(StepKind kind) noexcept {
  return step_names[static_cast<std::size_t>(kind)];
}

StepKind kind_of_change(const LoopSettings& before, const LoopSettings& after) noexcept {
  LoopSettings with = before;
  with.mode = after.mode;
  if (with == after) return StepKind::mode;
  with = before;
  with.kernel = after.kernel;
  if (with == after) return StepKind::kernel;
  with = before;
  with.radius_m = after.radius_m;
  if (with == after) return StepKind::radius;
  with = before;
  with.injective = after.injective;
  if (with == after) return StepKind::folding;
  with = before;
  with.brushes = after.brushes;
  with.brush_strength = after.brush_strength;
  if (with == after) return StepKind::brush;
  with = before;
  with.keep_volume = after.keep_volume;
  if (with == after) return StepKind::volume;
  with = before;
  with.hold = after.hold;
  if (with == after) return StepKind::hold;
  with = before;
  with.filter = after.filter;
  return with == after ? StepKind::filter : StepKind::settings;
}

} // namespace nendo::flow
