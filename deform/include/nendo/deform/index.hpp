#pragma once
// How lists of vertices, faces, edges, materials and names are indexed.

#include <cstdint>
#include <limits>

namespace nendo::deform {

/// Stands where an index would be, and means that there is nothing: no face, no material, no name.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

} // namespace nendo::deform
