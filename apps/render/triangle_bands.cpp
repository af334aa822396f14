#include "render/triangle_bands.hpp"

#include <algorithm>
#include <array>

namespace nendo::render {

Rows BandedGrid::rows_of(int band) const noexcept {
  return {band * band_rows, std::min(height, (band + 1) * band_rows)};
}

TriangleBands::TriangleBands(std::span<const GridCorner> places,
                             std::span<const std::uint32_t> corners, const BandedGrid& grid)
    : ends_(static_cast<std::size_t>(grid.bands())) {
  const auto each = [&](const auto& visit) { // visit(band, triangle)
    for (std::size_t at = 0; at + 2 < corners.size(); at += 3) {
      const std::array<GridCorner, 3> on{places[corners[at]], places[corners[at + 1]],
                                         places[corners[at + 2]]};
      const SampleBox box = sample_box(on, grid.width, {0, grid.height});
      if (box.is_empty()) continue;
      for (int band = box.y0 / grid.band_rows; band <= box.y1 / grid.band_rows; ++band)
        visit(static_cast<std::size_t>(band), static_cast<std::uint32_t>(at));
    }
  };
  each([&](std::size_t band, std::uint32_t) { ++ends_[band]; });
  std::size_t all = 0;
  for (std::size_t& end : ends_) { // where it begins, until its triangles are put there
    const std::size_t count = end;
    end = all;
    all += count;
  }
  triangles_.resize(all);
  each([&](std::size_t band, std::uint32_t triangle) { triangles_[ends_[band]++] = triangle; });
}

std::span<const std::uint32_t> TriangleBands::of(int band) const noexcept {
  const auto at = static_cast<std::size_t>(band);
  if (at >= ends_.size()) return {};
  const std::size_t begin = at == 0 ? 0 : ends_[at - 1];
  return std::span(triangles_).subspan(begin, ends_[at] - begin);
}

} // namespace nendo::render
