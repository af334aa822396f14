#pragma once
// The radii of fingertips: as a user gives them, for five fingers or ten, and as the loop's
// supports.

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

/// Returns the supports of fingertips and, after them, of their mirror images, from those of the
/// fingertips alone; and the reverse.
NENDO_API deform::Supports of_both_sides(deform::Supports supports, Eigen::Index tips);
NENDO_API deform::Supports of_one_side(deform::Supports supports, Eigen::Index tips);

/// The supports of both hands, whose fingers have these radii on the stage, thumb to little finger.
NENDO_API deform::Supports supports_on_model(const std::array<double, 5>& radius_m,
                                             double units_per_metre);

/// The radii of five fingers on the stage, in metres. supports: a loop's; the largest radius of
/// each finger's own counts, or of the shared ones if it has none.
NENDO_API std::array<double, 5> radii_on_stage(const deform::Supports& supports,
                                               double units_per_metre);

/// Returns these radii for messages, on the stage, and in the model's units in
/// brackets: "13.2 cm (0.248)", or "13.2 to 14 cm (0.248 to 0.263)".
NENDO_API std::string radius_text(const std::array<double, 5>& radius_m, double units_per_metre);

} // namespace nendo::flow
