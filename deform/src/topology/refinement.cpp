#include <nendo/deform/refinement.hpp>

#include <algorithm>
#include <cmath>

#include <nendo/deform/closed_manifold.hpp>

#include "join/live_surface.hpp"
#include "join/mesh_surface.hpp"
#include "join/refine.hpp"
#include "join/self_intersections.hpp"
#include "join/triangle_surface.hpp"

namespace nendo::deform {
namespace {

// Of Mesh::detail.
constexpr double longest_of_detail = 1.5;
constexpr double shortest_of_detail = 0.5;
constexpr double min_height = 1e-3;
/// No collapse turns a face by more than 25 degrees: sharp edges stay sharp.
constexpr double min_cosine = 0.9;
/// Where no edge has changed its length by more, no hand has been, and the triangles are left
/// alone, however uneven they are.
constexpr double min_change = 0.3;
constexpr int max_refining_rounds = 8;
/// Where an operation made a self-intersection, nothing is done the next time. The last attempts
/// only split, which changes no shape but for rounding. After them, nothing is done at all.
constexpr int max_attempts = 7;
constexpr int splitting_attempts = 2;

/// The mean length of the edges around each point, of a surface that was not refined before.
std::vector<VertexDetail> present_detail(const LiveSurface& surface) {
  std::vector<VertexDetail> means(surface.point_count());
  for (std::uint32_t point = 0; point < means.size(); ++point) {
    if (!surface.has_point(point)) continue;
    double sum = 0.0;
    int count = 0;
    surface.visit_edges(point, [&](std::uint32_t edge) {
      sum += surface.edge_length(edge);
      ++count;
    });
    means[point].edge = static_cast<float>(sum / count);
  }
  return means;
}

/// The surface of one mesh before the hands, and its lists of materials and names.
std::pair<LiveSurface, Appearance> surface_of(const Mesh& mesh) {
  auto [surface, look] = single_surface_of(mesh);
  surface.rest = surface.points;
  LiveSurface live(std::move(surface));
  if (mesh.detail.empty()) live.set_detail(present_detail(live));
  return {std::move(live), std::move(look)};
}

/// The mesh before the hands.
Mesh mesh_at_rest(TriangleSurface surface, const Appearance& look, const Eigen::Vector3d& offset) {
  surface.points = std::move(surface.rest);
  Mesh mesh = mesh_of(surface, look);
  mesh.offset = offset;
  return mesh;
}

/// The vertices that bound the box: where they stay, the layout's numbers mean the same.
std::vector<char> bounding(const Points& vertices) {
  std::vector<char> bounds(static_cast<std::size_t>(vertices.cols()), 0);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Index least = 0, most = 0;
    vertices.row(axis).minCoeff(&least);
    vertices.row(axis).maxCoeff(&most);
    bounds[static_cast<std::size_t>(least)] = bounds[static_cast<std::size_t>(most)] = 1;
  }
  return bounds;
}

} // namespace

struct Refiner::Parts {
  Appearance look;
  LiveSurface surface;      ///< the mesh before the hands
  std::vector<char> bounds; ///< whether the bounding box needs each point
  Eigen::Vector3d offset;   ///< Mesh::offset
  double target = 1.0;      ///< the limits' measure; Mesh::detail says what part or multiple of it

