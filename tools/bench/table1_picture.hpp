#pragma once
// Draws the paper's Table 1 and ours as a picture.

#include <string>
#include <vector>

#include "bench/table1_trial.hpp"

namespace nendo::bench {

/// A cell, and its place in the paper's table.
struct Table1Entry {
  std::size_t plane;  ///< in table1_planes
  std::size_t radius; ///< in table1_radii
  Table1Cell cell;
};

/// Returns an SVG of frames per second on a logarithmic scale, with a panel for each type. Each
/// entry has the paper's figure, that of a whole frame here, and those of the deformation alone:
/// the plain loop's and ours with one thread and two.
std::string table1_picture(const std::vector<Table1Entry>& entries, const std::string& layout);

} // namespace nendo::bench
