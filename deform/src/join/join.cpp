#include <nendo/deform/join.hpp>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/offset.hpp>

#include "join/mesh_surface.hpp"
#include "join/seam.hpp"
#include "join/self_intersections.hpp"
#include "join/union_of_two.hpp"

namespace nendo::deform {
namespace {

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
               "; only closed models can be joined, so mend it with `nendo repair IN --out OUT`");
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
                   ", which `nendo repair` does not mend: remove that where it was made";
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
