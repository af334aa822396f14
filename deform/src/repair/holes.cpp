// Fills the holes of a mesh.

#include "repair/steps.hpp"

#include <algorithm>
#include <set>

#include <nendo/deform/offset.hpp>
#include <nendo/deform/triangles.hpp>

#include "cut/blade.hpp"
#include "cut/cut_assembly.hpp"
#include "cut/cut_cap.hpp"
#include "geometry/space.hpp"
#include "join/self_intersections.hpp"
#include "mesh/columns.hpp"
#include "mesh/surface_mesh.hpp"

namespace nendo::deform {
namespace {

/// The most corners of a rim that min_area_lid() closes: its time grows with their cube.
inline constexpr std::size_t max_crooked_rim = 600;

/// Returns triangles of the rim's corners, in its direction, whose areas have the least sum (G.
/// Barequet and M. Sharir, Filling gaps in the boundary of a polyhedron, 1995); none if there is no
/// way. `may_join(a, b)` returns whether an inner edge may lead from one corner to another.
/// Allocates.
template <class MayJoin>
std::vector<Corners> min_area_lid(std::span<const SpacePoint> rim, const MayJoin& may_join) {
  constexpr double never = 1e300;
  const std::size_t count = rim.size();
  if (count < 3 || count > max_crooked_rim) return {};
  std::vector<double> area(count * count, 0.0);
  std::vector<std::uint32_t> apex(count * count, 0);
  for (std::size_t span = 2; span < count; ++span)
    for (std::size_t from = 0; from + span < count; ++from) {
      const std::size_t to = from + span;
      double least = never;
      const bool is_inner = !(from == 0 && to + 1 == count);
      if (!is_inner || may_join(from, to))
        for (std::size_t at = from + 1; at < to; ++at) {
          const double sum = area[from * count + at] + area[at * count + to] +
                             length_of(cross(rim[at] - rim[from], rim[to] - rim[from]));
          if (!(sum < least)) continue;
          least = sum;
          apex[from * count + to] = static_cast<std::uint32_t>(at);
        }
      area[from * count + to] = least;
    }
  if (!(area[count - 1] < never)) return {};
  std::vector<Corners> lid;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open{
      {0, static_cast<std::uint32_t>(count - 1)}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    if (to - from < 2) continue;
    const std::uint32_t at = apex[from * count + to];
    lid.push_back({from, at, to});
    open.emplace_back(from, at);
    open.emplace_back(at, to);
  }
  return lid;
}

/// Corners of the mesh, in the order that the lid's faces need.
using Rim = std::vector<std::uint32_t>;

/// What was done to one part of the mesh.
struct PartHoles {
  std::size_t count = 0, crossing = 0;
  UnfilledPart open{no_index, {}, {}}; ///< its vertex is no_index if the part does not stay open
};

SpacePoint area_of_rim(const std::vector<SpacePoint>& points) {
  SpacePoint area{};
  for (std::size_t k = 1; k + 1 < points.size(); ++k)
    area = area + cross(points[k] - points[0], points[k + 1] - points[0]);
  return area;
}

class HoleFiller {
public:
  explicit HoleFiller(Mesh& mesh) : mesh_(mesh) {}

