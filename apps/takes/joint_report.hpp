#pragma once
// Reports how the joints of recorded hands moved, as text and as JSON, on standard output.

#include <string>
#include <vector>

#include "takes/joint_study.hpp"

namespace nendo::takes {

/// Prints a table of joints, pairs of joints, and principal components of each hand, beside what is
/// published of them.
void print_joints(const std::string& file, const std::vector<JointStudy>& studies);
/// Prints the same as one JSON object.
void print_joints_json(const std::string& file, const std::vector<JointStudy>& studies);

} // namespace nendo::takes
