#include "render/skin_net.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace nendo::render {

using Eigen::Vector3f;
using Eigen::Vector3i;

namespace {

constexpr int block_cells = 5;
constexpr int rounds = 3; // of evening out

// Of a cell: its corners, as bits, that are inside. Returns whether these hang together by the
// cell's edges.
bool hangs_together(unsigned corners) noexcept {
  unsigned found = corners & (0U - corners); // the first of them
  for (unsigned before = 0; before != found;) {
    before = found;
    // Neighbours along x, y and z.
    found |= (before & 0x55U) << 1U | (before & 0xAAU) >> 1U;
    found |= (before & 0x33U) << 2U | (before & 0xCCU) >> 2U;
    found |= (before & 0x0FU) << 4U | (before & 0xF0U) >> 4U;
    found &= corners;
  }
  return found == corners;
}

// Surface nets (S. Gibson, "Constrained elastic surface nets", MICCAI 1998): a vertex in each cell
// that the surface passes through, amid its crossings of the cell's edges; a quad for each edge.
class Net {
public:
  Net(const DistanceAt& distance, const Steepness& known, const Eigen::AlignedBox3f& box,
      float cell_m)
      : lowest_(box.min()), cell_m_(cell_m),
        count_((box.sizes() / cell_m).cast<int>() + Vector3i::Constant(2)) {
    values_.resize(static_cast<std::size_t>(count_.x()) * static_cast<std::size_t>(count_.y()) *
                   static_cast<std::size_t>(count_.z()));
    for (Vector3i first = Vector3i::Zero(); first.z() < count_.z(); first.z() += block_cells)
      for (first.y() = 0; first.y() < count_.y(); first.y() += block_cells)
        for (first.x() = 0; first.x() < count_.x(); first.x() += block_cells)
          fill_block(distance, known, first);
    while (open_pinches()) {
    }
  }

  SkinMesh mesh() {
    for (int z = 0; z < count_.z(); ++z)
      for (int y = 0; y < count_.y(); ++y)
        for (int x = 0; x < count_.x(); ++x)
          for (int axis = 0; axis < 3; ++axis)
            add_quad(Vector3i(x, y, z), axis);
    return std::move(mesh_);
  }

private:
  // Most blocks are so far from the surface that one distance decides for them.
  void fill_block(const DistanceAt& distance, const Steepness& known, const Vector3i& first) {
    const Vector3i end = (first + Vector3i::Constant(block_cells)).cwiseMin(count_);
    const Vector3f half = 0.5F * cell_m_ * (end - first).cast<float>();
    const float middle = distance(place(first) + half);
    const bool is_far = std::abs(middle) > known.steepness * half.norm() + known.slack_m;
    for (int z = first.z(); z < end.z(); ++z)
      for (int y = first.y(); y < end.y(); ++y)
        for (int x = first.x(); x < end.x(); ++x) {
          const Vector3i at(x, y, z);
          values_[index(at)] = is_far ? middle : distance(place(at));
        }
  }
  // Where two sheets of the surface pass through one cell, they would share its vertex and perhaps
  // an edge. There, the corner that is least inside is put outside. Returns whether there was any.
  bool open_pinches() {
    bool any = false;
    for (int z = 0; z + 1 < count_.z(); ++z)
      for (int y = 0; y + 1 < count_.y(); ++y)
        for (int x = 0; x + 1 < count_.x(); ++x)
          any = open_pinch(Vector3i(x, y, z)) || any;
    return any;
  }
  bool open_pinch(const Vector3i& at) {
    unsigned inside = 0;
    std::size_t least = 0;
    float deepest = std::numeric_limits<float>::lowest();
    for (unsigned corner = 0; corner < 8; ++corner) {
      const std::size_t here =
          index(at + Vector3i(int(corner & 1U), int(corner >> 1U & 1U), int(corner >> 2U & 1U)));
      if (!(values_[here] < 0.0F)) continue;
      inside |= 1U << corner;
      if (values_[here] > deepest) {
        deepest = values_[here];
        least = here;
      }
    }
    if (inside == 0 || inside == 0xFFU) return false;
    if (hangs_together(inside) && hangs_together(~inside & 0xFFU)) return false;
    values_[least] = -values_[least];
    return true;
  }
  std::size_t index(const Vector3i& at) const noexcept {
    return static_cast<std::size_t>((at.z() * count_.y() + at.y()) * count_.x() + at.x());
  }
  Vector3f place(const Vector3i& at) const { return lowest_ + cell_m_ * at.cast<float>(); }

