#include "render/sky_light.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "render/exact_trig.hpp"
#include "render/parallel.hpp"

namespace nendo::render {

using Eigen::Vector3f;

namespace {

constexpr int sky_side = 320;
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
  Cubes(const std::vector<Vector3f>& places, int along)
      : along_(along), numbers_(static_cast<std::size_t>(along) * static_cast<std::size_t>(along) *
                                    static_cast<std::size_t>(along),
                                no_cube) {
    Vector3f highest = -lowest_;
    for (const Vector3f& place : places)
      if (is_near(place)) {
        lowest_ = lowest_.cwiseMin(place);
        highest = highest.cwiseMax(place);
      }
    side_m_ = (highest - lowest_).maxCoeff() / static_cast<float>(along);
  }

  /// Returns the number of the cube that a place is in.
  std::uint32_t number_of(const Vector3f& place) {
    if (!is_near(place) || !(side_m_ > 0.0F)) return no_cube;
    std::size_t at = 0;
    for (const float from_lowest :
         {place.x() - lowest_.x(), place.y() - lowest_.y(), place.z() - lowest_.z()})
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
  Vector3f lowest_ = Vector3f::Constant(far_place_m);
  float side_m_ = 0.0F;
  std::vector<std::uint32_t> numbers_;
  std::uint32_t count_ = 0;
};

} // namespace

std::vector<std::vector<float>> sky_parts(std::span<const Caster> casters,
                                          const std::vector<const Surface*>& surfaces,
                                          unsigned threads) {
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
      maps[at] = SkyMap{toward[first + at], DepthMap(casters, toward[first + at], sky_side)};
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

Surface coarse_surface(const Surface& surface, int cubes) {
  Cubes grid(surface.places, cubes);
  std::vector<std::uint32_t> cube_of;
  cube_of.reserve(surface.places.size());
  for (const Vector3f& place : surface.places)
    cube_of.push_back(grid.number_of(place));
  std::vector<Eigen::Vector4d> sums(grid.count(), Eigen::Vector4d::Zero()); // the last: how many
  for (std::size_t at = 0; at < cube_of.size(); ++at)
    if (cube_of[at] != no_cube) {
      sums[cube_of[at]].head<3>() += surface.places[at].cast<double>();
      sums[cube_of[at]].w() += 1.0;
    }
  Surface coarse;
  coarse.material = surface.material;
  for (const Eigen::Vector4d& sum : sums)
    coarse.places.emplace_back((sum.head<3>() / sum.w()).cast<float>());
  for (std::size_t at = 0; at + 2 < surface.corners.size(); at += 3) {
    const std::uint32_t a = cube_of[surface.corners[at]];
    const std::uint32_t b = cube_of[surface.corners[at + 1]];
    const std::uint32_t c = cube_of[surface.corners[at + 2]];
    if (a == b || b == c || c == a || a == no_cube || b == no_cube || c == no_cube) continue;
    coarse.corners.insert(coarse.corners.end(), {a, b, c});
  }
  return coarse;
}

} // namespace nendo::render
