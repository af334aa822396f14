#pragma once
// `nendo export FILE --out FILE.glb` of a timeline that is being edited, beside the editing.

#include <atomic>
#include <optional>
#include <string>
#include <thread>

#include <nendo/timeline/timeline.hpp>

#include "export/exported.hpp"

namespace nendo::edit {

class GlbExport {
public:
  /// Begins, on a thread of its own; the file is there as a whole or not at all.
  GlbExport(const timeline::Timeline& timeline, const deform::Mesh& model, const std::string& path);
  /// Stops it, if it still goes on.
  ~GlbExport();
  GlbExport(const GlbExport&) = delete;
  GlbExport& operator=(const GlbExport&) = delete;

  /// What became of it; nothing: it goes on. Errors: as export_gltf().
  std::optional<Result<exporting::Exported>> result() const;

private:
  std::atomic<bool> stop_ = false;
  std::atomic<bool> done_ = false;
  std::optional<Result<exporting::Exported>> result_; ///< once done_
  std::thread thread_;
};

} // namespace nendo::edit
