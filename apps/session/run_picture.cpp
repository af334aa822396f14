#include "session/run_picture.hpp"

#include <utility>
#include <vector>

#include <nendo/deform/triangles.hpp>

#include "render/picture.hpp"

namespace nendo::session {

using namespace nendo::render;

namespace {

constexpr View view{22.0, 10.0};
constexpr Size panel_size{408, 392};

} // namespace

RunPicture::RunPicture(std::filesystem::path path, const deform::Mesh& model)
    : path_(std::move(path)) {
  if (!path_.empty()) before_ = model;
}

void RunPicture::add(const flow::Frame& frame) {
  if (path_.empty()) return;
  holds_.follow(frame);
  set_hands(frame, holds_, last_);
  if (units_per_metre_ > 0.0) return;
  units_per_metre_ = frame.units_per_metre;
  first_ = last_;
  first_.radius_m = frame.settings.radius_m;
}

Result<void> RunPicture::write(const deform::Mesh& final_shape) {
  if (path_.empty()) return {};
  const SceneBuilder builder(before_, units_per_metre_);
  first_.vertices = before_.vertices;
  last_.vertices = final_shape.vertices;
  Scene before;
  Scene after;
  builder.build(first_, {}, before);
  const bool has_rest = last_rest_.cols() == final_shape.vertices.cols();
  SceneBuilder(has_rest ? deform::with_triangles_of(final_shape, last_rest_) : final_shape,
               units_per_metre_)
      .build(last_, {}, after);
  auto points = before.outline();
  const auto more = after.outline();
  points.insert(points.end(), more.begin(), more.end());
  const Camera camera = framing(points, view, 1.0 * panel_size.width / panel_size.height, 0.04);
  const auto panel = [&](const Scene& scene, const char* caption) {
    return Panel{draw(Lighting(scene, view.azimuth_deg), camera, panel_size), caption};
  };
  return write_png(path_, contact_sheet({panel(before, "Before: both hands take hold"),
                                         panel(after, "After: as they left it")},
                                        2));
}

} // namespace nendo::session
