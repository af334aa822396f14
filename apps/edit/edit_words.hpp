#pragma once
// What is said after `nendo edit ...`: hands, fingers, places, tolerances.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/timeline/reduce.hpp>

namespace nendo::edit {

// Errors: usage, naming the option and what it may be.

Result<Side> parse_hand(const std::string& text);
Result<hand::Finger> parse_finger(const std::string& text);
/// "1,-2.5,0" after --to.
Result<Eigen::Vector3d> parse_place(const std::string& text);
/// With so many decimals.
std::string fixed(double number, int decimals);
/// Where an edited timeline goes: `out`, or `file` itself where that is empty. Errors: as
/// check_place(); usage, if the file's own name is no timeline's.
Result<std::string> edited_file(const std::string& file, const std::string& out);
/// "1mm", "0.02rad" or "1deg".
Result<timeline::Tolerance> parse_tolerance(const std::string& text);

} // namespace nendo::edit
