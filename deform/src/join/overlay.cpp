#include "join/overlay.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/constrained_triangulation.hpp"
#include "geometry/rows_by_key.hpp"
#include "geometry/union_find.hpp"
#include "join/crossings.hpp"
#include "join/triangle_surface.hpp"
#include "mesh/surface_mesh.hpp"

namespace nendo::deform {
namespace {

/// The crossings on a part's edges, in the order of edges and then along them.
class EdgeCrossings {
public:
  EdgeCrossings(std::uint32_t part, const Crossings& crossings) : all_(crossings.points) {
    for (std::uint32_t at = 0; at < all_.size(); ++at)
      if (all_[at].part == part) sorted_.push_back(at);
    std::sort(sorted_.begin(), sorted_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(ends_of(a), all_[a].along) < std::pair(ends_of(b), all_[b].along);
    });
  }
  /// Of the edge, from `from` to `to`.
  void append(std::uint32_t from, std::uint32_t to, std::vector<std::uint32_t>& list) const {
    const std::pair<std::uint32_t, std::uint32_t> ends = std::minmax(from, to);
    auto first = std::lower_bound(
        sorted_.begin(), sorted_.end(), ends,
        [&](std::uint32_t at, const auto& wanted) { return ends_of(at) < wanted; });
    const std::size_t before = list.size();
    for (; first != sorted_.end() && ends_of(*first) == ends; ++first)
      list.push_back(*first);
    if (from > to) std::reverse(list.begin() + static_cast<std::ptrdiff_t>(before), list.end());
  }

private:
  std::pair<std::uint32_t, std::uint32_t> ends_of(std::uint32_t at) const {
    return {all_[at].from, all_[at].to};
  }
  const std::vector<Crossing>& all_;
  std::vector<std::uint32_t> sorted_;
};

/// One face: its corners and crossings in a plane, seen along the axis that it faces the most.
class FaceCutter {
public:
  FaceCutter(const CrossedPart& part, std::uint32_t number, const Crossings& crossings)
      : part_(part), crossings_(crossings), on_edges_(number, crossings) {}

  /// Appends the pieces of the face. `segments` are the crossing segments in it.
  bool cut(std::uint32_t face, std::span<const std::uint32_t> segments, PartPieces& pieces) {
    look_at(face);
    const Corners& corners = part_.faces[face];
    for (std::size_t k = 0; k < 3; ++k) {
      rim_.push_back(corners[k]);
      on_edge_.clear();
      on_edges_.append(corners[k], corners[(k + 1) % 3], on_edge_);
      for (const std::uint32_t crossing : on_edge_)
        rim_.push_back(base() + crossing);
    }
    numbers_ = rim_;
    for (const std::uint32_t at : segments)
      for (const std::uint32_t end : crossings_.segments[at].ends)
        numbers_.push_back(base() + end);
    // Crossings inside of the face are ends of several segments; those on its rim are in rim_.
    const auto inner = numbers_.begin() + static_cast<std::ptrdiff_t>(rim_.size());
    std::sort(inner, numbers_.end());
    const auto is_on_rim = [&](std::uint32_t number) {
      return std::find(rim_.begin(), rim_.end(), number) != rim_.end();
    };
    numbers_.erase(std::remove_if(inner, std::unique(inner, numbers_.end()), is_on_rim),
                   numbers_.end());
    return triangulate(face, segments, pieces);
  }

private:
  std::uint32_t base() const { return to_index(part_.points.size()); }
  const SpacePoint& place_of(std::uint32_t number) const {
    return number < base() ? part_.points[number] : crossings_.points[number - base()].place;
  }
  PlanePoint flat(std::uint32_t number) const {
    const SpacePoint& place = place_of(number);
    return {place[x_], place[y_]};
  }
  void look_at(std::uint32_t face) {
    rim_.clear();
    const Corners& corner = part_.faces[face];
    const SpacePoint normal =
        area_vector(part_.points[corner[0]], part_.points[corner[1]], part_.points[corner[2]]);
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    x_ = (axis + 1) % 3;
    y_ = (axis + 2) % 3;
    if (normal[axis] < 0.0) std::swap(x_, y_);
  }
  std::uint32_t local(std::uint32_t number) const {
    return static_cast<std::uint32_t>(std::find(numbers_.begin(), numbers_.end(), number) -
                                      numbers_.begin());
  }
  bool triangulate(std::uint32_t face, std::span<const std::uint32_t> segments,
                   PartPieces& pieces) {
    PlanePoint low = flat(numbers_[0]);
    PlanePoint high = low;
    for (const std::uint32_t number : numbers_)
      for (std::size_t k = 0; k < 2; ++k) {
        low[k] = std::min(low[k], flat(number)[k]);
        high[k] = std::max(high[k], flat(number)[k]);
      }
    ConstrainedTriangulation plane(low, high);
    plane.reserve(numbers_.size());
    for (const std::uint32_t number : numbers_)
      if (plane.add(flat(number)) != PlaneFault::none) return false;
    const auto rim_size = to_index(rim_.size());
    for (std::uint32_t at = 0; at < rim_size; ++at)
      if (plane.constrain(at, (at + 1) % rim_size) != PlaneFault::none) return false;
    for (const std::uint32_t at : segments) {
      const auto& ends = crossings_.segments[at].ends;
      const std::uint32_t from = local(base() + ends[0]);
      const std::uint32_t to = local(base() + ends[1]);
      if (plane.constrain(from, to) != PlaneFault::none) return false;
    }
    plane.improve();
    const auto triangles = plane.triangles(PlaneFill::enclosed);
    for (const auto& triangle : triangles) {
      pieces.faces.push_back({numbers_[triangle[0]], numbers_[triangle[1]], numbers_[triangle[2]]});
      pieces.from.push_back(face);
    }
    return !triangles.empty();
  }

