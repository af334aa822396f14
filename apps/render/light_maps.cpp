#include "render/light_maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <nendo/base/units.hpp>

#include "render/exact_trig.hpp"
#include "render/raster.hpp"

namespace nendo::render {

using Eigen::Vector3f;

namespace {

constexpr int shadow_side = 2048;
constexpr int sky_side = 320;
constexpr int sky_directions = 72;
constexpr float ground_light = 0.42F; // what the ground gives back, of the sky's

bool casts(const Surface& surface) {
  return surface.material.opacity > 0.0F;
}

// Evenly over the sphere, by the golden angle.
std::vector<Vector3f> directions() {
  std::vector<Vector3f> all;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int at = 0; at < sky_directions; ++at) {
    const double y = 1.0 - 2.0 * (at + 0.5) / sky_directions;
    const double out = std::sqrt(1.0 - y * y);
    all.emplace_back(static_cast<float>(out * exact_cosine(golden * at)), static_cast<float>(y),
                     static_cast<float>(out * exact_sine(golden * at)));
  }
  return all;
}

// Adds what comes from one direction; `sums` holds light and the most there could be.
void add_sky(const Surface& surface, const DepthMap& map, const Vector3f& toward,
             std::vector<std::pair<float, float>>& sums) {
  const float slack = 1.5F * map.sample_m();
  const float strength = toward.y() > 0.0F ? 1.0F : ground_light;
  sums.resize(surface.places.size());
  for (std::size_t at = 0; at < surface.places.size(); ++at) {
    const Vector3f& normal = surface.normals[at];
    const float facing = normal.dot(toward);
    if (!(facing > 0.0F)) continue;
    sums[at].second += facing;
    if (map.is_lit(surface.places[at] + slack * normal, slack)) sums[at].first += facing * strength;
  }
}

std::vector<float> parts_of(const std::vector<std::pair<float, float>>& sums) {
  std::vector<float> parts;
  parts.reserve(sums.size());
  for (const auto& [light, most] : sums)
    parts.push_back(most > 0.0F ? light / most : 1.0F);
  return parts;
}

} // namespace

Vector3f turned(const Vector3f& direction, double azimuth_deg) {
  const auto s = static_cast<float>(exact_sine(from_degrees(azimuth_deg)));
  const auto c = static_cast<float>(exact_cosine(from_degrees(azimuth_deg)));
  return Vector3f(c * direction.x() + s * direction.z(), direction.y(),
                  c * direction.z() - s * direction.x())
      .normalized();
}

DepthMap::DepthMap(const Scene& scene, const Vector3f& toward, int side)
    : corner_(Eigen::Vector2f::Zero()), side_(side),
      nearest_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side),
               std::numeric_limits<float>::lowest()) {
  const Vector3f other = std::abs(toward.y()) < 0.9F ? Vector3f::UnitY() : Vector3f::UnitX();
  rows_.row(0) = other.cross(toward).normalized();
  rows_.row(1) = toward.cross(Vector3f(rows_.row(0).transpose()));
  rows_.row(2) = toward;
  constexpr float far = 1e6F; // what is beyond casts no shadow
  Eigen::Vector2f lowest = Eigen::Vector2f::Constant(far);
  Eigen::Vector2f highest = -lowest;
  const auto count = [&](const Surface& surface) {
    for (const Vector3f& place : surface.places) {
      if (!(place.cwiseAbs().maxCoeff() < far)) continue;
      const Eigen::Vector2f across = rows_.topRows<2>() * place;
      lowest = lowest.cwiseMin(across);
      highest = highest.cwiseMax(across);
    }
  };
  count(scene.model);
  for (const Surface& veil : scene.veils)
    if (casts(veil)) count(veil);
  if (!(lowest.x() < highest.x() || lowest.y() < highest.y())) return;
  sample_m_ = (highest - lowest).maxCoeff() / static_cast<float>(side - 4);
  corner_ = lowest - Eigen::Vector2f::Constant(2.0F * sample_m_);
  cast(scene.model);
  for (const Surface& veil : scene.veils)
    if (casts(veil)) cast(veil);
}

