#include <nendo/flow/loop_settings.hpp>

#include <numeric>
#include <utility>

#include <nendo/flow/finger_supports.hpp>

namespace nendo::flow {
namespace {

/// Returns the ratio of the sums of the radii.
double scale_of_radii(const LoopSettings& settings, const LoopSettings& first) noexcept {
  const auto sum = [](const auto& radii) {
    return std::accumulate(radii.begin(), radii.end(), 0.0);
  };
  return sum(settings.radius_m) / sum(first.radius_m);
}

} // namespace

LoopSettings usual_settings() noexcept {
  LoopSettings settings;
  settings.filter.close_pinches = true;
  return settings;
}

LoopSettings plain_settings_of(const SculptorOptions& sculptor) noexcept {
  const deform::DeformerOptions& deformer = sculptor.deformer;
  return {.mode = sculptor.mode,
          .kernel = deformer.csrbf.kernel,
          .injective = deformer.injective.has_value(),
          .brushes = sculptor.brushes,
          .brush_strength = sculptor.brush_strength,
          .keep_volume = deformer.csrbf.keep_volume,
          .hold = sculptor.hold};
}

void set_plain_settings(SculptorOptions& sculptor, const LoopSettings& settings) noexcept {
  sculptor.mode = settings.mode;
  sculptor.hold = settings.hold;
  sculptor.deformer.csrbf.kernel = settings.kernel;
  sculptor.deformer.csrbf.keep_volume = settings.keep_volume;
  sculptor.brushes = settings.brushes;
  sculptor.brush_strength = settings.brush_strength;
}

LoopSettings settings_of(const SculptorOptions& sculptor, const hand::FilterOptions& filter,
                         double units_per_metre) {
  const deform::Supports& supports = sculptor.deformer.supports;
  LoopSettings settings = plain_settings_of(sculptor);
  settings.radius_m = radii_on_stage(supports, units_per_metre);
  settings.piece_fraction = sculptor.piece_length / deform::min_radius(supports);
  settings.filter = filter;
  return settings;
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
  set_plain_settings(sculptor, wanted);
  if (hands == 0) sculptor.hold = Hold::fingertips; // a puppet's points hold
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
    sculptor.piece_length = wanted.piece_fraction * deform::min_radius(deformer.supports);
  return {std::move(sculptor), wanted};
}

} // namespace nendo::flow