  const CrossedPart& part_;
  const Crossings& crossings_;
  EdgeCrossings on_edges_;
  std::size_t x_ = 0, y_ = 1;
  std::vector<std::uint32_t> rim_, on_edge_, numbers_;
};

/// Returns false if some face cannot be triangulated: crossings coincide, or segments cross each
/// other, after rounding.
bool cut_faces(const CrossedPart& part, std::uint32_t number, const Crossings& crossings,
               PartPieces& pieces) {
  pieces = {};
  const auto segments = rows_by_key<std::uint32_t>(part.faces.size(), [&](const auto& visit) {
    for (std::uint32_t at = 0; at < crossings.segments.size(); ++at)
      visit(crossings.segments[at].faces[number], at);
  });
  std::vector<std::uint32_t> crossed;
  for (std::uint32_t face = 0; face < part.faces.size(); ++face) {
    if (!segments[face].empty()) {
      crossed.push_back(face);
      continue;
    }
    pieces.faces.push_back(part.faces[face]);
    pieces.from.push_back(face);
  }
  pieces.whole = pieces.faces.size();
  FaceCutter cutter(part, number, crossings);
  return std::all_of(crossed.begin(), crossed.end(),
                     [&](std::uint32_t face) { return cutter.cut(face, segments[face], pieces); });
}

/// Displacements of the second surface: odd directions, one per attempt.
constexpr std::array<SpacePoint, max_overlay_attempts> overlay_displacements{
    {{0.6137, -0.4219, 0.6673},
     {-0.3571, 0.7919, 0.4951},
     {0.2347, 0.5813, -0.7793},
     {-0.8363, -0.2917, 0.4643},
     {0.4733, -0.8123, -0.3407},
     {-0.5591, 0.1873, -0.8077},
     {0.8911, 0.3671, 0.2663},
     {-0.1319, -0.6841, -0.7177}}};
constexpr double displacement_part = 1e-7;

double size_of(std::span<const SpacePoint> points) {
  SpaceBox box{points[0], points[0]};
  for (const SpacePoint& point : points)
    widen(box, {point, point});
  return distance_between(box.low, box.high);
}

class OverlayMaker {
public:
  OverlayMaker(const TriangleSurface& first, const TriangleSurface& second, Overlay& result)
      : first_(first), second_(second), result_(result), first_tree_(first.points, first.faces) {}

