#include "edit/glb_export.hpp"

#include "export/gltf_export.hpp"
#include "timeline_frames.hpp"

namespace nendo::app {

GlbExport::GlbExport(const timeline::Timeline& timeline, const deform::Mesh& model,
                     const std::string& path)
    : thread_([this, timeline, model, path] {
        const OpenFrames open = [&]() -> Result<std::unique_ptr<FrameSource>> {
          auto frames = TimelineFrames::make(timeline, model);
          if (!frames) return frames.error();
          return std::unique_ptr<FrameSource>(*std::move(frames));
        };
        GltfOptions options;
        options.generator = "Nendo " NENDO_VERSION;
        result_ = export_gltf(open, Choice{.stop = &stop_}, options, path);
        done_ = true;
      }) {}

GlbExport::~GlbExport() {
  stop_ = true;
  thread_.join();
}

std::optional<Result<Exported>> GlbExport::result() const {
  if (!done_) return std::nullopt;
  return result_;
}

} // namespace nendo::app
