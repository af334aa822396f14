#include "render/depth_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace nendo::render {

using Eigen::Vector3f;

namespace {

constexpr float nothing_there = std::numeric_limits<float>::lowest();
constexpr float everything = std::numeric_limits<float>::max();
constexpr float not_counted = std::numeric_limits<float>::quiet_NaN();
constexpr float far_m = 1e6F; // what is beyond casts no shadow

/// The least and the greatest of many numbers, block by block. NaN does not count.
class Range {
public:
  Range() {
    min_.fill(far_m);
    greatest_.fill(-far_m);
  }
  void take(const BlockOfFloats& values) noexcept {
    for (std::size_t at = 0; at < block_places; ++at) {
      min_[at] = values[at] < min_[at] ? values[at] : min_[at];
      greatest_[at] = values[at] > greatest_[at] ? values[at] : greatest_[at];
    }
  }
  float least() const noexcept { return *std::min_element(min_.begin(), min_.end()); }
  float greatest() const noexcept { return *std::max_element(greatest_.begin(), greatest_.end()); }

private:
  BlockOfFloats min_, greatest_;
};

// For each place, a number of 16 bits along each axis: twice the number of the sample whose middle
// is the last one before it, and 1 more if it is not at that middle. It is even, where it is
// not known. So a triangle of which all corners have the same odd number covers no sample.
std::uint32_t cell_of(std::int32_t on_axis) noexcept {
  const std::int32_t from_middle = on_axis - 128;
  const std::uint32_t known = from_middle >= 0 && from_middle < (0x7FFF << 8) ? 1U : 0U;
  const std::uint32_t off = (from_middle & 0xFF) != 0 ? 1U : 0U;
  const std::uint32_t cell = (static_cast<std::uint32_t>(from_middle) >> 8 << 1) | off;
  return known * cell;
}

using BlockOfTriangles = std::array<std::size_t, block_places>;

// Sets `left` to where the corners of those triangles begin that may cover a sample, and returns
// their number. It has no branches: which triangles they are cannot be predicted.
std::size_t leave_out_tiny(std::span<const std::uint32_t> corners, std::size_t first,
                           std::size_t end, const std::vector<std::uint32_t>& cells,
                           BlockOfTriangles& left) noexcept {
  std::size_t count = 0;
  for (std::size_t at = first; at < end; at += 3) {
    const std::uint32_t cell = cells[corners[at]];
    const std::uint32_t differ = (cell ^ cells[corners[at + 1]]) | (cell ^ cells[corners[at + 2]]);
    const bool tiny_across = ((differ & 0xFFFFU) == 0) & ((cell & 1U) != 0);
    const bool tiny_up = ((differ >> 16) == 0) & ((cell & 0x10000U) != 0);
    left[count] = at;
    count += (tiny_across | tiny_up) ? 0 : 1;
  }
  return count;
}

} // namespace

Coordinates::Coordinates(std::span<const Vector3f> places)
    : x(places.size()), y(places.size()), z(places.size()) {
  for (std::size_t at = 0; at < places.size(); ++at) {
    x[at] = places[at].x();
    y[at] = places[at].y();
    z[at] = places[at].z();
  }
}

DepthMap::DepthMap(std::span<const Caster> casters, const Vector3f& toward, int side)
    : toward_{toward.x(), toward.y(), toward.z()}, side_(side),
      nearest_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) + 1, nothing_there) {
  const Vector3f other = std::abs(toward.y()) < 0.9F ? Vector3f::UnitY() : Vector3f::UnitX();
  const Vector3f across = other.cross(toward).normalized();
  const Vector3f up = toward.cross(across);
  across_ = {across.x(), across.y(), across.z()};
  up_ = {up.x(), up.y(), up.z()};
  frame(casters);
  if (!(sample_m_ > 0.0F)) return;
  OnMap on;
  for (const Caster& caster : casters) {
    put(caster.coordinates, on);
    cast(caster, on);
  }
}

// Chooses the square that has all places.
void DepthMap::frame(std::span<const Caster> casters) {
  Range across, up;
  for (const Caster& caster : casters) {
    const Coordinates& places = caster.coordinates;
    for (std::size_t first = 0; first < places.size(); first += block_places) {
      const std::size_t count = std::min(block_places, places.size() - first);
      BlockOfFloats u, v;
      if (count < block_places) {
        u.fill(not_counted);
        v.fill(not_counted);
      }
      for (std::size_t at = 0; at < count; ++at) {
        const float x = places.x[first + at], y = places.y[first + at], z = places.z[first + at];
        const bool counts = std::max(std::max(std::abs(x), std::abs(y)), std::abs(z)) < far_m;
        u[at] = counts ? across_.of(x, y, z) : not_counted;
        v[at] = counts ? up_.of(x, y, z) : not_counted;
      }
      across.take(u);
      up.take(v);
    }
  }
  const float width = across.greatest() - across.least();
  const float height = up.greatest() - up.least();
  if (!(width > 0.0F || height > 0.0F)) return;
  sample_m_ = std::max(width, height) / static_cast<float>(side_ - 4);
  left_ = across.least() - 2.0F * sample_m_;
  bottom_ = up.least() - 2.0F * sample_m_;
}

