#pragma once
// How lists of vertices, faces, edges, materials and names are indexed.

#include <cstddef>
#include <cstdint>
#include <limits>

namespace nendo::deform {

/// Stands where an index would be, and means that there is nothing: no face, no material, no name.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

/// Returns an index, or a number of entries, as lists of indices hold it. It must be so small.
constexpr std::uint32_t to_index(std::size_t number) noexcept {
  return static_cast<std::uint32_t>(number);
}

} // namespace nendo::deform
