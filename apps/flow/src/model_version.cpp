#include <nendo/flow/model_version.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/edit_part.hpp>
#include <nendo/deform/join.hpp>
#include <nendo/deform/topology.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::flow {
namespace {

// Some whole shapes ahead, so that refills may be seldom.
std::unique_ptr<deform::UndoMemory> undo_memory_for(const deform::BlockLayout& layout,
                                                    const UndoSpace& undo) {
  constexpr std::size_t shapes_ahead = 4;
  if (undo.max_bytes == 0) return nullptr;
  auto memory = std::make_unique<deform::UndoMemory>(shapes_ahead * (layout.block_count() + 1),
                                                     undo.max_bytes);
  memory->refill();
  return memory;
}

deform::DeformerOptions with_undo(std::size_t bytes, deform::UndoMemory* memory) {
  deform::DeformerOptions options;
  options.undo_bytes = bytes;
  options.undo_memory = memory;
  return options;
}

Result<void> check_subdividable(const deform::Mesh& mesh) {
  if (mesh.face_corners.size() <= PendingModel::max_corners) return {};
  return Error{Errc::bad_input, "is too large to be subdivided"};
}

/// Faces keep the triangles that they had in `before`, at rest, although the shape becomes the
/// rest.
Result<deform::Mesh> cut_by_wire(const deform::Mesh& before, const ModelOrigin& origin) {
  deform::Mesh shaped = before;
  shaped.vertices = origin.shape;
  deform::CutOptions options;
  options.rest = &before.vertices;
  auto made = deform::cut_model(shaped, deform::CutWire{origin.wire}, options);
  if (!made) return made.error();
  return with_triangles_of(std::move(made->mesh), before.vertices);
}

Result<deform::Mesh> joined(const deform::Mesh& shaped, const ModelOrigin& origin) {
  const std::vector<deform::Mesh> meshes = deform::separate(shaped);
  if (meshes.size() < 2) return Error{Errc::bad_input, "is one part, which is whole"};
  std::vector<deform::JoinPart> parts;
  parts.reserve(meshes.size());
  for (const deform::Mesh& mesh : meshes)
    parts.push_back({&mesh, "part " + std::to_string(parts.size() + 1)});
  auto made = deform::join(parts, {.seam_width = origin.seam_width});
  if (!made) return Error{made.error().code, "cannot be joined: " + made.error().message};
  return std::move(made->mesh);
}

Result<deform::Mesh> made_of_shape(const deform::Mesh& before, const ModelOrigin& origin) {
  if (origin.source == ModelSource::cut) return cut_by_wire(before, origin);
  const deform::Mesh shaped = deform::in_shape(before, origin.shape);
  if (origin.source == ModelSource::joined) return joined(shaped, origin);
  if (origin.source == ModelSource::copied) return deform::copied_part(shaped, origin.part);
  if (origin.source == ModelSource::removed) return deform::removed_part(shaped, origin.part);
  auto changed = deform::change_topology(shaped);
  if (!changed) return changed.error();
  if (changed->counts.all() == 0)
    return Error{Errc::bad_input, "is nowhere thinner than its edges"};
  return std::move(changed->mesh);
}

using deform::Points;
using Eigen::Index;

constexpr int max_sweeps = 500;
constexpr double enough =
    1e-7; ///< relative to the longest path: a sweep that changes less is the last

/// For each vertex that was made, the shape's vertex that it was, or -1. Vertices keep their
/// numbers as long as none is taken away; then they are known by their places.
std::vector<Index> vertices_before(const Points& made, const Points& shape) {
  const auto is_as_before = [&](Index vertex) {
    return vertex < made.cols() && vertex < shape.cols() && made.col(vertex) == shape.col(vertex);
  };
  std::map<std::array<double, 3>, Index> at_place;
  for (Index vertex = shape.cols(); vertex-- > 0;) // of several at one place the first counts
    if (!is_as_before(vertex))
      at_place[{shape(0, vertex), shape(1, vertex), shape(2, vertex)}] = vertex;
  std::vector<Index> before;
  before.reserve(static_cast<std::size_t>(made.cols()));
  for (Index vertex = 0; vertex < made.cols(); ++vertex) {
    if (is_as_before(vertex)) {
      before.push_back(vertex);
      continue;
    }
    const auto same = at_place.find({made(0, vertex), made(1, vertex), made(2, vertex)});
    before.push_back(same == at_place.end() ? -1 : same->second);
  }
  return before;
}

/// The ends of edges that begin at new vertices, in this order.
std::vector<std::pair<Index, Index>> edges_of_new(const deform::Mesh& made,
                                                  const std::vector<Index>& before) {
  std::vector<std::pair<Index, Index>> edges;
  for (std::size_t face = 0; face + 1 < made.face_starts.size(); ++face) {
    const std::size_t begin = made.face_starts[face], end = made.face_starts[face + 1];
    for (std::size_t corner = begin; corner < end; ++corner) {
      const Index from = made.face_corners[corner];
      const Index to = made.face_corners[corner + 1 < end ? corner + 1 : begin];
      for (const auto& [one, other] : {std::pair{from, to}, std::pair{to, from}})
        if (before[static_cast<std::size_t>(one)] < 0) edges.emplace_back(one, other);
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// By Gauss and Seidel's method.
void spread(const std::vector<std::pair<Index, Index>>& edges, Points& ways) {
  const double longest = ways.size() > 0 ? ways.cwiseAbs().maxCoeff() : 0.0;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    double change = 0.0;
    for (std::size_t at = 0; at < edges.size();) {
      const Index vertex = edges[at].first;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double count = 0.0;
      for (; at < edges.size() && edges[at].first == vertex; ++at, ++count)
        sum += ways.col(edges[at].second);
      const Eigen::Vector3d mean = sum / count;
      change = std::max(change, (mean - ways.col(vertex)).cwiseAbs().maxCoeff());
      ways.col(vertex) = mean;
    }
    if (change <= enough * longest) return;
  }
}

} // namespace

ModelVersion::ModelVersion(std::uint32_t version, deform::Mesh model, deform::BlockLayout layout,
                           const UndoSpace& undo, const deform::BlockShape* first)
    : number(version), mesh(std::move(model)), undo_memory(undo_memory_for(layout, undo)),
      shape(std::move(layout), with_undo(undo.bytes, undo_memory.get()), first) {}

deform::BlockShape space_for_shape(const ModelVersion& version) {
  return deform::BlockShape(std::vector<deform::VertexBlock>(version.layout().block_count()));
}

Result<deform::Mesh> rebuild(const deform::Mesh& before, const ModelOrigin& origin) {
  if (origin.source == ModelSource::refined) return deform::refined(before, origin.refining);
  if (is_of_shape(origin.source)) {
    if (origin.shape.cols() != before.vertices.cols())
      return Error{Errc::bad_input, "is another one than was changed"};
    auto made = made_of_shape(before, origin);
    if (made && origin.keeps_rest) made->vertices = kept_rest(*made, origin.shape, before.vertices);
    return made;
  }
  if (auto fine = check_subdividable(before); !fine) return fine.error();
  return deform::subdivide(before).mesh;
}

PendingModel::PendingModel(const ModelVersion& from)
    : from_(&from), making_([&] {
        deform::Subdivision subdivision = deform::subdivide(from.mesh);
        deform::BlockLayout layout(subdivision.mesh.vertices);
        return Subdividing{std::move(subdivision), std::move(layout)};
      }()) {}

Result<PendingModel> PendingModel::make(const ModelVersion& from, const ChangeModel& change,
                                        std::span<const deform::WirePlace> wire) {
  if (change.source == ModelSource::refined) {
    auto refiner = deform::Refiner::make(from.mesh);
    if (!refiner) return refiner.error();
    return PendingModel(from, Refining{*std::move(refiner), {.max_vertices = change.max_vertices}});
  }
  if (flow::is_of_shape(change.source)) {
    ModelOrigin origin;
    origin.source = change.source;
    origin.seam_width = change.seam_width;
    origin.part = change.part;
    origin.wire.assign(wire.begin(), wire.end());
    return PendingModel(from, Remaking{std::move(origin)});
  }
  if (auto fine = check_subdividable(from.mesh); !fine) return fine.error();
  return PendingModel(from);
}

Result<std::unique_ptr<ModelVersion>> PendingModel::remade(Remaking& remaking, std::uint32_t number,
                                                           const UndoSpace& undo, bool keeps_rest) {
  ModelOrigin& origin = remaking.origin;
  from_->layout().unpack(from_->shape.shape(), origin.shape);
  origin.keeps_rest = keeps_rest;
  auto mesh = made_of_shape(from_->mesh, origin);
  found_nothing_ = !mesh && origin.source == ModelSource::topology;
  if (!mesh) return mesh.error();
  std::optional<deform::Points> shape;
  if (keeps_rest)
    shape = std::exchange(mesh->vertices, kept_rest(*mesh, origin.shape, from_->mesh.vertices));
  deform::BlockLayout layout(mesh->vertices);
  std::optional<deform::BlockShape> first;
  if (shape) first = layout.pack(*shape);
  auto made = std::make_unique<ModelVersion>(number, *std::move(mesh), std::move(layout), undo,
                                             first ? &*first : nullptr);
  made->origin = std::make_shared<ModelOrigin>(std::move(origin));
  return made;
}

Result<std::unique_ptr<ModelVersion>> PendingModel::finish(std::uint32_t number,
                                                           const UndoSpace& undo, bool keeps_rest) {
  if (auto* const remaking = std::get_if<Remaking>(&making_))
    return remade(*remaking, number, undo, keeps_rest);
  const deform::BlockShape& shape = from_->shape.shape();
  if (auto* const finer = std::get_if<Subdividing>(&making_)) {
    const deform::BlockShape first =
        deform::subdivided(shape, from_->layout(), finer->subdivision, finer->layout);
    auto made = std::make_unique<ModelVersion>(number, std::move(finer->subdivision.mesh),
                                               std::move(finer->layout), undo, &first);
    made->origin = std::make_shared<ModelOrigin>(ModelOrigin{.source = ModelSource::subdivided});
    return made;
  }
  const Refining& refining = std::get<Refining>(making_);
  deform::Refinement refinement = refining.refiner.refine(shape, from_->layout(), refining.limits);
  found_nothing_ = refinement.operations.empty();
  if (found_nothing_) return Error{Errc::bad_input, "has nothing to refine"};
  deform::BlockLayout layout(refinement.mesh.vertices);
  const deform::BlockShape first = deform::shape_in_blocks(refinement.shape, layout);
  auto made = std::make_unique<ModelVersion>(number, std::move(refinement.mesh), std::move(layout),
                                             undo, &first);
  made->origin = std::make_shared<ModelOrigin>(
      ModelOrigin{.source = ModelSource::refined, .refining = std::move(refinement.operations)});
  if (from_->clay) made->clay = std::make_shared<const ClayModel>(made->mesh, from_->clay->volume);
  return made;
}

ChangeModel PendingModel::change_to(const ModelVersion& version) const noexcept {
  const auto* const refining = std::get_if<Refining>(&making_);
  return {version.number, version.origin->source,
          refining != nullptr ? static_cast<std::uint32_t>(refining->limits.max_vertices) : 0,
          version.origin->seam_width, version.origin->part};
}

std::size_t PendingModel::count_unfit(const deform::BlockShape& shape) const {
  const auto* const refining = std::get_if<Refining>(&making_);
  if (refining == nullptr) return 0;
  return refining->refiner.count_unfit(shape, from_->layout(), refining->limits);
}

Points kept_rest(const deform::Mesh& made, const Points& shape, const Points& rest) {
  const std::vector<Index> before = vertices_before(made.vertices, shape);
  Points ways = Points::Zero(3, made.vertices.cols());
  for (Index vertex = 0; vertex < ways.cols(); ++vertex)
    if (const Index old = before[static_cast<std::size_t>(vertex)]; old >= 0)
      ways.col(vertex) = rest.col(old) - shape.col(old);
  spread(edges_of_new(made, before), ways);
  Points kept = made.vertices + ways;
  for (Index vertex = 0; vertex < kept.cols(); ++vertex) // without rounding
    if (const Index old = before[static_cast<std::size_t>(vertex)]; old >= 0)
      kept.col(vertex) = rest.col(old);
  return kept;
}

} // namespace nendo::flow