  /// The surface as the shape has it, in the numbers of blocks.
  LiveSurface shaped(const BlockShape& shape, const BlockLayout& layout) const {
    LiveSurface live = surface;
    for (std::size_t at = 0; at < layout.order().size(); ++at) {
      const Eigen::Vector3d place = vertex_at(shape, at).cast<double>();
      live.move(layout.order()[at], {place[0], place[1], place[2]});
    }
    return live;
  }
  /// What the shape stretches or presses, and may be worked at.
  RefineZone zone_of(const LiveSurface& live, double unit) const {
    RefineZone zone;
    zone.coarseness.assign(live.point_count(), 0.0f);
    zone.hold.assign(live.point_count(), 2);
    for (std::uint32_t point = 0; point < live.point_count(); ++point) {
      if (!live.has_point(point)) continue;
      const VertexDetail& detail = surface.detail()[point];
      bool is_changed = detail.is_refined;
      live.visit_edges(point, [&](std::uint32_t edge) {
        const double before = surface.edge_length(edge);
        is_changed =
            is_changed || std::abs(unit * live.edge_length(edge) - before) > min_change * before;
      });
      if (!is_changed) continue;
      zone.coarseness[point] = static_cast<float>(static_cast<double>(detail.edge) / target);
      zone.hold[point] = bounds[point] ? 2 : 0;
    }
    return zone;
  }
  RefineLimits limits(double unit, const RefinementLimits& asked) const {
    RefineLimits limits;
    limits.longest = longest_of_detail * target / unit;
    limits.shortest = shortest_of_detail * target / unit;
    limits.thin = min_height * limits.longest;
    limits.min_cosine = min_cosine;
    limits.budget = asked.budget;
    limits.max_points = asked.max_vertices;
    return limits;
  }
};

Refiner::Refiner(std::unique_ptr<const Parts> parts) : parts_(std::move(parts)) {}
Refiner::Refiner(Refiner&&) noexcept = default;
Refiner& Refiner::operator=(Refiner&&) noexcept = default;
Refiner::~Refiner() = default;

Result<void> Refiner::check(const Mesh& mesh) {
  if (!mesh.vertices.allFinite())
    return Error{Errc::bad_input, "has a coordinate that is not finite"};
  if (const ManifoldCheck check = check_closed_manifold(mesh); !check)
    return Error{Errc::bad_input, describe(check, mesh)};
  return {};
}

Result<Refiner> Refiner::make(const Mesh& mesh) {
  if (const auto fine = check(mesh); !fine) return fine.error();
  auto [surface, look] = surface_of(mesh);
  auto parts = std::make_unique<Parts>(
      Parts{std::move(look), std::move(surface), bounding(mesh.vertices), mesh.offset});
  double sum = 0.0;
  for (const VertexDetail& of : parts->surface.detail())
    sum += static_cast<double>(of.edge);
  parts->target = sum / static_cast<double>(parts->surface.point_count());
  return Refiner(std::move(parts));
}

std::size_t Refiner::count_unfit(const BlockShape& shape, const BlockLayout& layout,
                                 const RefinementLimits& limits) const {
  const LiveSurface live = parts_->shaped(shape, layout);
  return unfit_edges(live, parts_->zone_of(live, layout.unit()),
                     parts_->limits(layout.unit(), limits));
}

