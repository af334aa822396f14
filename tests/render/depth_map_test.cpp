#include "render/depth_map.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "render/lights.hpp"

namespace depth_map_test {

using namespace nendo::render;
using Eigen::Vector3f;

namespace {

/// A level square plate from -1 to 1, and another one from -2 to 2 that is 1 below it.
Surface two_plates(std::uint32_t cells) {
  Surface plates;
  for (const float half : {1.0F, 2.0F}) {
    const auto first = static_cast<std::uint32_t>(plates.places.size());
    const float cell = 2.0F * half / static_cast<float>(cells);
    for (std::uint32_t row = 0; row <= cells; ++row)
      for (std::uint32_t column = 0; column <= cells; ++column) {
        plates.places.emplace_back(cell * static_cast<float>(column) - half, 1.0F - half,
                                   cell * static_cast<float>(row) - half);
        if (row == cells || column == cells) continue;
        const std::uint32_t at = first + row * (cells + 1) + column;
        const std::uint32_t below = at + cells + 1;
        plates.corners.insert(plates.corners.end(), {at, below, below + 1, at, below + 1, at + 1});
      }
  }
  return plates;
}

/// Whether the light reaches a place of the lower plate, by how far it passes the upper one. No
/// test knows within `close` of the shadow's edge.
std::optional<bool> reached(const Vector3f& place, const Vector3f& toward, float close) {
  const Vector3f above = place - toward * (place.y() / toward.y());
  const float from_edge = std::max(std::abs(above.x()), std::abs(above.z())) - 1.0F;
  if (std::abs(from_edge) < close) return std::nullopt;
  return from_edge > 0.0F;
}

bool is_lit(const DepthMap& map, const Vector3f& place, float slack_m) {
  PlaceBlock block;
  block.x[7] = place.x();
  block.y[7] = place.y();
  block.z[7] = place.z();
  LitBlock lit;
  map.find_lit(block, slack_m, lit);
  return lit[7];
}

} // namespace

TEST_SUITE("depth map") {
  TEST_CASE("a plate shades what is behind it, however small its triangles are") {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> across(-1.9F, 1.9F);
    const std::vector<Vector3f> directions{key_direction.normalized(), Vector3f::UnitY(),
                                           Vector3f(0.3F, 0.9F, -0.2F).normalized(),
                                           Vector3f(-0.6F, 0.5F, 0.1F).normalized()};
    for (const std::uint32_t cells : {1U, 30U, 400U}) { // the last: six triangles a sample
      const Surface plates = two_plates(cells);
      const std::vector<Caster> casters{Caster(plates)};
      for (const Vector3f& toward : directions) {
        const DepthMap map(casters, toward, 256);
        const float slack = 1.5F * map.sample_m();
        for (int round = 0; round < 1000; ++round) {
          const Vector3f below(across(random), -1.0F, across(random));
          const auto expected = reached(below, toward, 3.0F * map.sample_m() / toward.y());
          if (expected) CHECK(is_lit(map, below + slack * Vector3f::UnitY(), slack) == *expected);
          const Vector3f upper(0.5F * across(random), 0.0F, 0.5F * across(random));
          CHECK(is_lit(map, upper + slack * Vector3f::UnitY(), slack));
        }
      }
    }
  }

  TEST_CASE("many places at once are lit as each of them is") {
    const Surface plates = two_plates(20);
    const std::vector<Caster> casters{Caster(plates)};
    const DepthMap map(casters, key_direction.normalized(), 128);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> near(-3.0F, 3.0F);
    PlaceBlock block;
    for (std::size_t at = 0; at < block_places; ++at) {
      block.x[at] = near(random);
      block.y[at] = near(random);
      block.z[at] = near(random);
    }
    block.x[3] = std::numeric_limits<float>::quiet_NaN();
    block.y[4] = std::numeric_limits<float>::infinity();
    block.z[5] = -1e30F;
    LitBlock lit;
    map.find_lit(block, 0.01F, lit);
    int dark = 0;
    for (std::size_t at = 0; at < block_places; ++at) {
      const float part = map.lit_part({block.x[at], block.y[at], block.z[at]}, 0.01F, 0);
      CHECK(lit[at] == (part > 0.5F));
      dark += lit[at] ? 0 : 1;
    }
    CHECK(dark > 20);
    CHECK(lit[3]);
    CHECK(lit[4]);
    CHECK(lit[5]);
  }

  TEST_CASE("without a caster everything is lit") {
    const Surface nothing;
    const std::vector<Caster> casters{Caster(nothing)};
    const DepthMap map(casters, Vector3f::UnitY(), 64);
    CHECK(is_lit(map, {0.0F, 0.0F, 0.0F}, 0.0F));
    CHECK(map.lit_part({0.0F, 0.0F, 0.0F}, 0.0F, 6) == 1.0F);
  }
}

} // namespace depth_map_test
