#include <nendo/deform/join.hpp>

#include <algorithm>
#include <cmath>
#include <deque>

#include <nendo/base/result.hpp>
#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/offset.hpp>

#include "join/mesh_surface.hpp"
#include "join/overlay.hpp"
#include "join/seam.hpp"
#include "join/self_intersections.hpp"
#include "mesh/surface_mesh.hpp"

namespace nendo::deform {
namespace {

struct UnionOfTwo {
  TriangleSurface surface;
  std::vector<SeamEdge> seam;
  std::size_t crossings = 0;
  bool swallowed = false; ///< one of both lies wholly inside of the other
};

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

/// Returns true if the surface is closed and two-manifold, and encloses a volume. Allocates.
bool is_closed_solid(const TriangleSurface& surface) {
  std::vector<std::uint32_t> starts{0}, corners;
  for (const Corners& face : surface.faces) {
    corners.insert(corners.end(), face.begin(), face.end());
    starts.push_back(to_index(corners.size()));
  }
  const bool is_finite =
      std::all_of(surface.points.begin(), surface.points.end(), [](const SpacePoint& point) {
        return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
      });
  return is_finite && check_closed_manifold(starts, corners, surface.points.size()) &&
         volume_of(surface.points, surface.faces) > 0.0;
}

/// The second surface's points get their bits back where it was displaced only to find a clear
/// position: everywhere but at crossed faces, and where it is as near to the first one as that.
/// Surfaces must be closed and two-manifold. Error: failed (they do not touch, or no union passes
/// the checks). Allocates.
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

/// Products of three coordinates must neither overflow nor lose digits (exact_predicates.hpp).
constexpr double largest_coordinate = 1e60;
constexpr double min_size = 1e-40;
/// A seam that cuts itself is tried again at half the width, so often.
constexpr int max_narrowings = 3;

Result<void> check_part(const JoinPart& part) {
  const auto bad = [&](const std::string& what) {
    return Error{Errc::bad_input, part.name + ": " + what};
  };
  const Mesh& mesh = *part.mesh;
  if (!mesh.vertices.allFinite()) return bad("has a coordinate that is not finite");
  if (mesh.vertices.size() > 0 && mesh.vertices.cwiseAbs().maxCoeff() > largest_coordinate)
    return bad("has coordinates beyond 1e60; scale it down");
  if (const ManifoldCheck check = check_closed_manifold(mesh); !check)
    return bad(describe(check, mesh) +
               "; only closed models can be joined, so repair it with `nendo repair IN --out OUT`");
  if (!(diagonal_of(mesh.vertices) > min_size)) return bad("has no size; scale it up");
  return {};
}

/// The parts, counted from where the first one is. `moved` owns those that counted from elsewhere.
std::vector<const Mesh*> counted_alike(std::span<const JoinPart> parts, std::deque<Mesh>& moved) {
  std::vector<const Mesh*> meshes;
  for (const JoinPart& part : parts) {
    meshes.push_back(part.mesh);
    if (part.mesh->offset == parts[0].mesh->offset) continue;
    meshes.back() = &moved.emplace_back(*part.mesh);
    count_from(parts[0].mesh->offset, moved.back());
  }
  return meshes;
}

/// Why no union was found: usually because a part cuts itself.
Error explained(Error error, const TriangleSurface& surface, const Eigen::Vector3d& offset,
                const JoinPart& part) {
  const auto pairs = self_intersections(surface.points, surface.faces, 1);
  if (pairs.empty()) return error;
  const SpacePoint& near = surface.points[surface.faces[pairs[0].first][0]];
  error.message += "; " + part.name + " cuts itself near " +
                   place_text(Eigen::Vector3d(near.data()), offset) +
                   ", which `nendo repair` does not fix: remove that where it was made";
  return error;
}

/// Returns the union with a seam of the width asked for, or a narrower one that does not cut
/// itself.
TriangleSurface with_seam(UnionOfTwo sharp, double width, JoinStep& step) {
  for (int narrowing = 0; width > 0.0 && narrowing < max_narrowings; ++narrowing, width *= 0.5) {
    Seam seam = smear_seam(sharp.surface, sharp.seam, width);
    if (!is_closed_solid(seam.surface) ||
        !self_intersections_of(seam.surface.points, seam.surface.faces, seam.changed, 1).empty())
      continue;
    step.seam_width = width;
    step.volume_bound = seam.volume_bound;
    return std::move(seam.surface);
  }
  return std::move(sharp.surface);
}

Result<void> check_options(const JoinOptions& options) {
  if (options.seam_width >= 0.0 && std::isfinite(options.seam_width)) return {};
  return Error{Errc::usage, "the seam's width must be 0 or more"};
}

} // namespace

Result<Joined> join(std::span<const JoinPart> parts, const JoinOptions& options) {
  if (const auto fine = check_options(options); !fine) return fine.error();
  if (parts.size() < 2) return Error{Errc::usage, "two parts at least are needed"};
  for (const JoinPart& part : parts)
    if (const auto fine = check_part(part); !fine) return fine.error();
  std::deque<Mesh> moved;
  const Eigen::Vector3d& offset = parts[0].mesh->offset;
  SharedSurfaces shared = surfaces_of(counted_alike(parts, moved));
  for (std::size_t at = 0; at < parts.size(); ++at)
    if (!(volume_of(shared.surfaces[at].points, shared.surfaces[at].faces) > 0.0))
      return Error{Errc::bad_input,
                   parts[at].name +
                       ": faces inwards; `nendo repair IN --out OUT` turns it outwards"};

  Joined joined;
  TriangleSurface whole = std::move(shared.surfaces[0]);
  for (std::size_t at = 1; at < parts.size(); ++at) {
    const TriangleSurface& next = shared.surfaces[at];
    const std::string names =
        (at == 1 ? parts[0].name : "what was joined") + " and " + parts[at].name + ": ";
    auto both = union_of(whole, next);
    if (!both) {
      Error error = explained(both.error(), next, offset, parts[at]);
      if (at == 1) error = explained(std::move(error), whole, offset, parts[0]);
      return Error{error.code, names + error.message};
    }
    JoinStep step{both->crossings, both->swallowed};
    step.sharp_volume = volume_of(both->surface.points, both->surface.faces);
    whole = with_seam(std::move(*both), options.seam_width, step);
    step.volume = volume_of(whole.points, whole.faces);
    joined.steps.push_back(step);
  }
  joined.mesh = mesh_of(whole, shared.look);
  joined.mesh.offset = offset;
  return joined;
}

} // namespace nendo::deform
