#include "session/loop_change.hpp"

#include <cstdio>

#include <nendo/viewer/scene_frame.hpp>

namespace nendo::session {
namespace {

// As --radius takes them, to the last bit.
std::string radii_text(const flow::LoopSettings& settings, double units_per_metre) {
  std::string text;
  for (const double radius_m : settings.radius_m) {
    char number[40];
    std::snprintf(number, sizeof number, "%.17g", radius_m * units_per_metre);
    text += (text.empty() ? "" : ",") + std::string(number);
  }
  return text;
}

} // namespace

flow::LoopSettings settings_of(const PlacedLoop& placed) {
  const auto& sculptor = placed.setup.options.sculptor;
  return {
      sculptor.mode, sculptor.deformer.csrbf.kernel,
      viewer::radii_on_stage(sculptor.deformer.supports, placed.setup.placement.units_per_metre)};
}

bool differs(const flow::LoopChange& change, const PlacedLoop& placed, const RunOptions& options) {
  return change.reset || (change.settings && *change.settings != settings_of(placed)) ||
         (change.record && *change.record != options.recording.on);
}

void apply(const flow::LoopChange& change, const PlacedLoop& placed, RunOptions& options) {
  const flow::LoopSettings in_force = settings_of(placed);
  const flow::LoopSettings wanted = change.settings.value_or(in_force);
  options.loop.sculptor.mode = wanted.mode;
  options.loop.sculptor.deformer.csrbf.kernel = wanted.kernel;
  if (wanted.radius_m != in_force.radius_m || options.radius.empty())
    options.radius = radii_text(wanted, placed.setup.placement.units_per_metre);
  if (change.record) options.recording.on = *change.record;
}

} // namespace nendo::session
