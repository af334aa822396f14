#include "session/loop_change.hpp"

#include <nendo/flow/finger_supports.hpp>

namespace nendo::session {

void LoopChange::add(const flow::Command& command) noexcept {
  if (const auto* change = std::get_if<flow::ChangeSettings>(&command)) settings = change->settings;
  if (const auto* recording = std::get_if<flow::SetRecording>(&command)) record = recording->on;
  reset = reset || std::holds_alternative<flow::ResetModel>(command);
}

flow::LoopSettings settings_of(const PlacedLoop& placed) {
  const auto& sculptor = placed.setup.options.sculptor;
  return {sculptor.mode, sculptor.deformer.csrbf.kernel,
          flow::radii_on_stage(sculptor.deformer.supports, placed.setup.placement.units_per_metre)};
}

bool differs(const LoopChange& change, const PlacedLoop& placed, const RunOptions& options) {
  return change.reset || (change.settings && *change.settings != settings_of(placed)) ||
         (change.record && *change.record != options.recording.on);
}

void apply(const LoopChange& change, const PlacedLoop& placed, RunOptions& options) {
  const flow::LoopSettings in_force = settings_of(placed);
  const flow::LoopSettings wanted = change.settings.value_or(in_force);
  options.loop.sculptor.mode = wanted.mode;
  options.loop.sculptor.deformer.csrbf.kernel = wanted.kernel;
  if (wanted.radius_m != in_force.radius_m) {
    options.supports =
        flow::supports_on_model(wanted.radius_m, placed.setup.placement.units_per_metre);
  } else if (!options.supports) { // made of the model's size: one for all
    options.supports = placed.setup.options.sculptor.deformer.supports;
  }
  if (change.record) options.recording.on = *change.record;
}

} // namespace nendo::session
