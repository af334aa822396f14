#include "join/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/union_find.hpp"
#include "mesh/surface_mesh.hpp"

namespace nendo::deform {
namespace {

/// Ways in which the second surface gives way: odd directions, one for each attempt.
constexpr std::array<SpacePoint, max_overlay_attempts> give_ways{{{0.6137, -0.4219, 0.6673},
                                                                  {-0.3571, 0.7919, 0.4951},
                                                                  {0.2347, 0.5813, -0.7793},
                                                                  {-0.8363, -0.2917, 0.4643},
                                                                  {0.4733, -0.8123, -0.3407},
                                                                  {-0.5591, 0.1873, -0.8077},
                                                                  {0.8911, 0.3671, 0.2663},
                                                                  {-0.1319, -0.6841, -0.7177}}};
constexpr double give_part = 1e-7;

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

  bool attempt(const SpacePoint& give) {
    result_.second_points = second_.points;
    for (SpacePoint& point : result_.second_points)
      point = point + give;
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
  /// largest piece. Returns false if the pieces are not closed, or a ray cannot tell.
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
    if (maker.attempt(std::ldexp(give_part * size, attempt) * give_ways[way])) return result;
  }
  return Error{Errc::failed, "no position was found in which the parts cross clearly; move one of "
                             "them a little"};
}

} // namespace nendo::deform
