#include "render/light_maps.hpp"

#include <iterator>
#include <optional>
#include <utility>

#include <nendo/base/units.hpp>

#include "render/exact_trig.hpp"
#include "render/parallel.hpp"
#include "render/sky_light.hpp"

namespace nendo::render {

using Eigen::Vector3f;

namespace {

constexpr int shadow_side = 2048;

bool casts(const Surface& surface) {
  return surface.material.opacity > 0.0F;
}

/// `model`, which stands for the scene's, and the hands' skins.
std::vector<Caster> casters_of(const Scene& scene, const Surface& model) {
  std::vector<Caster> casters;
  casters.emplace_back(model);
  for (const Surface& veil : scene.veils)
    if (casts(veil)) casters.emplace_back(veil);
  return casters;
}

Skies skies_of(const Scene& scene, std::span<const Caster> casters, unsigned threads) {
  const Surface nothing;
  std::vector<const Surface*> surfaces{&scene.model};
  for (const Surface& veil : scene.veils)
    surfaces.push_back(casts(veil) ? &veil : &nothing);
  for (const Surface& ground : scene.grounds)
    surfaces.push_back(&ground);
  auto parts = sky_parts(casters, surfaces, threads); // in this order
  const auto first_veil = std::next(parts.begin());
  const auto first_ground = std::next(first_veil, std::ssize(scene.veils));
  Skies skies;
  skies.model = std::move(parts.front());
  skies.veils.assign(std::move_iterator(first_veil), std::move_iterator(first_ground));
  skies.grounds.assign(std::move_iterator(first_ground), std::move_iterator(parts.end()));
  return skies;
}

} // namespace

Vector3f turned(const Vector3f& direction, double azimuth_deg) {
  const auto s = static_cast<float>(exact_sine(from_degrees(azimuth_deg)));
  const auto c = static_cast<float>(exact_cosine(from_degrees(azimuth_deg)));
  return Vector3f(c * direction.x() + s * direction.z(), direction.y(),
                  c * direction.z() - s * direction.x())
      .normalized();
}

Lighting::Lighting(const Scene& scene, double azimuth_deg, unsigned threads) : scene_(&scene) {
  const std::vector<Caster> casters = casters_of(scene, scene.model);
  // A sample of the sky's maps is wider than many triangles of a dense model.
  const Surface coarse = is_dense(scene.model) ? coarse_surface(scene.model) : Surface();
  const std::vector<Caster> sky_casters =
      is_dense(scene.model) ? casters_of(scene, coarse) : casters;
  const Vector3f key = turned(key_direction, azimuth_deg);
  std::optional<DepthMap> key_shadow;
  Skies skies;
  each_in_parallel(2, threads, [&](std::size_t at) { // the first is short, the second has threads
    if (at == 0)
      key_shadow.emplace(casters, key, shadow_side);
    else
      skies = skies_of(scene, sky_casters, threads);
  });
  maps_ = std::make_unique<Maps>(Maps{{key, {1.42F, 1.35F, 1.25F}},
                                      {turned(fill_direction, azimuth_deg), {0.22F, 0.27F, 0.34F}},
                                      {turned(rim_direction, azimuth_deg), {0.62F, 0.66F, 0.72F}},
                                      *std::move(key_shadow),
                                      std::move(skies)});
}

Lighting::~Lighting() = default;
Lighting::Lighting(Lighting&&) noexcept = default;

} // namespace nendo::render
