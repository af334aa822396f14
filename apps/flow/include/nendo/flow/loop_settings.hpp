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
  bool injective = false;           ///< the surface never folds, unless it keeps its volume
  std::array<double, 5> radius_m{}; ///< each finger's radius on the stage, thumb to little finger
  double piece_fraction = 0.05;     ///< the length of a piece of type 2, in minimum radii
  hand::FilterOptions filter{};     ///< the filter of both hands
  /// Each finger's brush, thumb to little finger, in type 2 (SculptorOptions::brushes).
  std::array<deform::Brush, 5> brushes{};
  double brush_strength = deform::usual_brush_strength; ///< -1 to 1
  double keep_volume = 0.0; ///< 0: compressible ... 1: volume-preserving (deform::CsrbfOptions)
  Hold hold = Hold::fingertips;

  /// Returns whether all numbers are finite and within their ranges (setting.hpp). A loop takes no
  /// others.
  bool are_usable() const noexcept;

  friend bool operator==(const LoopSettings&, const LoopSettings&) = default;
};

/// Returns the default settings of a program: pinches are closed. A bare
/// LoopSettings leaves the hands as they are, for the poses of timelines, which are closed already.
NENDO_API LoopSettings usual_settings() noexcept;

/// Returns whether hands close pinches: not in clay, which may be between their pads.
constexpr bool closes_pinches(const hand::FilterOptions& filter, Mode mode) noexcept {
  return filter.close_pinches && mode != Mode::clay;
}

/// Returns the settings of a sculptor. Where a finger has several radii, the largest is its radius.
NENDO_API LoopSettings settings_of(const SculptorOptions& sculptor,
                                   const hand::FilterOptions& filter, double units_per_metre);

/// The same without what depends on the radii, and without the filter.
NENDO_API LoopSettings plain_settings_of(const SculptorOptions& sculptor) noexcept;
/// Puts these into the options, but for `injective`.
NENDO_API void set_plain_settings(SculptorOptions& sculptor, const LoopSettings& settings) noexcept;

/// The options of a sculptor, and the settings that they mean.
struct SculptorSetup {
  SculptorOptions options{};
  LoopSettings settings{};
};

/// Returns these supports with all radii multiplied by `scale`.
NENDO_API deform::Supports scaled(deform::Supports supports, double scale);

/// Returns `now` with other settings. Options that settings do not have stay. Radii that do not
/// change stay as they are, with all their weights; these come back with the settings of `first`,
/// with which it began. A puppet's points (`hands` is then 0) keep the ratios of their radii.
NENDO_API SculptorSetup with_settings(const SculptorSetup& now, const SculptorSetup& first,
                                      const LoopSettings& wanted, int hands,
                                      double units_per_metre);

} // namespace nendo::flow
