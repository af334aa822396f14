#include "join/union_of_two.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/deform/closed_manifold.hpp>

#include "join/self_intersections.hpp"
#include "mesh/surface_mesh.hpp"

namespace nendo::deform {
namespace {

constexpr int max_restorings = 6;
constexpr std::size_t max_pairs = 1000;

/// Gives the second surface's points in a union their bits back, as far as that cuts nothing.
class BitRestorer {
public:
  BitRestorer(const TriangleSurface& second, std::size_t first_points, Chosen& chosen)
      : chosen_(chosen), moved_(chosen.surface.points), kept_(moved_.size(), 0) {
    std::vector<char> at_seam(moved_.size(), 0);
    for (const std::uint32_t face : chosen.made)
      for (const std::uint32_t corner : chosen.surface.faces[face])
        at_seam[corner] = 1;
    original_ = moved_;
    for (std::size_t at = 0; at < moved_.size(); ++at) {
      const std::size_t origin = chosen.origins[at];
      if (origin < first_points || origin >= first_points + second.points.size()) continue;
      original_[at] = second.points[origin - first_points];
      kept_[at] = at_seam[at] ? 0 : 1;
    }
  }

  /// Returns false if some faces cut each other even without any bits given back.
  bool restore() {
    for (int round = 0; round <= max_restorings; ++round) {
      if (round == max_restorings) std::fill(kept_.begin(), kept_.end(), 0);
      place();
      const std::vector<TrianglePair> pairs = cutting_pairs();
      if (pairs.empty()) return true;
      if (!give_up(pairs)) return false;
    }
    return false;
  }

private:
  void place() {
    for (std::size_t at = 0; at < moved_.size(); ++at)
      chosen_.surface.points[at] = kept_[at] ? original_[at] : moved_[at];
  }
  /// Of faces that changed: those at the seam, those of which some corners were given back, and
  /// where one of the first surface meets one of the second. All others are as they were.
  std::vector<TrianglePair> cutting_pairs() const {
    const TriangleSurface& surface = chosen_.surface;
    std::vector<char> is_changed(surface.faces.size(), 0);
    for (const std::uint32_t face : chosen_.made)
      is_changed[face] = 1;
    std::vector<std::uint32_t> changed, of_first, of_second;
    for (std::uint32_t face = 0; face < surface.faces.size(); ++face) {
      const bool is_second = chosen_.face_parts[face] == 1;
      const Corners& corner = surface.faces[face];
      const int kept = kept_[corner[0]] + kept_[corner[1]] + kept_[corner[2]];
      if (is_second && kept > 0 && kept < 3) is_changed[face] = 1;
      (is_changed[face] ? changed : is_second ? of_second : of_first).push_back(face);
    }
    auto pairs = self_intersections_of(surface.points, surface.faces, changed, max_pairs);
    const auto more =
        intersections_between(surface.points, surface.faces, of_second, of_first, max_pairs);
    pairs.insert(pairs.end(), more.begin(), more.end());
    return pairs;
  }
  /// Undoes what was given to the faces of the pairs. Returns false if that was nothing.
  bool give_up(const std::vector<TrianglePair>& pairs) {
    bool any = false;
    for (const auto& [one, other] : pairs)
      for (const std::uint32_t face : {one, other})
        for (const std::uint32_t corner : chosen_.surface.faces[face])
          any = any || std::exchange(kept_[corner], 0) != 0;
    return any;
  }

  Chosen& chosen_;
  std::vector<SpacePoint> moved_, original_;
  std::vector<char> kept_;
};

/// Edges between faces of the first and faces of the second surface.
std::vector<SeamEdge> seam_of(const Chosen& chosen) {
  std::vector<SeamEdge> seam;
  const SurfaceMesh mesh(chosen.surface.faces, chosen.surface.points.size());
  for (std::uint32_t edge = 0; edge < 3 * mesh.face_count(); ++edge)
    if (edge < mesh.twin(edge) &&
        chosen.face_parts[edge / 3] != chosen.face_parts[mesh.twin(edge) / 3])
      seam.emplace_back(mesh.from(edge), mesh.to(edge));
  return seam;
}

bool all_are(const std::vector<char>& inside, char value) {
  return std::find(inside.begin(), inside.end(), 1 - value) == inside.end();
}

} // namespace

bool is_closed_solid(const TriangleSurface& surface) {
  std::vector<std::uint32_t> starts{0}, corners;
  for (const Corners& face : surface.faces) {
    corners.insert(corners.end(), face.begin(), face.end());
    starts.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  const bool is_finite =
      std::all_of(surface.points.begin(), surface.points.end(), [](const SpacePoint& point) {
        return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
      });
  return is_finite && check_closed_manifold(starts, corners, surface.points.size()) &&
         volume_of(surface.points, surface.faces) > 0.0;
}

Result<UnionOfTwo> union_of(const TriangleSurface& first, const TriangleSurface& second) {
  for (int attempt = 0; attempt < max_overlay_attempts; ++attempt) {
    const auto laid = overlay(first, second, attempt);
    if (!laid) return laid.error();
    attempt = laid->attempts - 1;
    const bool is_crossed = !laid->crossings.segments.empty();
    if (!is_crossed && all_are(laid->inside[0], 0) && all_are(laid->inside[1], 0))
      return Error{Errc::failed, "they do not touch; move them into each other a little"};
    Chosen chosen = choose(first, second, *laid, Choice::union_of_both);
    if (!is_closed_solid(chosen.surface)) continue;
    if (!BitRestorer(second, first.points.size(), chosen).restore()) continue;
    UnionOfTwo result;
    result.swallowed = !is_crossed && (all_are(laid->inside[0], 1) || all_are(laid->inside[1], 1));
    result.crossings = laid->crossings.points.size();
    result.seam = seam_of(chosen);
    result.surface = std::move(chosen.surface);
    return result;
  }
  return Error{Errc::failed, "no union of them is closed and free of self-intersections"};
}

} // namespace nendo::deform