  Result<FilledHoles> run() {
    const auto found = rims();
    if (!found) return found.error();
    if (found->empty()) return FilledHoles{};
    parts_.resize(number_parts(mesh_, part_of_));
    find_sheets(*found);
    std::vector<std::uint8_t> at_rim(mesh_.vertex_count(), 0);
    for (const Rim& rim : *found)
      for (const std::uint32_t corner : rim)
        at_rim[mesh_.face_corners[corner]] = 1;
    for_each_face_edge(mesh_.face_starts, [&](auto, std::uint32_t at, std::uint32_t next) {
      if (at_rim[mesh_.face_corners[at]] != 0 && at_rim[mesh_.face_corners[next]] != 0)
        edges_.insert(std::minmax(mesh_.face_corners[at], mesh_.face_corners[next]));
    });
    for (const Rim& rim : *found)
      fill(rim);
    return sum();
  }

private:
  /// Each open edge ends where the next one of the rim begins: it is found by turning about the
  /// vertex.
  Result<std::vector<Rim>> rims() const {
    const HalfEdges edges =
        half_edges_of(mesh_.face_starts, mesh_.face_corners, mesh_.vertex_count());
    std::vector<std::uint8_t> done(mesh_.face_corners.size(), 0);
    std::vector<Rim> rims;
    for (std::uint32_t first = 0; first < done.size(); ++first) {
      if (edges.twin[first] != no_index || done[first] != 0) continue;
      Rim rim;
      std::uint32_t edge = first;
      while (done[edge] == 0) {
        done[edge] = 1;
        rim.push_back(edges.next[edge]);
        std::uint32_t before = edges.last[edge];
        for (std::size_t turned = 0; edges.twin[before] != no_index; ++turned) {
          if (turned > done.size()) break;
          before = edges.last[edges.twin[before]];
        }
        edge = before;
      }
      if (edge != first)
        return Error{Errc::bad_input, "cannot be repaired: holes touch at " +
                                          place_text(mesh_, mesh_.face_corners[edge])};
      rims.push_back(std::move(rim));
    }
    return rims;
  }
  /// A lid that is as large as the surface itself closes a sheet, not a body.
  void find_sheets(const std::vector<Rim>& rims) {
    constexpr double max_lid_share = 0.9;
    std::vector<double> surface(parts_.size(), 0.0), lids(parts_.size(), 0.0);
    for_each_face_triangle(mesh_, [&](std::size_t, const Triangle& of) {
      surface[part_of_[mesh_.face_corners[of[0]]]] +=
          length_of(cross(point(of[1]) - point(of[0]), point(of[2]) - point(of[0])));
    });
    for (const Rim& rim : rims)
      lids[part_of_[mesh_.face_corners[rim[0]]]] += length_of(area_of_rim(points_of(rim)));
    for (const Rim& rim : rims) {
      const std::uint32_t part = part_of_[mesh_.face_corners[rim[0]]];
      if (lids[part] > max_lid_share * surface[part] && parts_[part].open.vertex == no_index)
        stays_open(rim[0], "is a sheet without an inside, and to close it would only double it",
                   "give it a thickness where it was made");
    }
  }
  void fill(const Rim& rim) {
    PartHoles& part = part_at(rim[0]);
    if (part.open.vertex != no_index) return;
    const auto is_sound = [&](const std::vector<Corners>& lid) {
      return !lid.empty() && !has_known_edges(rim, lid);
    };
    std::vector<Corners> lid = flat_lid(rim);
    if (!is_sound(lid) || goes_through(rim, lid)) {
      std::vector<Corners> other = crooked_lid(rim);
      const bool is_good = is_sound(other) && !goes_through(rim, other);
      if (!is_good) ++part.crossing;
      if (is_good || !is_sound(lid)) lid = std::move(other);
    }
    if (!is_sound(lid))
      return stays_open(rim[0],
                        "has a hole of " + std::to_string(rim.size()) +
                            " edges that is too crooked to be filled by triangles between its "
                            "corners",
                        "close it where the model was made");
    add(rim, lid);
    ++part.count;
  }
  FilledHoles sum() const {
    FilledHoles all;
    for (const PartHoles& part : parts_) {
      all.count += part.count;
      all.crossing += part.crossing;
      if (part.open.vertex != no_index) all.unfilled.push_back(part.open);
    }
    return all;
  }
  std::vector<Corners> flat_lid(const Rim& rim) const {
    const std::vector<SpacePoint> points = points_of(rim);
    const SpacePoint area = area_of_rim(points);
    if (!(length_of(area) > 0.0)) return {};
    const PlaneBlade plane(points[0], area);
    CapLoop loop;
    for (std::uint32_t k = 0; k < points.size(); ++k) {
      loop.crossings.push_back(k);
      loop.places.push_back(plane.chart(points[k]));
    }
    Cap cap = make_cap({&loop, 1}, to_index(rim.size()), {});
    if (cap.fault != PlaneFault::none) return {};
    // Rims of four corners and more need an edge inside that is not there yet.
    if (cap.triangles.size() + 2 != rim.size()) return {};
    return std::move(cap.triangles);
  }
  std::vector<Corners> crooked_lid(const Rim& rim) const {
    return min_area_lid(points_of(rim), [&](std::size_t a, std::size_t b) {
      return mesh_.face_corners[rim[a]] != mesh_.face_corners[rim[b]] && !has_edge(rim[a], rim[b]);
    });
  }
  bool has_known_edges(const Rim& rim, const std::vector<Corners>& lid) const {
    for (const Corners& triangle : lid)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
        const std::size_t apart = a < b ? b - a : a - b;
        if (apart != 1 && apart + 1 != rim.size() && has_edge(rim[a], rim[b])) return true;
      }
    return false;
  }
  /// Of many holes in a large model, only the first ones are looked at: each takes all faces.
  bool goes_through(const Rim& rim, const std::vector<Corners>& lid) {
    constexpr std::size_t max_looks = 100'000'000; // faces
    looks_ += mesh_.face_count();
    if (looks_ > max_looks) return false;
    const std::vector<SpacePoint> points = space_points(mesh_.vertices);
    std::vector<Corners> triangles;
    for_each_triangle(mesh_, [&](const Triangle& triangle) { triangles.push_back(triangle); });
    std::vector<std::uint32_t> changed;
    for (const Corners& triangle : lid) {
      changed.push_back(to_index(triangles.size()));
      triangles.push_back({mesh_.face_corners[rim[triangle[0]]],
                           mesh_.face_corners[rim[triangle[1]]],
                           mesh_.face_corners[rim[triangle[2]]]});
    }
    return !self_intersections_of(points, triangles, changed, 1).empty();
  }
  void add(const Rim& rim, const std::vector<Corners>& lid) {
    const auto like = static_cast<std::size_t>(std::upper_bound(mesh_.face_starts.begin(),
                                                                mesh_.face_starts.end(), rim[0]) -
                                               mesh_.face_starts.begin()) -
                      1;
    for (const Corners& triangle : lid) {
      for (const std::uint32_t k : triangle)
        for (auto* column : {&mesh_.face_corners, &mesh_.corner_texcoords})
          if (!column->empty()) column->push_back(std::uint32_t{(*column)[rim[k]]});
      mesh_.face_starts.push_back(to_index(mesh_.face_corners.size()));
      for (auto* column : face_columns(mesh_.look))
        if (!column->empty()) column->push_back(std::uint32_t{(*column)[like]});
      for (std::size_t k = 0; k < 3; ++k)
        edges_.insert(std::minmax(mesh_.face_corners[rim[triangle[k]]],
                                  mesh_.face_corners[rim[triangle[(k + 1) % 3]]]));
    }
  }
  SpacePoint point(std::uint32_t corner) const noexcept {
    return space_point(mesh_.vertices, mesh_.face_corners[corner]);
  }
  std::vector<SpacePoint> points_of(const Rim& rim) const {
    std::vector<SpacePoint> points;
    for (const std::uint32_t corner : rim)
      points.push_back(point(corner));
    return points;
  }
  PartHoles& part_at(std::uint32_t corner) { return parts_[part_of_[mesh_.face_corners[corner]]]; }
  void stays_open(std::uint32_t corner, std::string why, std::string remedy) {
    part_at(corner) = {0, 0, {mesh_.face_corners[corner], std::move(why), std::move(remedy)}};
  }
  bool has_edge(std::uint32_t one, std::uint32_t other) const {
    return edges_.contains(std::minmax(mesh_.face_corners[one], mesh_.face_corners[other]));
  }

  Mesh& mesh_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges_; ///< pairs of vertices, at rims
  std::size_t looks_ = 0;
  std::vector<std::uint32_t> part_of_; ///< each vertex
  std::vector<PartHoles> parts_;
};

} // namespace

Result<FilledHoles> fill_holes(Mesh& mesh) {
  return HoleFiller(mesh).run();
}

} // namespace nendo::deform
