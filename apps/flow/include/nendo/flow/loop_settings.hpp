#pragma once
// The settings that can change during a run, from one tick to the next.

#include <array>

#include <nendo/deform/wendland.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/hand/joint_filter.hpp>

namespace nendo::flow {

struct NENDO_API LoopSettings {
  Mode mode = Mode::type1;
  deform::Wendland kernel = deform::Wendland::c2;
  bool injective = false;           ///< prevents folds, except with keep_volume
  std::array<double, 5> radius_m{}; ///< each finger's radius on the stage, thumb to little finger
  double piece_fraction = 0.05;     ///< the length of a path piece in type 2, in minimum radii
  hand::FilterOptions filter{};     ///< the filter of both hands
  /// Each finger's brush, thumb to little finger, in type 2 (SculptorOptions::brushes).
  std::array<deform::Brush, 5> brushes{};
  double brush_strength = deform::usual_brush_strength; ///< -1 to 1
  double keep_volume = 0.0; ///< 0: compressible ... 1: volume-preserving (deform::CsrbfOptions)
  Hold hold = Hold::fingertips;

  /// Returns whether all numbers are finite and within their ranges (setting.hpp), as a loop
  /// requires.
  bool are_usable() const noexcept;

  friend bool operator==(const LoopSettings&, const LoopSettings&) = default;
};

/// Returns the default settings of a program, which close pinches. LoopSettings{} does not, for the
/// poses of timelines, where pinches are already closed.
NENDO_API LoopSettings usual_settings() noexcept;

/// Returns whether hands close pinches; not in clay, which may be between the finger pads.
constexpr bool closes_pinches(const hand::FilterOptions& filter, Mode mode) noexcept {
  return filter.close_pinches && mode != Mode::clay;
}

/// Returns the settings of a sculptor, with each finger's largest radius.
NENDO_API LoopSettings settings_of(const SculptorOptions& sculptor,
                                   const hand::FilterOptions& filter, double units_per_metre);

/// Returns the settings of a sculptor that depend neither on the radii nor on the filter.
NENDO_API LoopSettings plain_settings_of(const SculptorOptions& sculptor) noexcept;
/// Sets these in the options, except `injective`.
NENDO_API void set_plain_settings(SculptorOptions& sculptor, const LoopSettings& settings) noexcept;

/// The options of a sculptor, and the corresponding settings.
struct SculptorSetup {
  SculptorOptions options{};
  LoopSettings settings{};
};

/// Returns these supports with all radii multiplied by `scale`.
NENDO_API deform::Supports scaled(deform::Supports supports, double scale);

/// Returns `now` with the settings `wanted`. Options without a setting do not change. Unchanged
/// radii keep their weights; the radii of `first`, the initial setup, restore its weights. A
/// puppet's points (`hands` is then 0) keep the ratios of their radii.
NENDO_API SculptorSetup with_settings(const SculptorSetup& now, const SculptorSetup& first,
                                      const LoopSettings& wanted, int hands,
                                      double units_per_metre);

} // namespace nendo::flow
