#include "render/lights.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <nendo/base/units.hpp>

#include "render/exact_trig.hpp"
#include "render/parallel.hpp"

namespace nendo::render {

using Eigen::Vector3f;

namespace {

constexpr int sky_directions = 72;
constexpr std::size_t maps_at_once = 8; // so that they fit a processor's cache
constexpr float ground_light = 0.42F;   // what the ground gives back, of the sky's

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

struct SkyMap {
  Vector3f toward;
  DepthMap map;
};

/// Some places of a surface, and what light they got.
struct LitPlaces {
  std::size_t first = 0; ///< in the surface
  std::size_t count = 0;
  const Surface* surface = nullptr;
  std::vector<float>* sky = nullptr;
  BlockOfFloats light{}, most{}; ///< what there is, and the most that there could be
};

PlaceBlock block_of(const std::vector<Vector3f>& all, std::size_t first, std::size_t count) {
  PlaceBlock block;
  for (std::size_t at = 0; at < count; ++at) {
    block.x[at] = all[first + at].x();
    block.y[at] = all[first + at].y();
    block.z[at] = all[first + at].z();
  }
  return block;
}

// Adds what comes from one direction.
void add_sky(const PlaceBlock& places, const PlaceBlock& normals, const SkyMap& from,
             LitPlaces& to) {
  const float slack = 1.5F * from.map.sample_m();
  const float strength = from.toward.y() > 0.0F ? 1.0F : ground_light;
  PlaceBlock lifted;
  BlockOfFloats facing;
  for (std::size_t at = 0; at < block_places; ++at) {
    const float x = normals.x[at], y = normals.y[at], z = normals.z[at];
    const float along = x * from.toward.x() + (y * from.toward.y() + z * from.toward.z());
    facing[at] = along > 0.0F ? along : 0.0F;
    lifted.x[at] = places.x[at] + slack * x;
    lifted.y[at] = places.y[at] + slack * y;
    lifted.z[at] = places.z[at] + slack * z;
  }
  LitBlock lit;
  from.map.find_lit(lifted, slack, lit);
  for (std::size_t at = 0; at < block_places; ++at) {
    to.most[at] += facing[at];
    to.light[at] += lit[at] ? facing[at] * strength : 0.0F;
  }
}

void add_skies(std::span<const std::optional<SkyMap>> maps, LitPlaces& to) {
  const PlaceBlock places = block_of(to.surface->places, to.first, to.count);
  const PlaceBlock normals = block_of(to.surface->normals, to.first, to.count);
  for (const auto& map : maps)
    add_sky(places, normals, *map, to);
}

constexpr std::size_t dense_places = 250'000; // below, all triangles are cast within a second
constexpr float far_place_m = 1e6F;
constexpr std::uint32_t no_cube = std::numeric_limits<std::uint32_t>::max();

/// The cubes of a grid that have places, numbered as they come.
class Cubes {
public:
  Cubes(std::span<const Vector3f> places, int along)
      : along_(along), numbers_(static_cast<std::size_t>(along) * static_cast<std::size_t>(along) *
                                    static_cast<std::size_t>(along),
                                no_cube) {
    for (const Vector3f& place : places)
      if (is_near(place)) box_.extend(place);
    side_m_ = box_.sizes().maxCoeff() / static_cast<float>(along);
  }

  /// Returns the number of the cube that a place is in.
  std::uint32_t number_of(const Vector3f& place) {
    if (!is_near(place) || !(side_m_ > 0.0F)) return no_cube;
    std::size_t at = 0;
    for (const float from_lowest : Vector3f(place - box_.min()))
      at = at * static_cast<std::size_t>(along_) +
           static_cast<std::size_t>(std::min(along_ - 1, static_cast<int>(from_lowest / side_m_)));
    if (numbers_[at] == no_cube) numbers_[at] = count_++;
    return numbers_[at];
  }
  std::size_t count() const noexcept { return count_; }

private:
  static bool is_near(const Vector3f& place) noexcept {
    return std::abs(place.x()) < far_place_m && std::abs(place.y()) < far_place_m &&
           std::abs(place.z()) < far_place_m;
  }

