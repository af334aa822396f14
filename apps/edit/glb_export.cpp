#include "edit/glb_export.hpp"

#include <nendo/version.hpp>

#include "export/gltf_export.hpp"
#include "takes/timeline_frames.hpp"

namespace nendo::edit {

GlbExport::GlbExport(const timeline::Timeline& timeline, const deform::Mesh& model,
                     const std::string& path)
    : thread_([this, timeline, model, path] {
        const exporting::OpenFrames open = [&]() -> Result<std::unique_ptr<takes::FrameSource>> {
          auto frames = takes::TimelineFrames::make(timeline, model);
          if (!frames) return frames.error();
          return std::unique_ptr<takes::FrameSource>(*std::move(frames));
        };
        const exporting::Choice choice{.rate_hz = exporting::animators_rate_hz, .stop = &stop_};
        exporting::GltfOptions options;
        options.generator = "Nendo " NENDO_VERSION;
        result_ = exporting::export_gltf(open, choice, options, path);
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
