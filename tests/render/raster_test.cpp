#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "render/raster.hpp"

namespace raster_test {

using namespace nendo::render;

namespace {

constexpr int side = 64;

struct RasterPlace { // in samples
  double x = 0.0;
  double y = 0.0;
};

GridCorner grid_corner(const RasterPlace& place) {
  return {on_grid(place.x), on_grid(place.y)};
}

/// How often each sample of the square is covered by a grid of quads over it, each cut in two.
/// `corners` has (cells + 1)^2 places.
std::vector<int> covered_by_quads(const std::vector<RasterPlace>& corners, int cells) {
  std::vector<int> covered(side * side);
  const auto cover = [&](int a, int b, int c) {
    const auto corner = [&](int at) { return grid_corner(corners[static_cast<std::size_t>(at)]); };
    const std::array<GridCorner, 3> on{corner(a), corner(b), corner(c)};
    each_covered(on, sample_box(on, side, {0, side}),
                 [&](int x, int y, const std::array<double, 3>& shares) {
                   ++covered[static_cast<std::size_t>(y * side + x)];
                   CHECK(shares[0] + shares[1] + shares[2] == doctest::Approx(1.0));
                 });
  };
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column) {
      const int at = row * (cells + 1) + column;
      cover(at, at + 1, at + cells + 2);         // turning one way
      cover(at, at + cells + 1, at + cells + 2); // and the other
    }
  return covered;
}

int not_covered_once(const std::vector<int>& covered) {
  int wrong = 0;
  for (int y = 4; y < side - 4; ++y) // the square's own edges may be shaken inwards
    for (int x = 4; x < side - 4; ++x)
      wrong += covered[static_cast<std::size_t>(y * side + x)] != 1 ? 1 : 0;
  return wrong;
}

} // namespace

TEST_SUITE("raster") {
  TEST_CASE(
      "triangles that share edges cover each sample of a square once, whatever their corners") {
    constexpr int cells = 5;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> shift(-3.0, 3.0);
    std::bernoulli_distribution coin;
    for (int round = 0; round < 50; ++round) {
      // A grid over the square, corners within shaken about, some on middles of samples.
      std::vector<RasterPlace> corners;
      for (int row = 0; row <= cells; ++row)
        for (int column = 0; column <= cells; ++column) {
          RasterPlace corner{-1.0 + 66.0 * column / cells, -1.0 + 66.0 * row / cells};
          if (row % cells != 0) corner.y += shift(random);
          if (column % cells != 0) corner.x += shift(random);
          if (coin(random)) corner = {std::floor(corner.x) + 0.5, std::floor(corner.y) + 0.5};
          corners.push_back(corner);
        }
      CHECK(not_covered_once(covered_by_quads(corners, cells)) == 0);
    }
  }

  TEST_CASE("triangles smaller than a sample cover each sample once, also at its middle") {
    std::mt19937 random(6);
    for (const int cells : {132, 150, 264}) { // the first and the last have corners on middles
      const double cell = 66.0 / cells;
      for (const double shaken : {0.0, 0.2 * cell}) {
        std::uniform_real_distribution<double> shift(-shaken, shaken);
        std::vector<RasterPlace> corners;
        for (int row = 0; row <= cells; ++row)
          for (int column = 0; column <= cells; ++column)
            corners.push_back(
                {-1.0 + cell * column + shift(random), -1.0 + cell * row + shift(random)});
        CHECK(not_covered_once(covered_by_quads(corners, cells)) == 0);
      }
    }
  }

  TEST_CASE("a coordinate is rounded to 256ths as the mathematical library does it") {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> near(-3.0F, 3.0F);
    std::uniform_real_distribution<float> wide(-1.1e6F, 1.1e6F);
    const auto check = [](float number) {
      const double exact = std::floor(static_cast<double>(number) * 256.0 + 0.5);
      const auto expected =
          std::abs(number) < 0x1p20F ? static_cast<std::int32_t>(exact) : beyond_grid;
      CHECK(on_grid(number) == expected);
      CHECK(on_grid(static_cast<double>(number)) == expected);
    };
    for (int round = 0; round < 2000; ++round) {
      const float number = near(random);
      check(number);
      check(wide(random));
      const float half = (std::floor(number * 256.0F) + 0.5F) / 256.0F;
      for (const float at : {half, std::nextafter(half, -10.0F), std::nextafter(half, 10.0F)})
        check(at);
    }
    for (const float number : {0.0F, -0.0F, 1e-30F, -1e-30F, 0x1p20F, -0x1p20F, 1e38F,
                               std::numeric_limits<float>::infinity()})
      check(number);
    CHECK(on_grid(std::numeric_limits<float>::quiet_NaN()) == beyond_grid);
  }

  TEST_CASE("corners that are no numbers, far away or all in a line cover nothing") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    int covered = 0;
    const auto count = [&](const std::array<RasterPlace, 3>& places) {
      const std::array<GridCorner, 3> on{grid_corner(places[0]), grid_corner(places[1]),
                                         grid_corner(places[2])};
      each_covered(on, sample_box(on, 32, {0, 32}),
                   [&](int, int, const std::array<double, 3>&) { ++covered; });
    };
    for (const double bad : {nan, 1e300, -1e300, std::numeric_limits<double>::infinity()})
      count({RasterPlace{1, 1}, {30, 2}, {bad, 30}});
    count({RasterPlace{1, 1}, {10, 10}, {20, 20}});
    CHECK(covered == 0);
  }
}

} // namespace raster_test
