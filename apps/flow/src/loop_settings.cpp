#include <nendo/flow/loop_settings.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/flow/finger_supports.hpp>

namespace nendo::flow {

bool LoopSettings::are_usable() const noexcept {
  const bool radii = std::all_of(radius_m.begin(), radius_m.end(), [](double radius) {
    return radius >= least_radius_m && radius <= most_radius_m; // false for NaN
  });
  return radii && piece_fraction >= least_piece_fraction && piece_fraction <= most_piece_fraction &&
         std::isfinite(filter.min_cutoff_hz) && std::isfinite(filter.beta_hz_per_rad_s) &&
         std::isfinite(filter.derivative_cutoff_hz);
}

LoopSettings settings_of(const SculptorOptions& sculptor, const hand::FilterOptions& filter,
                         double units_per_metre) {
  const deform::DeformerOptions& deformer = sculptor.deformer;
  return {.mode = sculptor.mode,
          .kernel = deformer.csrbf.kernel,
          .injective = deformer.injective.has_value(),
          .radius_m = radii_on_stage(deformer.supports, units_per_metre),
          .piece_fraction = sculptor.piece_length / deform::least_radius(deformer.supports),
          .filter = filter};
}

SculptorOptions with_settings(SculptorOptions sculptor, const LoopSettings& wanted, int hands,
                              double units_per_metre) {
  const LoopSettings before = settings_of(sculptor, wanted.filter, units_per_metre);
  deform::DeformerOptions& deformer = sculptor.deformer;
  sculptor.mode = wanted.mode;
  deformer.csrbf.kernel = wanted.kernel;
  if (wanted.injective != before.injective) {
    deformer.injective.reset();
    if (wanted.injective) deformer.injective.emplace();
  }
  if (wanted.radius_m != before.radius_m) {
    // Both hands are alike, so that one hand has what two have.
    auto of_hands = supports_of_hands(supports_on_model(wanted.radius_m, units_per_metre), hands);
    if (of_hands) deformer.supports = *std::move(of_hands);
  }
  if (wanted.radius_m != before.radius_m || wanted.piece_fraction != before.piece_fraction)
    sculptor.piece_length = wanted.piece_fraction * deform::least_radius(deformer.supports);
  return sculptor;
}

} // namespace nendo::flow