  int along_;
  Eigen::AlignedBox3f box_; ///< has all near places
  float side_m_ = 0.0F;
  std::vector<std::uint32_t> numbers_;
  std::uint32_t count_ = 0;
};

} // namespace

std::vector<std::vector<float>> sky_parts(std::span<const Caster> casters,
                                          const std::vector<const Surface*>& surfaces,
                                          unsigned threads, int side) {
  std::vector<std::vector<float>> parts(surfaces.size());
  std::vector<LitPlaces> blocks;
  for (std::size_t number = 0; number < surfaces.size(); ++number) {
    const std::size_t count = surfaces[number]->places.size();
    parts[number].resize(count);
    for (std::size_t first = 0; first < count; first += block_places)
      blocks.push_back(
          {first, std::min(block_places, count - first), surfaces[number], &parts[number]});
  }
  const std::vector<Vector3f> toward = directions();
  std::vector<std::optional<SkyMap>> maps(maps_at_once);
  for (std::size_t first = 0; first < toward.size(); first += maps_at_once) {
    const std::size_t count = std::min(maps_at_once, toward.size() - first);
    each_in_parallel(count, threads, [&](std::size_t at) {
      maps[at] = SkyMap{toward[first + at], DepthMap(casters, toward[first + at], side)};
    });
    // Each place takes the directions in one order, so that its sum is the same for any threads.
    each_in_parallel(blocks.size(), threads,
                     [&](std::size_t at) { add_skies(std::span(maps).first(count), blocks[at]); });
  }
  for (const LitPlaces& block : blocks)
    for (std::size_t at = 0; at < block.count; ++at)
      (*block.sky)[block.first + at] =
          block.most[at] > 0.0F ? block.light[at] / block.most[at] : 1.0F;
  return parts;
}

bool is_dense(const Surface& surface) noexcept {
  return surface.places.size() > dense_places;
}

namespace {

/// Places, by the cubes that they are in.
struct Crowds {
  std::vector<std::uint32_t> cube_of; ///< the cube of each place; no_cube: none
  std::vector<Vector3f> means;        ///< the mean of the places in each cube

