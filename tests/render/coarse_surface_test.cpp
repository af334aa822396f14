
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include <doctest/doctest.h>

#include "render/lights.hpp"
#include "support/test_meshes.hpp"

namespace coarse_surface_test {

using namespace nendo;
using namespace nendo::render;
using Eigen::Vector3f;

namespace {

/// A sphere with bumps of all sizes and a deep dent, about as large as on the stage.
Surface bumpy(std::uint32_t rings, std::uint32_t sides) {
  const auto mesh = test::sphere(rings, sides, 1.0);
  Surface surface;
  for (Eigen::Index at = 0; at < mesh.vertices.cols(); ++at) {
    const Eigen::Vector3d way = mesh.vertices.col(at);
    const double bumps = 0.05 * std::sin(9.0 * way.x()) * std::sin(8.0 * way.z()) +
                         0.01 * std::sin(40.0 * way.x()) * std::sin(40.0 * way.y());
    const double dent = 0.4 * std::exp(-8.0 * (way - Eigen::Vector3d::UnitX()).squaredNorm());
    surface.places.emplace_back((0.4 * (1.0 + bumps - dent) * way).cast<float>());
  }
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (std::size_t at = mesh.face_starts[face] + 1; at + 1 < mesh.face_starts[face + 1]; ++at)
      surface.corners.insert(surface.corners.end(),
                             {mesh.face_corners[mesh.face_starts[face]], mesh.face_corners[at],
                              mesh.face_corners[at + 1]});
  compute_normals(surface.places, surface.corners, surface.normals);
  return surface;
}

std::vector<float> sky_under(const Surface& caster, const Surface& surface) {
  const std::vector<Caster> casters{Caster(caster)};
  return sky_parts(casters, {&surface}, 2).front();
}

} // namespace

TEST_SUITE("coarse surface") {
  TEST_CASE("the sky that vertices see differs little from that under all triangles") {
    const Surface dense = bumpy(360, 720);
    REQUIRE(is_dense(dense));
    const std::vector<float> exact = sky_under(dense, dense);
    const std::vector<float> seen = sky_under(coarse_surface(dense), dense);
    double sum = 0.0, most = 0.0;
    for (std::size_t at = 0; at < exact.size(); ++at) {
      const double off = std::abs(static_cast<double>(seen[at]) - static_cast<double>(exact[at]));
      sum += off;
      most = std::max(most, off);
    }
    // Seen were 0.0003 and 0.049. What the sky gives is about half of the light, and a picture
    // shows less of a difference than there is in the light.
    CHECK(sum / static_cast<double>(exact.size()) < 0.001);
    CHECK(most < 0.1);
  }

  TEST_CASE("a closed surface stays closed, with far fewer triangles") {
    const Surface dense = bumpy(180, 360);
    const Surface coarse = coarse_surface(dense, 40);
    CHECK(coarse.corners.size() * 4 < dense.corners.size());
    CHECK(!coarse.corners.empty());
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance; // of each edge's two ways
    for (std::size_t at = 0; at < coarse.corners.size(); ++at) {
      const std::uint32_t from = coarse.corners[at];
      const std::uint32_t to = coarse.corners[at % 3 == 2 ? at - 2 : at + 1];
      balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
    int open = 0;
    for (const auto& [edge, ways] : balance)
      open += ways != 0 ? 1 : 0;
    CHECK(open == 0);
  }

  TEST_CASE(
      "coarse corners are places of the surface, and make a closed one with fewer triangles") {
    const Surface dense = bumpy(180, 360);
    const std::vector<std::uint32_t> corners = coarse_corners(dense.places, dense.corners, 40);
    const Surface means = coarse_surface(dense, 40);
    REQUIRE(corners.size() == means.corners.size());
    const float cube_m = 1.0F / 40.0F; // and no more
    float farthest = 0.0F;
    for (std::size_t at = 0; at < corners.size(); ++at) {
      REQUIRE(corners[at] < dense.places.size());
      farthest =
          std::max(farthest, (dense.places[corners[at]] - means.places[means.corners[at]]).norm());
    }
    CHECK(farthest < cube_m);
  }

  TEST_CASE("a part and the rest have each triangle once, where it was, and only its places") {
    const Surface whole = bumpy(12, 24);
    const auto is_high = [&](std::span<const std::uint32_t, 3> corners) {
      return whole.places[corners[0]].y() > 0.1F;
    };
    const Material red{{1.0F, 0.0F, 0.0F}};
    const Surface high = part_of(whole, red, is_high);
    const Surface low = part_of(whole, {}, std::not_fn(is_high));
    CHECK(high.material == red);
    REQUIRE_FALSE(high.is_empty());
    REQUIRE_FALSE(low.is_empty());
    std::size_t of_high = 0, of_low = 0;
    for (std::size_t at = 0; at < whole.corners.size(); at += 3) {
      const bool goes_high = is_high(std::span<const std::uint32_t, 3>(&whole.corners[at], 3));
      const Surface& part = goes_high ? high : low;
      std::size_t& next = goes_high ? of_high : of_low;
      for (std::size_t k = 0; k < 3; ++k, ++next) {
        REQUIRE(next < part.corners.size());
        CHECK(part.places[part.corners[next]] == whole.places[whole.corners[at + k]]);
        CHECK(part.normals[part.corners[next]] == whole.normals[whole.corners[at + k]]);
      }
    }
    CHECK(of_high == high.corners.size());
    CHECK(of_low == low.corners.size());
    std::vector<bool> is_used(high.places.size());
    for (const std::uint32_t corner : high.corners)
      is_used[corner] = true;
    CHECK(std::count(is_used.begin(), is_used.end(), false) == 0);
  }

  TEST_CASE("places that are no numbers or far away are left out, and nothing else") {
    Surface surface = bumpy(10, 20);
    const std::size_t triangles = surface.corners.size();
    CHECK(coarse_surface(surface, 200).corners.size() == triangles);
    surface.places[50].x() = std::numeric_limits<float>::quiet_NaN();
    surface.places[80].y() = 1e30F;
    const Surface coarse = coarse_surface(surface, 200);
    CHECK(coarse.corners.size() < triangles);
    CHECK(coarse.corners.size() > triangles / 2);
    for (const Vector3f& place : coarse.places)
      CHECK(place.norm() < 1.0F);
    CHECK(coarse_surface(Surface()).corners.empty());
    Surface point;
    point.places.assign(3, Vector3f::Ones());
    point.corners = {0, 1, 2};
    CHECK(coarse_surface(point).corners.empty());
  }
}

} // namespace coarse_surface_test
