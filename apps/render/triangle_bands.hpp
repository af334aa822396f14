#pragma once
// Sorts the triangles of a picture by bands of its rows, so that a band need not look at all of
// them.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/sample_grid.hpp"

namespace nendo::render {

/// A grid of samples, in bands that each have `band_rows` rows; the last one may have fewer.
struct BandedGrid {
  int width = 0;
  int height = 0;
  int band_rows = 1;
  int bands() const noexcept { return (height + band_rows - 1) / band_rows; }
  Rows rows_of(int band) const noexcept;
};

/// The triangles whose samples are in a band, for each band of a grid.
class TriangleBands {
public:
  TriangleBands() = default;
  /// `places` are those of the vertices on the grid, and `corners` has three for each triangle.
  /// Triangles without a sample in their box are left out.
  TriangleBands(std::span<const GridCorner> places, std::span<const std::uint32_t> corners,
                const BandedGrid& grid);

  /// Returns where the corners of the band's triangles begin, in the order of the triangles.
  std::span<const std::uint32_t> of(int band) const noexcept;

private:
  std::vector<std::size_t> ends_;        ///< in triangles_, of each band
  std::vector<std::uint32_t> triangles_; ///< band by band
};

} // namespace nendo::render
