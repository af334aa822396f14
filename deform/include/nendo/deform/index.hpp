#pragma once
// Indices of vertices, faces, edges, materials and names.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace nendo::deform {

/// The index of no element: no face, no material, no name.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

/// Converts an index or a count to 32 bits. `number` must fit.
constexpr std::uint32_t to_index(std::size_t number) noexcept {
  return static_cast<std::uint32_t>(number);
}

/// Returns the indices of `count` elements: 0, 1, 2 and so on.
inline std::vector<std::uint32_t> all_indices(std::size_t count) {
  std::vector<std::uint32_t> all(count);
  for (std::size_t at = 0; at < count; ++at)
    all[at] = to_index(at);
  return all;
}

} // namespace nendo::deform
