#include "studio/model_gallery.hpp"

#include <filesystem>
#include <system_error>
#include <utility>

#include <nendo/deform/mesh_file.hpp>

#include "render/picture.hpp"
#include "render/scene.hpp"

namespace nendo::studio {
namespace {

constexpr std::uintmax_t max_bytes = 60'000'000;

std::optional<render::Image> picture_of(const std::string& file) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(file, error);
  if (error || bytes > max_bytes) return std::nullopt;
  const auto mesh = deform::read_mesh(file);
  if (!mesh) return std::nullopt;
  render::SceneFrame frame;
  frame.vertices = mesh->vertices;
  render::Scene scene;
  render::SceneBuilder(*mesh).build(frame, {}, scene);
  constexpr render::View view{24.0, 10.0};
  constexpr render::Size size = ModelGallery::picture_size;
  const render::Camera camera =
      render::framing(scene.outline(), view, 1.0 * size.width / size.height, 0.12);
  return render::draw(render::Lighting(scene, view.azimuth_deg, 1), camera, size, 1);
}

} // namespace

ModelGallery::ModelGallery(const std::vector<std::string>& files) {
  for (const std::string& file : files)
    items_.push_back({file});
  thread_ = std::jthread([this](std::stop_token over) { draw_all(std::move(over)); });
}

ModelGallery::~ModelGallery() = default;

void ModelGallery::draw_all(std::stop_token over) {
  for (Item& item : items_) {
    if (over.stop_requested()) return;
    auto drawn = picture_of(item.file);
    const std::lock_guard lock(mutex_);
    item.drawn = std::move(drawn);
    ++done_;
  }
}

const render::Image* ModelGallery::picture(std::size_t at) const {
  const std::lock_guard lock(mutex_);
  return items_[at].drawn ? &*items_[at].drawn : nullptr;
}

bool ModelGallery::is_complete() const {
  const std::lock_guard lock(mutex_);
  return done_ == items_.size();
}

} // namespace nendo::studio
