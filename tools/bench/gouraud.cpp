#include "bench/gouraud.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/lights.hpp"
#include "render/raster.hpp"

namespace nendo::bench {

namespace {

constexpr double nearest_seen_m = 0.01;
constexpr float ambient_light = 0.25F;

/// The diffuse light of one lamp beside the camera, on whichever side of the surface it falls.
Eigen::Vector3f lit_vertex(const render::Surface& surface, std::size_t at,
                           const Eigen::Vector3f& lamp) {
  const float diffuse = std::abs(surface.normals[at].dot(lamp));
  const bool painted = surface.paint && !surface.paint->coats().empty();
  const Eigen::Vector3f& colour = // of several, the first: a vertex has but one
      painted ? surface.paint->coats().front().colour : surface.material.colour;
  const render::Pixel pixel = render::encoded((ambient_light + diffuse) * colour);
  return {static_cast<float>(pixel[0]), static_cast<float>(pixel[1]), static_cast<float>(pixel[2])};
}

} // namespace

GouraudRenderer::GouraudRenderer(render::Size size)
    : image_(size),
      nearest_(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height)) {
  for (int y = 0; y < size.height; ++y)
    empty_row_colours_.push_back(render::encoded(
        render::background(static_cast<float>(y) / static_cast<float>(size.height))));
}

void GouraudRenderer::clear() {
  std::fill(nearest_.begin(), nearest_.end(), 0.0F);
  for (int y = 0; y < image_.size().height; ++y)
    std::fill_n(&image_.at(0, y), image_.size().width,
                empty_row_colours_[static_cast<std::size_t>(y)]);
}

void GouraudRenderer::see(const render::Surface& surface, const render::Camera& camera) {
  const Eigen::Matrix3d rows = camera.axes();
  const Eigen::Vector3d eye = camera.eye();
  const render::Size size = image_.size();
  const double scale = size.height / (2.0 * camera.tangent());
  const double middle_x = size.width * (1.0 + camera.centre) / 2.0;
  const double middle_y = size.height / 2.0;
  // Over the camera's left shoulder.
  const Eigen::Vector3f lamp =
      (rows.transpose() * Eigen::Vector3d(-0.4, 0.5, 0.8)).normalized().cast<float>();
  corners_.resize(surface.places.size());
  for (std::size_t at = 0; at < surface.places.size(); ++at) {
    Corner& corner = corners_[at];
    const Eigen::Vector3d along = rows * (surface.places[at].cast<double>() - eye);
    const double depth = -along.z();
    corner.inverse_depth = 0.0F;
    if (!(depth > nearest_seen_m && std::isfinite(depth))) continue;
    corner.inverse_depth = static_cast<float>(1.0 / depth);
    corner.at = {render::on_grid(middle_x + scale * along.x() / depth),
                 render::on_grid(middle_y - scale * along.y() / depth)};
    corner.colour = lit_vertex(surface, at, lamp);
  }
}

void GouraudRenderer::fill(const std::array<const Corner*, 3>& corners) {
  const int width = image_.size().width;
  const std::array<render::GridCorner, 3> on{corners[0]->at, corners[1]->at, corners[2]->at};
  render::each_covered(
      on, render::sample_box(on, width, {0, image_.size().height}),
      [&](int x, int y, const std::array<double, 3>& shares) {
        float depth = 0.0F;
        Eigen::Vector3f colour = Eigen::Vector3f::Constant(0.5F); // rounds
        for (std::size_t k = 0; k < 3; ++k) {
          const auto share = static_cast<float>(shares[k]);
          depth += share * corners[k]->inverse_depth;
          colour += share * corners[k]->colour;
        }
        float& nearest = nearest_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(x)];
        if (depth <= nearest) return;
        nearest = depth;
        for (std::size_t channel = 0; channel < 3; ++channel)
          image_.at(x, y)[channel] =
              static_cast<std::uint8_t>(colour[static_cast<Eigen::Index>(channel)]);
      });
}

const render::Image& GouraudRenderer::draw(const render::Surface& surface,
                                           const render::Camera& camera) {
  clear();
  see(surface, camera);
  for (std::size_t at = 0; at + 2 < surface.corners.size(); at += 3) {
    std::array<const Corner*, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = &corners_[surface.corners[at + k]];
    if (std::all_of(corners.begin(), corners.end(),
                    [](const Corner* corner) { return corner->inverse_depth > 0.0F; }))
      fill(corners);
  }
  return image_;
}

} // namespace nendo::bench