  // Of the cell whose lowest corner is `at`.
  std::uint32_t vertex(const Vector3i& at) {
    const auto [entry, is_new] =
        vertices_.try_emplace(index(at), static_cast<std::uint32_t>(mesh_.places.size()));
    if (!is_new) return entry->second;
    Vector3f sum = Vector3f::Zero();
    int crossings = 0;
    for (int corner = 0; corner < 8; ++corner)
      for (int axis = 0; axis < 3; ++axis) {
        if ((corner >> axis & 1) != 0) continue;
        const Vector3i a = at + Vector3i(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
        const Vector3i b = a + Vector3i::Unit(axis);
        const float from = values_[index(a)];
        const float to = values_[index(b)];
        if ((from < 0.0F) == (to < 0.0F)) continue;
        sum += place(a) + from / (from - to) * (place(b) - place(a));
        ++crossings;
      }
    mesh_.places.emplace_back(sum / static_cast<float>(std::max(1, crossings)));
    return entry->second;
  }

  // About the edge from `at` along `axis`, if the surface crosses it.
  void add_quad(const Vector3i& at, int axis) {
    const Vector3i u = Vector3i::Unit((axis + 1) % 3);
    const Vector3i v = Vector3i::Unit((axis + 2) % 3);
    if (at.dot(u) == 0 || at.dot(v) == 0 || at[axis] + 1 >= count_[axis]) return;
    const bool inside = values_[index(at)] < 0.0F;
    if (inside == (values_[index(at + Vector3i::Unit(axis))] < 0.0F)) return;
    std::array<std::uint32_t, 4> quad{vertex(at - u - v), vertex(at - v), vertex(at),
                                      vertex(at - u)};
    if (!inside) std::reverse(quad.begin(), quad.end());
    const auto length = [&](std::size_t a, std::size_t b) {
      return (mesh_.places[quad[a]] - mesh_.places[quad[b]]).squaredNorm();
    };
    if (length(0, 2) > length(1, 3)) std::rotate(quad.begin(), quad.begin() + 1, quad.end());
    mesh_.corners.insert(mesh_.corners.end(),
                         {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]});
  }

  Vector3f lowest_;
  float cell_m_;
  Vector3i count_;
  std::vector<float> values_;
  std::unordered_map<std::size_t, std::uint32_t> vertices_;
  SkinMesh mesh_;
};

// Newton's step to the zero of the distance, by differences at a tetrahedron's corners. Where
// fingers meet the slope has a jump, and a step could be long.
Vector3f onto_surface(const DistanceAt& distance, const Vector3f& place, float cell_m) {
  constexpr std::array<std::array<float, 3>, 4> corners{
      {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
  const float step = 0.05F * cell_m;
  Vector3f slope = Vector3f::Zero();
  float middle = 0.0F;
  for (const auto& corner : corners) {
    const Vector3f way(corner[0], corner[1], corner[2]);
    const float value = distance(place + step * way);
    slope += value * way;
    middle += 0.25F * value;
  }
  slope /= 4.0F * step;
  const float squared = slope.squaredNorm();
  if (!(squared > 0.05F)) return place;
  const float longest = 0.3F * cell_m;
  Vector3f move = -middle / squared * slope;
  const float length = move.norm();
  if (length > longest) move *= longest / length;
  return place + move;
}

} // namespace

std::vector<std::vector<std::uint32_t>> neighbours_in(const SkinMesh& mesh) {
  std::vector<std::vector<std::uint32_t>> beside(mesh.places.size());
  // Each edge of a closed surface has two triangles, which run along it in opposite directions.
  for (std::size_t at = 0; at < mesh.corners.size(); at += 3)
    for (std::size_t k = 0; k < 3; ++k)
      beside[mesh.corners[at + k]].push_back(mesh.corners[at + (k + 1) % 3]);
  return beside;
}

SkinMesh net_about(const DistanceAt& distance, const Steepness& known,
                   const Eigen::AlignedBox3f& box, float cell_m) {
  SkinMesh mesh = Net(distance, known, box, cell_m).mesh();
  const auto beside = neighbours_in(mesh);
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vector3f> moved(mesh.places.size());
    for (std::size_t at = 0; at < moved.size(); ++at) {
      Vector3f sum = Vector3f::Zero();
      for (const std::uint32_t other : beside[at])
        sum += mesh.places[other];
      const Vector3f mean = sum / static_cast<float>(std::max<std::size_t>(1, beside[at].size()));
      moved[at] = onto_surface(distance, 0.5F * (mesh.places[at] + mean), cell_m);
    }
    mesh.places = std::move(moved);
  }
  return mesh;
}

} // namespace nendo::render
