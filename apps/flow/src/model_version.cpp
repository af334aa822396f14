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

} // namespace

ModelVersion::ModelVersion(std::uint32_t version, deform::Mesh model, deform::BlockLayout layout,
                           const UndoRoom& undo, const deform::BlockShape* first)
    : number(version), mesh(std::move(model)), undo_memory(undo_memory_for(layout, undo)),
      shape(std::move(layout), with_undo(undo.bytes, undo_memory.get()), first) {}

deform::BlockShape room_for_shape(const ModelVersion& version) {
  return deform::BlockShape(std::vector<deform::VertexBlock>(version.layout().block_count()));
}

FinerModel::FinerModel(const ModelVersion& from)
    : from_(&from), subdivision_(deform::subdivide(from.mesh)),
      layout_(subdivision_.mesh.vertices) {}

std::unique_ptr<ModelVersion> FinerModel::finish(std::uint32_t number, const UndoRoom& undo) {
  const deform::BlockShape first =
      deform::subdivided(from_->shape.shape(), from_->layout(), subdivision_, layout_);
  return std::make_unique<ModelVersion>(number, std::move(subdivision_.mesh), std::move(layout_),
                                        undo, &first);
}

} // namespace nendo::flow
