#pragma once
// ZBrush's colours of vertices, which it writes into comments of an OBJ.

#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace nendo::deform {

/// Reads a comment "#MRGB mmrrggbb...": of each vertex in turn a mask, red, green and blue, two
/// hexadecimal digits each. Appends 0xRRGGBB for each of them to `colours`; any other comment
/// changes nothing.
void read_polypaint(std::string_view comment, std::vector<std::uint32_t>& colours);

/// Returns the colours of so many vertices, linear (Appearance). Those of which there is none are
/// white.
Eigen::Matrix4Xf colours_of_polypaint(const std::vector<std::uint32_t>& colours,
                                      Eigen::Index vertices);

} // namespace nendo::deform
