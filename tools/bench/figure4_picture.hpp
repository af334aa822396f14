#pragma once
// Draws the paper's figure 4: the time of a whole frame over the number of its evaluations, the
// paper's beside ours.

#include <string>
#include <vector>

#include "bench/table1_picture.hpp"

namespace nendo::bench {

/// Returns an SVG with logarithmic axes. The five radii of a mesh are joined by a line for each
/// type: the paper's, ours in whole frames, and ours without p(x), normals and drawing. The paper's
/// times are those of its Table 1.
std::string figure4_picture(const std::vector<Table1Entry>& entries, const std::string& layout);

} // namespace nendo::bench
