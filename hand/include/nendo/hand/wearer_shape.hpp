#pragma once
// How one wearer's hand differs from the proportions of an average hand of its size: the bones, the
// base and the axes of the thumb, how the knuckles' axes are tilted, and the pads. A calibration
// finds it, because pads that touch determine it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nendo::hand {

enum class ShapeTerm : std::uint8_t {
  thumb_metacarpal, ///< how much longer a bone is: the natural logarithm of the factor
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
  thumb_base_x, ///< how far the thumb's base lies from the average, in metres: towards the ulna,
  thumb_base_y, ///< to the back of the hand,
  thumb_base_z, ///< and to the wrist
  thumb_rest,   ///< how much farther the thumb lies from the index finger at zero angles, radians
  thumb_tilt_x, ///< how the axis is tilted about which the thumb rolls: about the axes of a right
  thumb_tilt_y, ///< hand's wrist, radians
  thumb_pronation, ///< how much farther the thumb is turned about itself, radians
  index_tilt,      ///< the turn of a knuckle's axis of flexion about the finger, radians; positive
  middle_tilt,     ///< if the bent finger goes towards the ulna
  ring_tilt,
  little_tilt,
  thumb_pronation_by_roll,      ///< how much more the thumb turns about itself for each radian of
  thumb_pronation_by_abduction, ///< roll, or of abduction
  pad_depth,                    ///< how much deeper below the bone a digit's pad is, metres,
  pad_behind,                   ///< the pad's distance from the end of the finger
};

inline constexpr std::size_t shape_terms = 30;

// An average hand's. A pad is the middle of the area that touches another pad.
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

/// Returns the most that a term may be, either way: half as long again, 30 mm, 60 degrees, pads 5
/// mm. No hand differs that much.
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