namespace {

/// What came of one attempt. Where sheets nearly touch, rounding may make them meet; so the points
/// of the surface are the numbers of the shape.
struct Attempt {
  TriangleSurface surface;
  Eigen::Matrix3Xf shape;
  std::vector<std::uint32_t> numbers; ///< one per point, those that are gone as well
  std::vector<EdgeOperation> operations;
};

Attempt attempt(LiveSurface live, RefineZone zone, RefineLimits limits, bool only_splits) {
  Attempt made;
  live.note_in(&made.operations);
  limits.only_splits = only_splits;
  for (int round = 0; round < max_refining_rounds; ++round) {
    const RefineCounts done = refine(live, zone, limits);
    limits.budget -= done.splits + done.collapses;
    if (done.splits + done.collapses + done.flips == 0) break;
  }
  made.surface = live.take(&made.numbers);
  made.shape = round_points(made.surface.points);
  return made;
}

/// Of each point whether a face there meets another before anything is done.
std::vector<char> meeting_before(const LiveSurface& live) {
  std::vector<std::uint32_t> numbers;
  const TriangleSurface surface = LiveSurface(live).take(&numbers);
  std::vector<char> of_number(surface.points.size(), 0);
  for (const auto& [one, other] : self_intersections(surface.points, surface.faces))
    for (const std::uint32_t face : {one, other})
      for (const std::uint32_t corner : surface.faces[face])
        of_number[corner] = 1;
  std::vector<char> meets(numbers.size(), 0);
  for (std::size_t point = 0; point < meets.size(); ++point)
    meets[point] = numbers[point] != no_index && of_number[numbers[point]] ? 1 : 0;
  return meets;
}

/// The faces at points of operations.
std::vector<std::uint32_t> changed_faces(const Attempt& made) {
  std::vector<char> is_changed(made.surface.points.size(), 0);
  for (const EdgeOperation& operation : made.operations)
    for (const std::uint32_t point : {operation.from, operation.to})
      if (made.numbers[point] != no_index) is_changed[made.numbers[point]] = 1;
  std::vector<std::uint32_t> changed;
  for (std::uint32_t face = 0; face < made.surface.faces.size(); ++face) {
    const Corners& corner = made.surface.faces[face];
    if (is_changed[corner[0]] || is_changed[corner[1]] || is_changed[corner[2]])
      changed.push_back(face);
  }
  return changed;
}

/// Lets the zone leave alone what an attempt made meet. Returns whether there is any. What met
/// before, and what lies between such points now, does not count.
bool leave_alone(const Attempt& made, const LiveSurface& live, RefineZone& zone) {
  const auto pairs =
      self_intersections_of(made.surface.points, made.surface.faces, changed_faces(made));
  if (pairs.empty()) return false;
  std::vector<char> met = meeting_before(live);
  for (const EdgeOperation& operation : made.operations)
    if (operation.kind == EdgeOperation::Kind::split)
      met.push_back(met[operation.from] || met[operation.to] ? 1 : 0);
  std::vector<std::uint32_t> points(made.surface.points.size());
  for (std::uint32_t point = 0; point < made.numbers.size(); ++point)
    if (made.numbers[point] != no_index) points[made.numbers[point]] = point;
  const auto met_at = [&](std::uint32_t face) {
    const Corners& corner = made.surface.faces[face];
    return met[points[corner[0]]] || met[points[corner[1]]] || met[points[corner[2]]];
  };
  bool is_any = false;
  for (const auto& [one, other] : pairs) {
    if (met_at(one) || met_at(other)) continue;
    is_any = true;
    for (const std::uint32_t face : {one, other})
      for (const std::uint32_t corner : made.surface.faces[face]) {
        if (points[corner] >= zone.hold.size()) continue;
        zone.hold[points[corner]] = 2;
        zone.coarseness[points[corner]] = 0.0f;
      }
  }
  return is_any;
}

} // namespace

Refinement Refiner::refine(const BlockShape& shape, const BlockLayout& layout,
                           const RefinementLimits& asked) const {
  const LiveSurface live = parts_->shaped(shape, layout);
  RefineZone zone = parts_->zone_of(live, layout.unit());
  RefineLimits limits = parts_->limits(layout.unit(), asked);
  Attempt made;
  for (int count = 0; count <= max_attempts; ++count) {
    if (count == max_attempts) limits.budget = 0; // nothing is done
    made = attempt(live, zone, limits, count + splitting_attempts >= max_attempts);
    if (!leave_alone(made, live, zone)) break;
  }
  Refinement result;
  result.operations = std::move(made.operations);
  result.shape = std::move(made.shape);
  result.mesh = mesh_at_rest(std::move(made.surface), parts_->look, parts_->offset);
  return result;
}

Result<Mesh> refined(const Mesh& mesh, std::span<const EdgeOperation> operations) {
  if (const auto fine = Refiner::check(mesh); !fine) return fine.error();
  auto [live, look] = surface_of(mesh);
  for (const EdgeOperation& operation : operations)
    if (!live.repeat(operation))
      return Error{Errc::bad_input, "cannot be refined as it was when it was recorded"};
  return mesh_at_rest(live.take(), look, mesh.offset);
}

} // namespace nendo::deform
