#include "edit/glb_export.hpp"

#include <nendo/version.hpp>

#include "export/gltf_export.hpp"
#include "takes/timeline_frames.hpp"

namespace nendo::edit {

GlbExport::GlbExport(const timeline::Timeline& timeline, const deform::Mesh& model,
                     const std::string& path)
    : thread_([this, timeline, model, path] {
        const auto frames = takes::TimelineFrames::make(timeline, model);
        const exporting::Choice choice{.rate_hz = exporting::animators_rate_hz, .stop = &stop_};
        exporting::GltfOptions options;
        options.generator = "Nendo " NENDO_VERSION;
        if (frames)
          result_ = exporting::export_gltf(**frames, choice, options, path);
        else
          result_ = frames.error();
        done_ = true;
      }) {}

GlbExport::~GlbExport() {
  stop_ = true;
  thread_.join();
}

std::optional<Result<exporting::Exported>> GlbExport::result() const {
  if (!done_) return std::nullopt;
  return result_;
}

} // namespace nendo::edit
