#pragma once
// Parses the arguments of `nendo edit`: hands, fingers, places and tolerances. All errors are usage
// errors that name the option and its possible values.

#include <string>

#include <nendo/base/result.hpp>

#include "timeline/reduce.hpp"

namespace nendo::edit {

Result<Side> parse_hand(const std::string& text);
Result<hand::Finger> parse_finger(const std::string& text);
/// Parses three numbers after --to, such as "1,-2.5,0".
Result<Eigen::Vector3d> parse_place(const std::string& text);
/// Formats a number with the given count of decimals.
std::string fixed(double number, int decimals);
/// Returns the path to which an edited timeline is written: `out`, or `file` itself if `out` is
/// empty. Errors: those of check_place(); usage if `file` is not named like a timeline.
Result<std::string> edited_file(const std::string& file, const std::string& out);
/// Parses a length or an angle: "1mm", "0.02rad" or "1deg".
Result<timeline::Tolerance> parse_tolerance(const std::string& text);

} // namespace nendo::edit
