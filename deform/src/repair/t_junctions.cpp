#include "repair/steps.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "mesh/columns.hpp"
#include "repair/stitch.hpp"

namespace nendo::deform {
namespace {

/// A vertex in an edge: how far along from the edge's corner, and where.
struct JunctionPoint {
  double along;
  std::uint32_t place;
};

/// By the corner behind which they come.
using Junctions = std::map<std::uint32_t, std::vector<JunctionPoint>>;

/// Nothing if there are too many open edges to be compared with all that may lie in them.
std::optional<Junctions> junctions_of(const Mesh& mesh, const std::vector<std::uint32_t>& place_of,
                                      double tolerance) {
  constexpr std::size_t max_looks = 100'000'000;
  std::vector<PlacedEdge> open;
  for_each_edge(placed_edges(mesh, place_of), [&](std::span<const PlacedEdge> sides) {
    if (sides.size() == 1) open.push_back(sides[0]);
  });
  std::vector<std::pair<double, std::uint32_t>> by_x; // open places
  for (const PlacedEdge& edge : open)
    for (const std::uint32_t place : {edge.low, edge.high})
      by_x.emplace_back(space_point(mesh.vertices, place)[0], place);
  std::sort(by_x.begin(), by_x.end());
  by_x.erase(std::unique(by_x.begin(), by_x.end()), by_x.end());
  Junctions found;
  std::size_t looks = 0;
  for (const PlacedEdge& edge : open) {
    const std::uint32_t from = place_of[edge.corner], to = place_of[edge.next];
    const SpacePoint begin = space_point(mesh.vertices, from);
    const SpacePoint way = space_point(mesh.vertices, to) - begin;
    const double length = length_of(way);
    if (!(length > 2.0 * tolerance)) continue;
    const double low = std::min(begin[0], begin[0] + way[0]) - tolerance;
    const double high = std::max(begin[0], begin[0] + way[0]) + tolerance;
    for (auto at = std::lower_bound(by_x.begin(), by_x.end(), std::pair(low, std::uint32_t{0}));
         at != by_x.end() && at->first <= high; ++at) {
      if (++looks > max_looks) return std::nullopt;
      if (at->second == from || at->second == to) continue;
      const SpacePoint beside = space_point(mesh.vertices, at->second) - begin;
      const double along = dot(beside, way) / (length * length);
      if (along * length <= tolerance || (1.0 - along) * length <= tolerance) continue;
      if (length_of(beside - along * way) > tolerance) continue;
      found[edge.corner].push_back({along, at->second});
    }
  }
  for (auto& [corner, points] : found)
    std::sort(points.begin(), points.end(), [](const JunctionPoint& a, const JunctionPoint& b) {
      return std::pair(a.along, a.place) < std::pair(b.along, b.place);
    });
  return found;
}

/// Texture coordinates between others, and the colours of these places, in new last columns.
class MixedTexcoords {
public:
  explicit MixedTexcoords(Mesh& mesh) : mesh_(mesh), before_(mesh.texcoords.cols()) {}
  std::uint32_t between(std::uint32_t a, std::uint32_t b, double along) {
    if (a == b) return a;
    more_.push_back({a, b, along});
    return static_cast<std::uint32_t>(before_) + to_index(more_.size()) - 1;
  }
  void finish() {
    append_to(mesh_.texcoords);
    if (mesh_.look.texcoord_colours.cols() > 0) append_to(mesh_.look.texcoord_colours);
  }

private:
  struct Mix {
    std::uint32_t a, b;
    double along;
  };
  template <class Columns>
  void append_to(Columns& columns) {
    columns.conservativeResize(columns.rows(), before_ + static_cast<Eigen::Index>(more_.size()));
    for (std::size_t at = 0; at < more_.size(); ++at) {
      const auto along = static_cast<typename Columns::Scalar>(more_[at].along);
      columns.col(before_ + static_cast<Eigen::Index>(at)) =
          (1 - along) * columns.col(more_[at].a) + along * columns.col(more_[at].b);
    }
  }

  Mesh& mesh_;
  Eigen::Index before_;
  std::vector<Mix> more_;
};

} // namespace

SplitJunctions split_at_junctions(Mesh& mesh, std::vector<std::uint32_t>& place_of,
                                  double tolerance) {
  const auto found = junctions_of(mesh, place_of, tolerance);
  if (!found) return {.count = 0, .is_too_many = true};
  const Junctions& junctions = *found;
  if (junctions.empty()) return {};
  const Mesh before = mesh;
  const std::vector<std::uint32_t> places = std::move(place_of);
  place_of.clear();
  mesh.face_corners.clear();
  mesh.corner_texcoords.clear();
  MixedTexcoords texcoords(mesh);
  std::size_t added = 0;
  const auto put = [&](std::uint32_t vertex, std::uint32_t place) {
    mesh.face_corners.push_back(vertex);
    place_of.push_back(place);
  };
  for (std::size_t face = 0; face < before.face_count(); ++face) {
    const std::uint32_t begin = before.face_starts[face], end = before.face_starts[face + 1];
    for (std::uint32_t at = begin; at < end; ++at) {
      const std::uint32_t next = at + 1 < end ? at + 1 : begin;
      put(before.face_corners[at], places[at]);
      if (!before.corner_texcoords.empty())
        mesh.corner_texcoords.push_back(before.corner_texcoords[at]);
      const auto here = junctions.find(at);
      if (here == junctions.end()) continue;
      for (const JunctionPoint& point : here->second) {
        put(point.place, point.place);
        ++added;
        if (before.corner_texcoords.empty()) continue;
        mesh.corner_texcoords.push_back(texcoords.between(
            before.corner_texcoords[at], before.corner_texcoords[next], point.along));
      }
    }
    mesh.face_starts[face + 1] = to_index(mesh.face_corners.size());
  }
  texcoords.finish();
  return {.count = added};
}

} // namespace nendo::deform
