#include <nendo/deform/topology.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include <nendo/deform/refinement.hpp>

#include "geometry/point_grid.hpp"
#include "join/mesh_surface.hpp"
#include "join/self_intersections.hpp"
#include "mesh/columns.hpp"
#include "topology/thin_surface.hpp"

namespace nendo::deform {
namespace {

/// Three points whose edges bound no face, or two whose sheets are near each other.
struct ThinPlace {
  enum class Kind : std::uint8_t { neck, wall, gap };
  Kind kind = Kind::neck;
  Triple points{};    ///< the third is the second again where there are two
  double size = 0.0;  ///< in edges
  bool begins = true; ///< a change; else it only belongs to one that a thinner place begins
};

constexpr double max_of_loop = 3.0; // edges that three should be
/// How near two sheets must be, and how far from opposite their points may be, in edges.
struct Facing {
  double through_wall, through_air, aside;
  bool holds(double out, double off) const noexcept {
    return std::abs(out) < (out < 0.0 ? through_wall : through_air) && off < aside;
  }
};
/// Through air the limit is below the gap between the ends of a parted neck. A change continues to
/// where a wall is as thick as an edge: there its rim has good triangles.
constexpr Facing begins{0.7, 0.15, 0.6};
constexpr Facing goes_on{1.1, 0.2, 0.9};
constexpr double opposed = -0.7; // cosine of the angle between two sheets' normals

void add_necks(const ThinSurface& surface, std::uint32_t a, std::vector<ThinPlace>& places) {
  const std::vector<std::uint32_t> around = surface.ring(a);
  for (const std::uint32_t b : around) {
    if (b < a) continue;
    for (const std::uint32_t c : around) {
      if (c < b || !surface.are_neighbours(b, c)) continue;
      const auto opposite = [&](std::uint32_t from, std::uint32_t to) {
        return surface.from(ThinSurface::last(surface.edge_between(from, to)));
      };
      if (opposite(a, b) == c || opposite(b, a) == c) continue;
      const double length = distance_between(surface.point(a), surface.point(b)) +
                            distance_between(surface.point(b), surface.point(c)) +
                            distance_between(surface.point(c), surface.point(a));
      const double wanted = (surface.wanted(a) + surface.wanted(b) + surface.wanted(c)) / 3.0;
      const double size = length / wanted;
      if (size < max_of_loop) places.push_back({ThinPlace::Kind::neck, {a, b, c}, size});
    }
  }
}

void add_sheets(const ThinSurface& surface, std::uint32_t a, const PointGrid& grid,
                const std::vector<SpacePoint>& normals, std::vector<ThinPlace>& places) {
  const SpacePoint& here = surface.point(a);
  const Eigen::Vector3d place(here[0], here[1], here[2]);
  grid.visit_near(place, place, (goes_on.through_wall + goes_on.aside) * surface.wanted(a),
                  [&](std::uint32_t b) {
                    if (b <= a || dot(normals[a], normals[b]) > opposed) return;
                    const SpacePoint way = surface.point(b) - here;
                    const SpacePoint across = unit_of(normals[a] - normals[b]);
                    const double out = dot(way, across);
                    const double wanted = std::min(surface.wanted(a), surface.wanted(b));
                    const double off = length_of(way - out * across) / wanted;
                    if (!goes_on.holds(out / wanted, off)) return;
                    if (surface.are_neighbours(a, b)) return;
                    places.push_back({out < 0.0 ? ThinPlace::Kind::wall : ThinPlace::Kind::gap,
                                      {a, b, b},
                                      length_of(way) / wanted,
                                      begins.holds(out / wanted, off)});
                  });
}

/// Of each point, twice the area vector of the faces around.
std::vector<SpacePoint> area_vectors(const ThinSurface& surface) {
  std::vector<SpacePoint> sums(surface.point_count());
  for (std::uint32_t face = 0; face < surface.face_count(); ++face) {
    const Corners& corners = surface.corners(face);
    const SpacePoint area = area_vector(surface.point(corners[0]), surface.point(corners[1]),
                                        surface.point(corners[2]));
    for (const std::uint32_t corner : corners)
      sums[corner] = sums[corner] + area;
  }
  return sums;
}

/// Returns them, the thinnest first. Allocates.
std::vector<ThinPlace> thin_places(const ThinSurface& surface) {
  std::vector<ThinPlace> places;
  const std::uint32_t count = surface.point_count();
  std::vector<SpacePoint> normals = area_vectors(surface);
  double widest = 0.0;
  for (std::uint32_t at = 0; at < count; ++at) {
    normals[at] = unit_of(normals[at]);
    widest = std::max(widest, (goes_on.through_wall + goes_on.aside) * surface.wanted(at));
  }
  if (!(widest > 0.0)) return places;
  const PointGrid grid(points_of(surface.points()), widest);
  for (std::uint32_t at = 0; at < count; ++at) {
    if (dot(normals[at], normals[at]) == 0.0) continue;
    add_necks(surface, at, places);
    add_sheets(surface, at, grid, normals, places);
  }
  std::sort(places.begin(), places.end(), [](const ThinPlace& one, const ThinPlace& other) {
    return std::tie(one.size, one.points) < std::tie(other.size, other.points);
  });
  return places;
}

/// Where faces met, nothing is done in the next attempt.
constexpr int max_tries = 5;
/// Walls that are thin in many places get one hole after the other, and not all at once: so far
/// apart, in edges.
constexpr double between_holes = 8.0;
constexpr std::size_t max_of_patch = 4096; // points

/// A hole that there was, or a bridge, becomes wider where there was one patch.
void count(ThinPlace::Kind kind, int patches, TopologyCounts& counts) noexcept {
  if (kind == ThinPlace::Kind::neck)
    ++counts.parted;
  else if (patches == 1)
    ++counts.widened;
  else
    ++(kind == ThinPlace::Kind::wall ? counts.holes : counts.fused);
}

/// What was tried at once, from the thinnest place on.
class TopologyAttempt {
public:
  TopologyAttempt(ThinSurface surface, const std::vector<ThinPlace>& places,
                  const std::set<Triple>& left_alone)
      : surface_(std::move(surface)) {
    for (const ThinPlace& place : places)
      if (place.kind != ThinPlace::Kind::neck)
        facing_[place.kind == ThinPlace::Kind::wall ? 0 : 1].insert(place.points.begin(),
                                                                    place.points.end());
    for (const ThinPlace& place : places)
      if (place.begins && !left_alone.contains(place.points) && !is_touched(place)) change(place);
    kept = surface_.take(numbers_);
  }

