#pragma once
// The deviations of a wearer's hand from the proportions of an average hand of its size: the bones,
// the base and the axes of the thumb, the tilts of the knuckles' axes, and the pads. A calibration
// determines them from touching pads.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nendo::hand {

enum class ShapeTerm : std::uint8_t {
  thumb_metacarpal, ///< bones: the natural logarithm of a factor on the length
  thumb_proximal,
  thumb_distal,
  index_proximal,
  index_intermediate,
  index_distal,
  middle_proximal,
  middle_intermediate,
  middle_distal,
  ring_proximal,
  ring_intermediate,
  ring_distal,
  little_proximal,
  little_intermediate,
  little_distal,
  thumb_base_x,    ///< offset of the thumb's base from the average, metres: to the ulna,
  thumb_base_y,    ///< to the back of the hand,
  thumb_base_z,    ///< and to the wrist
  thumb_rest,      ///< additional angle of thumb and index finger at zero angles, radians
  thumb_tilt_x,    ///< tilt of the axis about which the thumb rolls, about X and Y of a right
  thumb_tilt_y,    ///< hand's wrist, radians
  thumb_pronation, ///< additional rotation of the thumb about its long axis, radians
  index_tilt,      ///< rotation of a knuckle's flexion axis about the finger, radians; positive
  middle_tilt,     ///< if the bent finger deviates to the ulna
  ring_tilt,
  little_tilt,
  thumb_pronation_by_roll,      ///< additional rotation about its long axis per radian of
  thumb_pronation_by_abduction, ///< roll, or of abduction
  pad_depth,                    ///< additional depth of the pads below the bone, metres
  pad_behind,                   ///< additional distance of the pads from the tips, metres
};

inline constexpr std::size_t shape_terms = 30;

// Values of an average hand. A pad is the centre of the area that touches another pad.
inline constexpr double pad_depth_m = 0.006;
inline constexpr double pad_behind_tip_m = 0.003;

inline constexpr std::array<std::string_view, shape_terms> shape_term_names{
    "thumb_metacarpal",
    "thumb_proximal",
    "thumb_distal",
    "index_proximal",
    "index_intermediate",
    "index_distal",
    "middle_proximal",
    "middle_intermediate",
    "middle_distal",
    "ring_proximal",
    "ring_intermediate",
    "ring_distal",
    "little_proximal",
    "little_intermediate",
    "little_distal",
    "thumb_base_x",
    "thumb_base_y",
    "thumb_base_z",
    "thumb_rest",
    "thumb_tilt_x",
    "thumb_tilt_y",
    "thumb_pronation",
    "index_tilt",
    "middle_tilt",
    "ring_tilt",
    "little_tilt",
    "thumb_pronation_by_roll",
    "thumb_pronation_by_abduction",
    "pad_depth",
    "pad_behind",
};

constexpr std::string_view name_of(ShapeTerm term) noexcept {
  return shape_term_names[static_cast<std::size_t>(term)];
}

/// Returns the maximum magnitude of a term: a factor of 1.5 for bones, 30 mm, 60 degrees, 5 mm for
/// pads. No hand differs that much.
constexpr double max_of(ShapeTerm term) noexcept {
  if (term >= ShapeTerm::pad_depth) return 0.005;
  if (term <= ShapeTerm::little_distal) return 0.4;
  return term <= ShapeTerm::thumb_base_z ? 0.03 : 1.05;
}

/// All zero is an average hand.
struct WearerShape {
  std::array<double, shape_terms> terms{};

  constexpr double operator[](ShapeTerm term) const noexcept {
    return terms[static_cast<std::size_t>(term)];
  }
  constexpr double& operator[](ShapeTerm term) noexcept {
    return terms[static_cast<std::size_t>(term)];
  }
  constexpr bool is_average() const noexcept { return *this == WearerShape{}; }
  friend constexpr bool operator==(const WearerShape&, const WearerShape&) = default;
};

} // namespace nendo::hand
