#include "repair/stitch.hpp"

#include <cmath>
#include <numbers>
#include <tuple>

#include "mesh/columns.hpp"

namespace nendo::deform {
namespace {

SpacePoint corner_point(const Mesh& mesh, std::uint32_t corner) noexcept {
  return space_point(mesh.vertices, mesh.face_corners[corner]);
}

/// The polygon's area vector.
SpacePoint face_area(const Mesh& mesh, std::uint32_t face) noexcept {
  const std::uint32_t begin = mesh.face_starts[face];
  SpacePoint sum{};
  for (std::uint32_t at = begin + 2; at < mesh.face_starts[face + 1]; ++at)
    sum = sum + cross(corner_point(mesh, at - 1) - corner_point(mesh, begin),
                      corner_point(mesh, at) - corner_point(mesh, begin));
  return sum;
}

/// More faces at one edge are no walls, and each would be compared with each.
constexpr std::size_t max_sides = 64;

class Stitcher {
public:
  Stitcher(const Mesh& mesh, std::span<const std::uint32_t> place_of,
           std::span<const std::uint32_t> element_of, UnionFind& sets)
      : mesh_(mesh), element_of_(element_of), sets_(sets), edges_(placed_edges(mesh, place_of)) {
    for (std::uint32_t face = 0; face < mesh.face_count(); ++face)
      normals_.push_back(unit_of(face_area(mesh, face)));
  }

  void run() {
    for_each_edge(edges_, [&](std::span<const PlacedEdge> sides) {
      if (sides.size() == 2 && !lie_on_each_other(sides[0], sides[1])) join(sides[0], sides[1]);
    });
    for_each_edge(edges_, [&](std::span<const PlacedEdge> sides) {
      if (sides.size() > 2 && sides.size() <= max_sides) pair({sides.begin(), sides.end()});
    });
  }

private:
  void join(const PlacedEdge& one, const PlacedEdge& other) {
    sets_.join(element_of_[one.at_low()], element_of_[other.at_low()]);
    sets_.join(element_of_[one.at_high()], element_of_[other.at_high()]);
  }
  bool are_joined(const PlacedEdge& one, const PlacedEdge& other) {
    return one.forward != other.forward &&
           sets_.find(element_of_[one.at_low()]) == sets_.find(element_of_[other.at_low()]) &&
           sets_.find(element_of_[one.at_high()]) == sets_.find(element_of_[other.at_high()]);
  }
  /// Into the face, square to the edge.
  SpacePoint inwards(const PlacedEdge& side, const SpacePoint& axis) const noexcept {
    return cross(normals_[side.face], side.forward ? axis : -1.0 * axis);
  }
  SpacePoint along(const PlacedEdge& side) const noexcept {
    return unit_of(corner_point(mesh_, side.at_high()) - corner_point(mesh_, side.at_low()));
  }
  /// Back to back, as both sides of a leaf are: such faces have nothing between them.
  bool lie_on_each_other(const PlacedEdge& one, const PlacedEdge& other) const noexcept {
    const SpacePoint way = along(one);
    return one.forward != other.forward &&
           dot(inwards(one, way), inwards(other, way)) > 1.0 - 1e-12;
  }
  /// Going round counter-clockwise, a face that goes back is followed by inside, and one that goes
  /// forward by outside. So they are paired like brackets.
  void pair(std::vector<PlacedEdge> sides) {
    for (std::size_t one = 0; one < sides.size(); ++one)
      for (std::size_t other = one + 1; other < sides.size(); ++other)
        if (are_joined(sides[one], sides[other])) {
          sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(other));
          sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(one));
          --one;
          break;
        }
    if (sides.size() < 2) return;
    if (sides.size() == 2) return join(sides[0], sides[1]);
    // Twice round, because the first bracket may close one that opens last.
    const std::vector<PlacedEdge> sorted = by_angle(sides);
    std::vector<std::size_t> open;
    std::vector<std::uint8_t> paired(sorted.size(), 0);
    for (std::size_t step = 0; step < 2 * sorted.size(); ++step) {
      const std::size_t at = step % sorted.size();
      if (paired[at] != 0) continue;
      if (!sorted[at].forward) {
        if (step < sorted.size()) open.push_back(at);
        continue;
      }
      if (open.empty()) continue;
      join(sorted[open.back()], sorted[at]);
      paired[open.back()] = paired[at] = 1;
      open.pop_back();
    }
  }
  /// Counter-clockwise about the edge, seen against it, from the widest gap on. Where faces lie on
  /// each other, those that go forward come first: nothing is between them and those that go back.
  std::vector<PlacedEdge> by_angle(const std::vector<PlacedEdge>& sides) const {
    constexpr double same_angle = 1e-7;
    const SpacePoint axis = along(sides[0]);
    const SpacePoint right = square_to(axis);
    const SpacePoint up = cross(axis, right);
    std::vector<std::pair<double, std::size_t>> angles;
    for (std::size_t at = 0; at < sides.size(); ++at) {
      const SpacePoint way = inwards(sides[at], axis);
      angles.emplace_back(std::atan2(dot(way, up), dot(way, right)), at);
    }
    std::sort(angles.begin(), angles.end());
    const auto gap_before = [&](std::size_t at) {
      return at > 0 ? angles[at].first - angles[at - 1].first
                    : angles[0].first - angles.back().first + 2.0 * std::numbers::pi;
    };
    std::size_t first = 0;
    for (std::size_t at = 1; at < angles.size(); ++at)
      if (gap_before(at) > gap_before(first)) first = at;
    std::vector<PlacedEdge> sorted;
    std::size_t run = 0; // where the faces of one angle begin
    for (std::size_t step = 0; step < angles.size(); ++step) {
      const std::size_t at = (first + step) % angles.size();
      if (step > 0 && gap_before(at) > same_angle) run = sorted.size();
      sorted.push_back(sides[angles[at].second]);
      std::stable_partition(sorted.begin() + static_cast<std::ptrdiff_t>(run), sorted.end(),
                            [](const PlacedEdge& side) { return side.forward; });
    }
    return sorted;
  }

  const Mesh& mesh_;
  std::span<const std::uint32_t> element_of_;
  UnionFind& sets_;
  std::vector<PlacedEdge> edges_;
  std::vector<SpacePoint> normals_; ///< one per face
};

} // namespace

std::vector<std::uint32_t> exact_places(const Points& points) {
  return first_alike(static_cast<std::size_t>(points.cols()), [&](std::uint32_t at) {
    const double* const of = points.data() + 3 * std::size_t{at};
    return std::tuple(of[0] + 0.0, of[1] + 0.0, of[2] + 0.0);
  });
}

std::vector<PlacedEdge> placed_edges(const Mesh& mesh, std::span<const std::uint32_t> place_of) {
  std::vector<PlacedEdge> edges;
  edges.reserve(mesh.face_corners.size());
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t begin = mesh.face_starts[face], end = mesh.face_starts[face + 1];
    if (!has_three(place_of.subspan(begin, end - begin))) continue;
    for (std::uint32_t at = begin; at < end; ++at) {
      const std::uint32_t next = at + 1 < end ? at + 1 : begin;
      const std::uint32_t from = place_of[at], to = place_of[next];
      if (from != to)
        edges.push_back({std::min(from, to), std::max(from, to), at, next, face, from < to});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

void stitch(const Mesh& mesh, std::span<const std::uint32_t> place_of,
            std::span<const std::uint32_t> element_of, UnionFind& sets) {
  Stitcher(mesh, place_of, element_of, sets).run();
}

} // namespace nendo::deform