void DepthMap::put(const Coordinates& places, OnMap& on) const {
  on.grid.resize(places.size());
  on.cells.resize(places.size());
  for (std::size_t first = 0; first < places.size(); first += block_places) {
    const std::size_t count = std::min(block_places, places.size() - first);
    BlockOfFloats columns, rows;
    for (std::size_t at = 0; at < count; ++at) {
      const float x = places.x[first + at], y = places.y[first + at], z = places.z[first + at];
      columns[at] = (across_.of(x, y, z) - left_) / sample_m_;
      rows[at] = (up_.of(x, y, z) - bottom_) / sample_m_;
    }
    std::array<std::int32_t, block_places> x, y;
    for (std::size_t at = 0; at < count; ++at) {
      x[at] = on_grid(columns[at]);
      y[at] = on_grid(rows[at]);
    }
    for (std::size_t at = 0; at < count; ++at) {
      on.grid[first + at] = {x[at], y[at]};
      on.cells[first + at] = cell_of(x[at]) | cell_of(y[at]) << 16;
    }
  }
}

void DepthMap::cast(const Caster& caster, const OnMap& on) {
  const auto corners = caster.corners.first(caster.corners.size() / 3 * 3);
  BlockOfTriangles left;
  for (std::size_t first = 0; first < corners.size(); first += 3 * left.size()) {
    const std::size_t end = std::min(corners.size(), first + 3 * left.size());
    const std::size_t count = leave_out_tiny(corners, first, end, on.cells, left);
    for (std::size_t at = 0; at < count; ++at)
      cast_triangle(caster.places, corners.subspan(left[at]).first<3>(), on.grid);
  }
}

void DepthMap::cast_triangle(std::span<const Vector3f> places,
                             std::span<const std::uint32_t, 3> corners,
                             const std::vector<GridCorner>& grid) {
  const std::array<GridCorner, 3> on{grid[corners[0]], grid[corners[1]], grid[corners[2]]};
  std::array<float, 3> depth{};
  bool has_depth = false; // most triangles need none
  each_covered(on, sample_box(on, side_, {0, side_}),
               [&](int x, int y, const std::array<double, 3>& b) {
                 if (!has_depth)
                   for (std::size_t k = 0; k < 3; ++k) {
                     const Vector3f& place = places[corners[k]];
                     depth[k] = toward_.of(place.x(), place.y(), place.z());
                   }
                 has_depth = true;
                 float& nearest = nearest_[index_in_grid(x, y, side_)];
                 nearest = std::max(nearest, static_cast<float>(b[0]) * depth[0] +
                                                 static_cast<float>(b[1]) * depth[1] +
                                                 static_cast<float>(b[2]) * depth[2]);
               });
}

void DepthMap::find_lit(const PlaceBlock& places, float slack_m, LitBlock& lit) const noexcept {
  std::array<std::int32_t, block_places> sample;
  BlockOfFloats limit;
  const std::int32_t outside = side_ * side_;
  const auto end = static_cast<float>(side_ - 1);
  for (std::size_t at = 0; at < block_places; ++at) {
    const float x = places.x[at], y = places.y[at], z = places.z[at];
    const float column = (across_.of(x, y, z) - left_) / sample_m_;
    const float row = (up_.of(x, y, z) - bottom_) / sample_m_;
    const bool inside = (column >= 0.0F) & (row >= 0.0F) & (column < end) & (row < end);
    const auto whole_column = static_cast<std::int32_t>(inside ? column : 0.0F);
    const auto whole_row = static_cast<std::int32_t>(inside ? row : 0.0F);
    sample[at] = inside ? whole_row * side_ + whole_column : outside;
    limit[at] = inside ? toward_.of(x, y, z) + slack_m : everything;
  }
  for (std::size_t at = 0; at < block_places; ++at)
    lit[at] = nearest_[static_cast<std::size_t>(sample[at])] <= limit[at];
}

float DepthMap::lit_part(const Vector3f& place, float slack_m, int reach) const noexcept {
  const float column = (across_.of(place.x(), place.y(), place.z()) - left_) / sample_m_;
  const float row = (up_.of(place.x(), place.y(), place.z()) - bottom_) / sample_m_;
  const auto limit = static_cast<float>(side_ - 1 - reach);
  const auto edge = static_cast<float>(reach);
  if (!(column >= edge && row >= edge && column < limit && row < limit)) return 1.0F;
  const float depth = toward_.of(place.x(), place.y(), place.z()) + slack_m;
  const int x = static_cast<int>(column);
  const int y = static_cast<int>(row);
  int lit = 0;
  int all = 0;
  for (int dy = -reach; dy <= reach; dy += 2)
    for (int dx = -reach; dx <= reach; dx += 2) {
      ++all;
      if (nearest_[index_in_grid(x + dx, y + dy, side_)] <= depth) ++lit;
    }
  return static_cast<float>(lit) / static_cast<float>(all);
}

} // namespace nendo::render
