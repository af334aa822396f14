#pragma once
// The versions of a model that a loop has had, and to which an undo or a redo may lead.

#include <cstdint>
#include <memory>
#include <vector>

#include <nendo/flow/model_version.hpp>

namespace nendo::flow {

/// For the thread that asks for changes.
class ModelVersions {
public:
  /// `undo` is for all versions together. With `first`, that is the shape at first.
  ModelVersions(const deform::Mesh& model, const UndoRoom& undo, const deform::BlockShape* first);

  ModelVersion& first() noexcept { return *all_.front(); }
  /// Returns that version; null if there is none.
  std::shared_ptr<ModelVersion> find(std::uint32_t number) const noexcept;
  /// Returns the number that add() needs.
  std::uint32_t next_number() const noexcept { return last_number_ + 1; }
  ModelVersion& add(std::unique_ptr<ModelVersion> version);
  /// Releases all versions that do not come before `newest`: a new version took the place to which
  /// a redo would have led.
  void release_others(const ModelVersion& newest);
  /// Returns the memory that remains for undo. Memory that grows is not allocated while the loop
  /// holds still.
  UndoRoom remaining_room() const noexcept;

private:
  UndoRoom undo_;
  std::vector<std::shared_ptr<ModelVersion>> all_;
  std::uint32_t last_number_ = 0;
};

} // namespace nendo::flow
