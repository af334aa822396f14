#include <nendo/flow/model_version.hpp>

#include <utility>

#include <nendo/deform/deformer_options.hpp>

namespace nendo::flow {
namespace {

// Some whole shapes ahead, so that refills may be seldom.
std::unique_ptr<deform::UndoMemory> undo_memory_for(const deform::BlockLayout& layout,
                                                    const UndoRoom& undo) {
  constexpr std::size_t shapes_ahead = 4;
  if (undo.most_bytes == 0) return nullptr;
  auto memory = std::make_unique<deform::UndoMemory>(shapes_ahead * (layout.block_count() + 1),
                                                     undo.most_bytes);
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
  if (mesh.face_corners.size() <= FinerModel::most_corners) return {};
  return Error{Errc::bad_input, "is too large to be subdivided"};
}

} // namespace

ModelVersion::ModelVersion(std::uint32_t version, deform::Mesh model, deform::BlockLayout layout,
                           const UndoRoom& undo, const deform::BlockShape* first)
    : number(version), mesh(std::move(model)), undo_memory(undo_memory_for(layout, undo)),
      shape(std::move(layout), with_undo(undo.bytes, undo_memory.get()), first) {}

deform::BlockShape room_for_shape(const ModelVersion& version) {
  return deform::BlockShape(std::vector<deform::VertexBlock>(version.layout().block_count()));
}

Result<deform::Mesh> made_again(const deform::Mesh& before, const ModelOrigin& origin) {
  if (origin.source == ModelSource::refined) return deform::refined(before, origin.refining);
  if (auto fine = check_subdividable(before); !fine) return fine.error();
  return deform::subdivide(before).mesh;
}

FinerModel::FinerModel(const ModelVersion& from)
    : from_(&from), making_([&] {
        deform::Subdivision subdivision = deform::subdivide(from.mesh);
        deform::BlockLayout layout(subdivision.mesh.vertices);
        return Subdividing{std::move(subdivision), std::move(layout)};
      }()) {}

Result<FinerModel> FinerModel::make(const ModelVersion& from, const ChangeModel& change) {
  if (change.source == ModelSource::refined) {
    auto refiner = deform::Refiner::make(from.mesh);
    if (!refiner) return refiner.error();
    return FinerModel(from, Refining{*std::move(refiner), {.most_vertices = change.most_vertices}});
  }
  if (auto fine = check_subdividable(from.mesh); !fine) return fine.error();
  return FinerModel(from);
}

std::unique_ptr<ModelVersion> FinerModel::finish(std::uint32_t number, const UndoRoom& undo) {
  const deform::BlockShape& shape = from_->shape.shape();
  if (auto* const finer = std::get_if<Subdividing>(&making_)) {
    const deform::BlockShape first =
        deform::subdivided(shape, from_->layout(), finer->subdivision, finer->layout);
    auto made = std::make_unique<ModelVersion>(number, std::move(finer->subdivision.mesh),
                                               std::move(finer->layout), undo, &first);
    made->origin = std::make_shared<ModelOrigin>(ModelOrigin{ModelSource::subdivided, {}});
    return made;
  }
  const Refining& refining = std::get<Refining>(making_);
  deform::Refinement refinement = refining.refiner.refine(shape, from_->layout(), refining.limits);
  found_nothing_ = refinement.operations.empty();
  if (found_nothing_) return nullptr;
  deform::BlockLayout layout(refinement.mesh.vertices);
  const deform::BlockShape first = deform::shape_in_blocks(refinement.shape, layout);
  auto made = std::make_unique<ModelVersion>(number, std::move(refinement.mesh), std::move(layout),
                                             undo, &first);
  made->origin = std::make_shared<ModelOrigin>(
      ModelOrigin{ModelSource::refined, std::move(refinement.operations)});
  return made;
}

ChangeModel FinerModel::change_to(const ModelVersion& version) const noexcept {
  const auto* const refining = std::get_if<Refining>(&making_);
  return {version.number, version.origin->source,
          refining != nullptr ? static_cast<std::uint32_t>(refining->limits.most_vertices) : 0};
}

std::size_t FinerModel::count_unfit(const deform::BlockShape& shape) const {
  const auto* const refining = std::get_if<Refining>(&making_);
  if (refining == nullptr) return 0;
  return refining->refiner.count_unfit(shape, from_->layout(), refining->limits);
}

} // namespace nendo::flow