Vector3f DepthMap::on_map(const Vector3f& place) const noexcept {
  const Vector3f along = rows_ * place;
  return {(along.x() - corner_.x()) / sample_m_, (along.y() - corner_.y()) / sample_m_, along.z()};
}

void DepthMap::cast(const Surface& surface) {
  std::vector<Vector3f> places(surface.places.size());
  std::transform(surface.places.begin(), surface.places.end(), places.begin(),
                 [this](const Vector3f& place) { return on_map(place); });
  for (std::size_t at = 0; at + 2 < surface.corners.size(); at += 3) {
    std::array<RasterCorner, 3> corners;
    Vector3f depth;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3f& on = places[surface.corners[at + k]];
      corners[k] = {static_cast<double>(on.x()), static_cast<double>(on.y())};
      depth[static_cast<Eigen::Index>(k)] = on.z();
    }
    each_covered(corners, side_, {0, side_}, [&](int x, int y, const std::array<double, 3>& b) {
      float& nearest = nearest_[static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
                                static_cast<std::size_t>(x)];
      nearest = std::max(nearest, static_cast<float>(b[0]) * depth[0] +
                                      static_cast<float>(b[1]) * depth[1] +
                                      static_cast<float>(b[2]) * depth[2]);
    });
  }
}

bool DepthMap::is_lit(const Vector3f& place, float slack_m) const noexcept {
  return lit_part(place, slack_m, 0) > 0.5F;
}

float DepthMap::lit_part(const Vector3f& place, float slack_m, int reach) const noexcept {
  const Vector3f on = on_map(place);
  const auto limit = static_cast<float>(side_ - 1 - reach);
  const auto edge = static_cast<float>(reach);
  if (!(on.x() >= edge && on.y() >= edge && on.x() < limit && on.y() < limit)) return 1.0F;
  const int x = static_cast<int>(on.x());
  const int y = static_cast<int>(on.y());
  int lit = 0;
  int all = 0;
  for (int dy = -reach; dy <= reach; dy += 2)
    for (int dx = -reach; dx <= reach; dx += 2) {
      ++all;
      const float nearest =
          nearest_[static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(side_) +
                   static_cast<std::size_t>(x + dx)];
      if (nearest <= on.z() + slack_m) ++lit;
    }
  return static_cast<float>(lit) / static_cast<float>(all);
}

Lighting::Lighting(const Scene& scene, double azimuth_deg)
    : scene_(&scene), maps_(std::make_unique<Maps>()) {
  maps_->key = {turned(key_direction, azimuth_deg), {1.42F, 1.35F, 1.25F}};
  maps_->fill = {turned(fill_direction, azimuth_deg), {0.22F, 0.27F, 0.34F}};
  maps_->rim = {turned(rim_direction, azimuth_deg), {0.62F, 0.66F, 0.72F}};
  maps_->key_shadow.emplace_back(scene, maps_->key.toward, shadow_side);
  std::vector<std::pair<float, float>> model;
  std::vector<std::vector<std::pair<float, float>>> veils(scene.veils.size());
  std::vector<std::vector<std::pair<float, float>>> grounds(scene.grounds.size());
  for (const Vector3f& toward : directions()) {
    const DepthMap map(scene, toward, sky_side);
    add_sky(scene.model, map, toward, model);
    for (std::size_t at = 0; at < veils.size(); ++at)
      if (casts(scene.veils[at])) add_sky(scene.veils[at], map, toward, veils[at]);
    for (std::size_t at = 0; at < grounds.size(); ++at)
      add_sky(scene.grounds[at], map, toward, grounds[at]);
  }
  maps_->model_sky = parts_of(model);
  for (const auto& sums : veils)
    maps_->veil_sky.push_back(parts_of(sums));
  for (const auto& sums : grounds)
    maps_->ground_sky.push_back(parts_of(sums));
}

Lighting::~Lighting() = default;
Lighting::Lighting(Lighting&&) noexcept = default;

} // namespace nendo::render
