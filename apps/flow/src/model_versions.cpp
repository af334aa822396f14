#include "model_versions.hpp"

#include <algorithm>
#include <utility>

namespace nendo::flow {

ModelVersions::ModelVersions(const deform::Mesh& model, const UndoRoom& undo,
                             const deform::BlockShape* first)
    : undo_(undo) {
  all_.push_back(
      std::make_shared<ModelVersion>(0, model, deform::BlockLayout(model.vertices), undo, first));
}

std::shared_ptr<ModelVersion> ModelVersions::find(std::uint32_t number) const noexcept {
  for (const auto& version : all_)
    if (version->number == number) return version;
  return nullptr;
}

ModelVersion& ModelVersions::add(std::unique_ptr<ModelVersion> version) {
  ++last_number_;
  all_.push_back(std::move(version));
  return *all_.back();
}

void ModelVersions::release_others(const ModelVersion& newest) {
  std::erase_if(all_, [&newest](const auto& version) {
    for (const ModelVersion* at = &newest; at != nullptr; at = at->before)
      if (at == version.get()) return false;
    return true;
  });
}

UndoRoom ModelVersions::remaining_room() const noexcept {
  if (undo_.max_bytes == 0) return {undo_.bytes, 0};
  std::size_t used = 0;
  for (const auto& version : all_)
    if (version->undo_memory) used += version->undo_memory->bytes();
  return {0, undo_.max_bytes - std::min(undo_.max_bytes, used)};
}

} // namespace nendo::flow