  bool attempt(const SpacePoint& displacement) {
    result_.second_points = second_.points;
    for (SpacePoint& point : result_.second_points)
      point = point + displacement;
    const BoxTree second_tree(result_.second_points, second_.faces);
    parts_ = {CrossedPart{first_.points, first_.faces, &first_tree_},
              CrossedPart{result_.second_points, second_.faces, &second_tree}};
    if (!find_crossings(parts_, result_.crossings)) return false;
    collect_seam();
    for (std::uint32_t part = 0; part < 2; ++part)
      if (!cut_faces(parts_[part], part, result_.crossings, result_.pieces[part]) ||
          !find_inside(part))
        return false;
    return true;
  }

private:
  void collect_seam() {
    seam_.clear();
    for (const CrossingSegment& segment : result_.crossings.segments)
      seam_.push_back(std::minmax(segment.ends[0], segment.ends[1]));
    std::sort(seam_.begin(), seam_.end());
  }
  const SpacePoint& place_of(std::uint32_t part, std::uint32_t number) const {
    const auto& points = parts_[part].points;
    return number < points.size() ? points[number]
                                  : result_.crossings.points[number - points.size()].place;
  }
  bool is_seam(std::uint32_t part, std::uint32_t from, std::uint32_t to) const {
    const auto base = static_cast<std::uint32_t>(parts_[part].points.size());
    if (from < base || to < base) return false;
    const std::pair<std::uint32_t, std::uint32_t> ends = std::minmax(from - base, to - base);
    return std::binary_search(seam_.begin(), seam_.end(), ends);
  }

  /// Says of each piece whether it is in the other part: patch by patch, by a ray from the patch's
  /// largest piece. Returns false if the pieces are not closed, or no ray can decide.
  bool find_inside(std::uint32_t part) {
    const std::vector<Corners>& faces = result_.pieces[part].faces;
    const std::size_t points = parts_[part].points.size() + result_.crossings.points.size();
    const SurfaceMesh mesh(faces, points);
    UnionFind patches(faces.size()); // between the crossings
    for (std::uint32_t edge = 0; edge < 3 * mesh.face_count(); ++edge) {
      const std::uint32_t twin = mesh.twin(edge);
      if (twin == no_index) return false;
      if (edge < twin && !is_seam(part, mesh.from(edge), mesh.to(edge)))
        patches.join(edge / 3, twin / 3);
    }
    std::vector<std::pair<double, std::uint32_t>> largest(faces.size(), {-1.0, 0});
    for (std::uint32_t face = 0; face < faces.size(); ++face) {
      const Corners& corner = faces[face];
      const SpacePoint area = area_vector(place_of(part, corner[0]), place_of(part, corner[1]),
                                          place_of(part, corner[2]));
      auto& best = largest[patches.find(face)];
      if (dot(area, area) > best.first) best = {dot(area, area), face};
    }
    std::vector<char> inside(faces.size());
    for (std::uint32_t face = 0; face < faces.size(); ++face) {
      if (patches.find(face) == face) {
        const int is_in = is_inside(middle_of(part, faces[largest[face].second]), parts_[1 - part]);
        if (is_in < 0) return false;
        inside[face] = static_cast<char>(is_in);
      } else {
        inside[face] = inside[patches.find(face)]; // the least face of a patch comes first
      }
    }
    result_.inside[part] = std::move(inside);
    return true;
  }
  SpacePoint middle_of(std::uint32_t part, const Corners& corner) const {
    return (1.0 / 3.0) *
           (place_of(part, corner[0]) + place_of(part, corner[1]) + place_of(part, corner[2]));
  }

  const TriangleSurface& first_;
  const TriangleSurface& second_;
  Overlay& result_;
  BoxTree first_tree_;
  std::array<CrossedPart, 2> parts_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> seam_;
};

} // namespace

Result<Overlay> overlay(const TriangleSurface& first, const TriangleSurface& second,
                        int first_attempt) {
  Overlay result;
  const double sizes[2] = {size_of(first.points), size_of(second.points)};
  // Small enough for the smaller part, and large enough for the larger one's rounding.
  const double size = std::max(std::min(sizes[0], sizes[1]), 1e-6 * std::max(sizes[0], sizes[1]));
  OverlayMaker maker(first, second, result);
  for (int attempt = first_attempt; attempt < max_overlay_attempts; ++attempt) {
    result.attempts = attempt + 1;
    const auto way = static_cast<std::size_t>(attempt);
    if (maker.attempt(std::ldexp(displacement_part * size, attempt) * overlay_displacements[way]))
      return result;
  }
  return Error{Errc::failed, "no position was found in which the parts cross clearly; move one of "
                             "them a little"};
}

} // namespace nendo::deform