  /// Returns the places of which some face meets another now.
  std::set<Triple> meeting() const {
    std::map<std::uint32_t, Triple> of_face;
    std::vector<std::uint32_t> changed;
    for (const auto& [face, place] : changed_) {
      const std::uint32_t number = numbers_.faces[face];
      if (number == no_index) continue;
      of_face[number] = place;
      changed.push_back(number);
    }
    std::set<Triple> places;
    for (const auto& [one, other] : self_intersections_of(kept.points, kept.faces, changed))
      for (const std::uint32_t face : {one, other})
        if (const auto found = of_face.find(face); found != of_face.end())
          places.insert(found->second);
    return places;
  }

  TriangleSurface kept;
  TopologyCounts counts;

private:
  /// By something before; and holes are not made near each other.
  bool is_touched(const ThinPlace& place) const {
    if (std::any_of(place.points.begin(), place.points.end(), [this](std::uint32_t point) {
          return touched_.contains(point) || surface_.ring(point).empty();
        }))
      return true;
    if (place.kind == ThinPlace::Kind::neck) return false;
    const std::uint32_t at = place.points[0];
    return std::any_of(joined_.begin(), joined_.end(), [&](const SpacePoint& other) {
      return distance_between(surface_.point(at), other) < between_holes * surface_.wanted(at);
    });
  }
  void change(const ThinPlace& place) {
    const bool is_neck = place.kind == ThinPlace::Kind::neck;
    std::vector<std::uint32_t> points(place.points.begin(), place.points.end());
    if (!is_neck) points = patches_of(place);
    std::set<std::uint32_t> around(points.begin(), points.end());
    for (const std::uint32_t point : points) {
      const std::vector<std::uint32_t> ring = surface_.ring(point);
      around.insert(ring.begin(), ring.end());
    }
    const SpacePoint at = surface_.point(place.points[0]);
    const int patches = is_neck ? 0 : surface_.join_rims(points);
    if (is_neck ? !surface_.part(place.points) : patches == 0) return;
    count(place.kind, patches, counts);
    if (!is_neck) joined_.push_back(at);
    touched_.insert(around.begin(), around.end());
    for (const std::uint32_t face : surface_.take_changed())
      changed_.emplace_back(face, place.points);
  }
  std::vector<std::uint32_t> patches_of(const ThinPlace& place) const {
    const auto& facing = facing_[place.kind == ThinPlace::Kind::wall ? 0 : 1];
    std::set<std::uint32_t> both;
    for (const std::uint32_t first : {place.points[0], place.points[1]}) {
      const std::vector<std::uint32_t> patch = patch_from(first, facing);
      both.insert(patch.begin(), patch.end());
    }
    return {both.begin(), both.end()};
  }
  /// Returns the points around one that face others.
  std::vector<std::uint32_t> patch_from(std::uint32_t first,
                                        const std::set<std::uint32_t>& facing) const {
    std::vector<std::uint32_t> patch{first};
    std::set<std::uint32_t> seen{first};
    const auto grow_by = [&](const auto& is_of_patch) {
      for (std::size_t at = 0; at < patch.size() && patch.size() < max_of_patch; ++at)
        for (const std::uint32_t neighbour : surface_.ring(patch[at]))
          if (is_of_patch(neighbour) && !touched_.contains(neighbour) &&
              seen.insert(neighbour).second)
            patch.push_back(neighbour);
    };
    grow_by([&](std::uint32_t point) { return facing.contains(point); });
    grow_by([&](std::uint32_t point) { return !seen.contains(point) && is_within(point, seen); });
    return patch;
  }
  /// Most of its neighbours are: islands in a patch belong to it.
  bool is_within(std::uint32_t point, const std::set<std::uint32_t>& patch) const {
    const std::vector<std::uint32_t> ring = surface_.ring(point);
    const auto in = std::count_if(ring.begin(), ring.end(), [&](std::uint32_t neighbour) {
      return patch.contains(neighbour);
    });
    return 3 * in >= 2 * static_cast<std::ptrdiff_t>(ring.size());
  }

