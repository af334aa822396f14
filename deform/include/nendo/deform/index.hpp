#pragma once
// Indices of vertices, faces, edges, materials and names.

#include <cstddef>
#include <cstdint>
#include <limits>

namespace nendo::deform {

/// The index of no element: no face, no material, no name.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

/// Converts an index or a count to 32 bits. `number` must fit.
constexpr std::uint32_t to_index(std::size_t number) noexcept {
  return static_cast<std::uint32_t>(number);
}

} // namespace nendo::deform
