#pragma once
// Converts fingertip radii between user input, for five or ten fingers, and the loop's supports.

#include <array>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/deform/supports.hpp>

namespace nendo::flow {

/// Parses one radius for all fingertips, or several with commas between (see
/// deform::parse_supports_by_point): in model units, or on the stage, with a unit: "3cm". Returns
/// the supports of both hands' ten fingertips, left hand first, in model units. Error: usage,
/// naming the text and what can be used.
NENDO_API Result<deform::Supports> parse_finger_supports(std::string_view text,
                                                         double units_per_metre = 1.0);

/// Returns the supports of a loop with 1 or 2 hands from those of two hands. Error:
/// usage, if there is one hand, and the two hands differ.
NENDO_API Result<deform::Supports> supports_of_hands(const deform::Supports& of_two, int hands);

/// Convert between the supports of fingertips, and those of fingertips followed by their mirror
/// images.
NENDO_API deform::Supports of_both_sides(deform::Supports supports, Eigen::Index tips);
NENDO_API deform::Supports of_one_side(deform::Supports supports, Eigen::Index tips);

/// Returns the supports of two hands with these radii on the stage, thumb to little finger.
NENDO_API deform::Supports supports_on_model(const std::array<double, 5>& radius_m,
                                             double units_per_metre);

/// Returns the radii of five fingers on the stage, in metres, from a loop's supports: each finger's
/// largest own radius, or the largest shared one.
NENDO_API std::array<double, 5> radii_on_stage(const deform::Supports& supports,
                                               double units_per_metre);

/// Returns a text for messages, with model units in brackets: "13.2 cm (0.248)", or "13.2 to 14 cm
/// (0.248 to 0.263)".
NENDO_API std::string radius_text(const std::array<double, 5>& radius_m, double units_per_metre);

} // namespace nendo::flow