  ThinSurface surface_;
  std::array<std::set<std::uint32_t>, 2> facing_; ///< points of thin walls, of gaps
  std::set<std::uint32_t> touched_;
  std::vector<SpacePoint> joined_;
  std::vector<std::pair<std::uint32_t, Triple>> changed_; ///< faces, and by which place
  Renumbering numbers_;
};

} // namespace

Result<ChangedTopology> change_topology(const Mesh& mesh) {
  if (const auto fine = Refiner::check(mesh); !fine) return fine.error();
  auto [surface, look] = single_surface_of(mesh);
  const ThinSurface before(std::move(surface));
  const std::vector<ThinPlace> places = thin_places(before);
  std::set<Triple> left_alone;
  for (int number = 0; number < max_tries; ++number) {
    TopologyAttempt attempt(before, places, left_alone);
    if (attempt.counts.all() == 0) break;
    const std::set<Triple> meeting = attempt.meeting();
    if (meeting.empty()) {
      ChangedTopology changed{mesh_of(attempt.kept, look), attempt.counts};
      changed.mesh.offset = mesh.offset;
      if (Refiner::check(changed.mesh)) return changed;
      break;
    }
    left_alone.insert(meeting.begin(), meeting.end());
  }
  return ChangedTopology{mesh, {}};
}

std::size_t count_thin_places(const Mesh& mesh) {
  if (!Refiner::check(mesh)) return 0;
  const std::vector<ThinPlace> places = thin_places(ThinSurface(single_surface_of(mesh).first));
  return static_cast<std::size_t>(std::count_if(
      places.begin(), places.end(), [](const ThinPlace& place) { return place.begins; }));
}

} // namespace nendo::deform