  Crowds(std::span<const Vector3f> places, int cubes) {
    Cubes grid(places, cubes);
    cube_of.reserve(places.size());
    for (const Vector3f& place : places)
      cube_of.push_back(grid.number_of(place));
    std::vector<Eigen::Vector4d> sums(grid.count(), Eigen::Vector4d::Zero()); // the last: how many
    for (std::size_t at = 0; at < cube_of.size(); ++at)
      if (cube_of[at] != no_cube) sums[cube_of[at]] += places[at].cast<double>().homogeneous();
    for (const Eigen::Vector4d& sum : sums)
      means.emplace_back((sum.head<3>() / sum.w()).cast<float>());
  }
};

/// Returns the triangles whose corners are in three cubes, with these corners in place of the
/// cubes.
template <class CornerOf>
std::vector<std::uint32_t> triangles_between(std::span<const std::uint32_t> corners,
                                             const Crowds& crowds, const CornerOf& corner_of) {
  std::vector<std::uint32_t> coarse;
  for (std::size_t at = 0; at + 2 < corners.size(); at += 3) {
    const std::uint32_t a = crowds.cube_of[corners[at]];
    const std::uint32_t b = crowds.cube_of[corners[at + 1]];
    const std::uint32_t c = crowds.cube_of[corners[at + 2]];
    if (a == b || b == c || c == a || a == no_cube || b == no_cube || c == no_cube) continue;
    coarse.insert(coarse.end(), {corner_of(a), corner_of(b), corner_of(c)});
  }
  return coarse;
}

} // namespace

Surface coarse_surface(const Surface& surface, int cubes) {
  Crowds crowds(surface.places, cubes);
  Surface coarse;
  coarse.material = surface.material;
  coarse.corners =
      triangles_between(surface.corners, crowds, [](std::uint32_t cube) { return cube; });
  coarse.places = std::move(crowds.means);
  return coarse;
}

std::vector<std::uint32_t> coarse_corners(std::span<const Vector3f> places,
                                          std::span<const std::uint32_t> corners, int cubes) {
  const Crowds crowds(places, cubes);
  std::vector<std::uint32_t> nearest(crowds.means.size());
  std::vector<float> least(crowds.means.size(), std::numeric_limits<float>::infinity());
  for (std::size_t at = 0; at < places.size(); ++at) {
    const std::uint32_t cube = crowds.cube_of[at];
    if (cube == no_cube) continue;
    const float square = (places[at] - crowds.means[cube]).squaredNorm();
    if (square >= least[cube]) continue;
    least[cube] = square;
    nearest[cube] = static_cast<std::uint32_t>(at);
  }
  return triangles_between(corners, crowds, [&](std::uint32_t cube) { return nearest[cube]; });
}

namespace {

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

Skies skies_of(const Scene& scene, std::span<const Caster> casters, unsigned threads, int side) {
  const Surface nothing;
  std::vector<const Surface*> surfaces{&scene.model};
  for (const Surface& veil : scene.veils)
    surfaces.push_back(casts(veil) ? &veil : &nothing);
  for (const Surface& ground : scene.grounds)
    surfaces.push_back(&ground);
  auto parts = sky_parts(casters, surfaces, threads, side); // in this order
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

Lighting::Lighting(const Scene& scene, double azimuth_deg, unsigned threads, int samples)
    : scene_(&scene) {
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
      key_shadow.emplace(casters, key, samples);
    else
      skies = skies_of(scene, sky_casters, threads, samples * 5 / 32);
  });
  maps_ = std::make_unique<Maps>(Maps{{key, {1.42F, 1.35F, 1.25F}},
                                      {turned(fill_direction, azimuth_deg), {0.22F, 0.27F, 0.34F}},
                                      {turned(rim_direction, azimuth_deg), {0.62F, 0.66F, 0.72F}},
                                      *std::move(key_shadow),
                                      std::move(skies)});
}

Lighting::~Lighting() = default;
Lighting::Lighting(Lighting&&) noexcept = default;

namespace {

constexpr float ambient = 0.54F;
constexpr float wrapped = 0.12F; // clay scatters a little beyond the terminator
constexpr float shadow_slack_m = 0.004F;
constexpr int shadow_reach = 6;

Vector3f toward_eye(const ShadedPlace& at, const Vector3f& eye) {
  return (eye - at.place).normalized();
}

// The side that is looked at.
Vector3f facing_normal(const ShadedPlace& at, const Vector3f& sight) {
  const float length = at.normal.norm();
  if (!(length > 0.0F)) return sight;
  const Vector3f normal = at.normal / length;
  return normal.dot(sight) < 0.0F ? Vector3f(-normal) : normal;
}

float power(float base, int doublings) noexcept {
  for (int k = 0; k < doublings; ++k)
    base *= base;
  return base;
}

float key_part(const ShadedPlace& at, const Vector3f& normal, const Lighting::Maps& maps) noexcept {
  if (!at.shadowed) return 1.0F;
  return maps.key_shadow.lit_part(at.place + shadow_slack_m * normal, shadow_slack_m, shadow_reach);
}

} // namespace

Vector3f shade(const ShadedPlace& at, const Material& material, const Vector3f& eye,
               const Lighting::Maps& maps) noexcept {
  const Vector3f sight = toward_eye(at, eye);
  const Vector3f normal = facing_normal(at, sight);
  const auto diffuse = [&](const Light& light, float wrap) -> Vector3f {
    const float facing = (normal.dot(light.toward) + wrap) / (1.0F + wrap);
    return std::max(0.0F, facing) * light.colour;
  };
  const float lit = normal.dot(maps.key.toward) > -wrapped ? key_part(at, normal, maps) : 0.0F;
  const float open = 0.35F + 0.65F * at.sky; // lights that have no shadows of their own
  Vector3f light = Vector3f::Constant(ambient * at.sky) + lit * diffuse(maps.key, wrapped) +
                   open * diffuse(maps.fill, 0.3F);
  const float edge = power(1.0F - std::clamp(normal.dot(sight), 0.0F, 1.0F), 1);
  light += open * edge * diffuse(maps.rim, 0.2F);
  const Vector3f half = (maps.key.toward + sight).normalized();
  const float highlight = power(std::max(0.0F, normal.dot(half)), 5);
  return material.colour.cwiseProduct(light) + (material.gloss * lit * highlight) * maps.key.colour;
}

float opacity_of(const ShadedPlace& at, const Material& material, const Vector3f& eye) noexcept {
  const Vector3f sight = toward_eye(at, eye);
  const float across = 1.0F - std::clamp(facing_normal(at, sight).dot(sight), 0.0F, 1.0F);
  return material.opacity + (material.rim_opacity - material.opacity) * across * across * across;
}

float ground_brightness(const ShadedPlace& at, const Material& material, float footprint_m,
                        const Lighting::Maps& maps) noexcept {
  const float away = std::sqrt(at.place.x() * at.place.x() + at.place.z() * at.place.z());
  const float fade = std::clamp(1.25F - 1.25F * away / material.fade_m, 0.0F, 1.0F);
  if (!(fade > 0.0F)) return 1.0F;
  const float lit = key_part(at, Vector3f::UnitY(), maps);
  float brightness = (0.45F + 0.55F * at.sky) * (0.68F + 0.32F * lit);
  // A line as wide as 1.5 mm or a sample, whichever is more; fainter where it was widened.
  constexpr float line_m = 0.0015F;
  const float width = std::max(line_m, footprint_m);
  const auto line = [&](float coordinate) {
    const float cells = coordinate / material.grid_m;
    const float off = std::abs(cells - std::floor(cells + 0.5F)) * material.grid_m;
    return std::clamp((width - off) / width + 0.5F, 0.0F, 1.0F) * line_m / width;
  };
  const float drawn = std::max(line(at.place.x()), line(at.place.z()));
  brightness *= 1.0F - 0.30F * drawn;
  return 1.0F + fade * (brightness - 1.0F);
}

Vector3f background(float height) noexcept {
  const Vector3f top(0.86F, 0.885F, 0.91F);
  const Vector3f bottom(0.70F, 0.70F, 0.695F);
  const float t = height * height * (3.0F - 2.0F * height);
  return top + t * (bottom - top);
}

Pixel encoded(const Vector3f& colour) noexcept {
  Pixel pixel{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    float value = std::max(0.0F, colour[static_cast<Eigen::Index>(channel)]);
    if (value > 0.8F) value = 0.8F + (value - 0.8F) / (1.0F + (value - 0.8F) / 0.2F);
    // sRGB's curve by square roots alone, which every processor rounds alike; within half a step.
    const float root = std::sqrt(value);
    const float root4 = std::sqrt(root);
    const float root8 = std::sqrt(root4);
    const float shown = 0.585122381F * root + 0.783140355F * root4 - 0.368262736F * root8;
    // std::lround() costs a call per channel. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    pixel[channel] = static_cast<std::uint8_t>(std::clamp(shown, 0.0F, 1.0F) * 255.0F + 0.5F);
  }
  return pixel;
}

} // namespace nendo::render
