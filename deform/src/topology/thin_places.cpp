#include "topology/thin_places.hpp"

#include <algorithm>
#include <tuple>

#include "geometry/point_grid.hpp"

namespace nendo::deform {

namespace {

constexpr double max_of_loop = 3.0; // edges that three should be
/// How near two sheets must be, and how far from opposite their points may be, in edges.
struct Facing {
  double through_wall, through_air, aside;
  bool holds(double out, double off) const noexcept {
    return std::abs(out) < (out < 0.0 ? through_wall : through_air) && off < aside;
  }
};
/// Through air it is less than is between the ends of what has parted. What has begun continues to
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
        return surface.from(surface.last(surface.edge_between(from, to)));
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

} // namespace

std::vector<ThinPlace> thin_places(const ThinSurface& surface) {
  std::vector<ThinPlace> places;
  const std::uint32_t count = surface.point_count();
  if (count == 0) return places;
  std::vector<SpacePoint> normals = area_vectors(surface);
  Points points(3, static_cast<Eigen::Index>(count));
  double widest = 0.0;
  for (std::uint32_t at = 0; at < count; ++at) {
    normals[at] = unit_of(normals[at]);
    points.col(static_cast<Eigen::Index>(at)) << surface.point(at)[0], surface.point(at)[1],
        surface.point(at)[2];
    widest = std::max(widest, (goes_on.through_wall + goes_on.aside) * surface.wanted(at));
  }
  if (!(widest > 0.0)) return places;
  const PointGrid grid(points, widest);
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

} // namespace nendo::deform
