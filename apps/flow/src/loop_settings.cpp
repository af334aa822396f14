#include <nendo/flow/loop_settings.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <nendo/flow/finger_supports.hpp>

namespace nendo::flow {

bool LoopSettings::are_usable() const noexcept {
  const bool radii = std::all_of(radius_m.begin(), radius_m.end(), [](double radius) {
    return radius >= least_radius_m && radius <= most_radius_m; // false for NaN
  });
  return radii && std::abs(brush_strength) <= 1.0 && keep_volume >= 0.0 && keep_volume <= 1.0 &&
         piece_fraction >= least_piece_fraction && piece_fraction <= most_piece_fraction &&
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
          .filter = filter,
          .brushes = sculptor.brushes,
          .brush_strength = sculptor.brush_strength,
          .keep_volume = deformer.csrbf.keep_volume,
          .hold = sculptor.hold};
}

double scale_of_radii(const LoopSettings& settings, const LoopSettings& first) noexcept {
  const auto sum = [](const auto& radii) {
    return std::accumulate(radii.begin(), radii.end(), 0.0);
  };
  return sum(settings.radius_m) / sum(first.radius_m);
}

deform::Supports scaled(deform::Supports supports, double scale) {
  for (deform::Support& shared : supports.shared)
    shared.radius *= scale;
  for (deform::OwnSupport& own : supports.own)
    own.support.radius *= scale;
  return supports;
}

SculptorSetup with_settings(const SculptorSetup& now, const SculptorSetup& first,
                            const LoopSettings& wanted, int hands, double units_per_metre) {
  if (wanted == first.settings) return first;
  SculptorOptions sculptor = now.options;
  deform::DeformerOptions& deformer = sculptor.deformer;
  sculptor.mode = wanted.mode;
  sculptor.hold = hands == 0 ? Hold::fingertips : wanted.hold; // a puppet's points hold
  deformer.csrbf.kernel = wanted.kernel;
  deformer.csrbf.keep_volume = wanted.keep_volume;
  sculptor.brushes = wanted.brushes;
  sculptor.brush_strength = wanted.brush_strength;
  if (wanted.injective != now.settings.injective) {
    deformer.injective.reset();
    if (wanted.injective) deformer.injective.emplace();
  }
  const bool other_radii = wanted.radius_m != now.settings.radius_m;
  if (other_radii && hands == 0) {
    deformer.supports =
        scaled(first.options.deformer.supports, scale_of_radii(wanted, first.settings));
  } else if (other_radii) {
    // Both hands are alike, so that one hand has what two have.
    auto of_hands = supports_of_hands(supports_on_model(wanted.radius_m, units_per_metre), hands);
    if (of_hands && sculptor.mirror) of_hands = of_both_sides(*std::move(of_hands), 5 * hands);
    if (of_hands) deformer.supports = *std::move(of_hands);
  }
  if (other_radii || wanted.piece_fraction != now.settings.piece_fraction)
    sculptor.piece_length = wanted.piece_fraction * deform::least_radius(deformer.supports);
  return {std::move(sculptor), wanted};
}

} // namespace nendo::flow
