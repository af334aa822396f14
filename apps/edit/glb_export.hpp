#pragma once
// Exports a timeline as a GLB file on a thread of its own while the timeline is edited further.

#include <atomic>
#include <optional>
#include <string>
#include <thread>

#include "export/exported.hpp"
#include "timeline/timeline.hpp"

namespace nendo::edit {

class GlbExport {
public:
  /// Starts the export. The file appears only when it is complete.
  GlbExport(const timeline::Timeline& timeline, const deform::Mesh& model, const std::string& path);
  /// Stops the export if it is still running, and waits for its thread.
  ~GlbExport();
  GlbExport(const GlbExport&) = delete;
  GlbExport& operator=(const GlbExport&) = delete;

  /// Returns the result of the export, or nothing while it is running. Errors: those of
  /// export_gltf().
  std::optional<Result<exporting::Exported>> result() const;

private:
  std::atomic<bool> stop_ = false;
  std::atomic<bool> done_ = false;
  std::optional<Result<exporting::Exported>> result_; ///< once done_
  std::thread thread_;
};

} // namespace nendo::edit
