#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "render/raster.hpp"

namespace raster_test {

using namespace nendo::render;

TEST_SUITE("raster") {
  TEST_CASE(
      "triangles that share edges cover each sample of a square once, whatever their corners") {
    constexpr int side = 64;
    constexpr int cells = 5;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> shift(-3.0, 3.0);
    std::bernoulli_distribution coin;
    for (int round = 0; round < 50; ++round) {
      // A grid over the square, corners within shaken about, some on middles of samples.
      std::vector<RasterCorner> corners;
      for (int row = 0; row <= cells; ++row)
        for (int column = 0; column <= cells; ++column) {
          RasterCorner corner{-1.0 + 66.0 * column / cells, -1.0 + 66.0 * row / cells};
          if (row % cells != 0) corner.y += shift(random);
          if (column % cells != 0) corner.x += shift(random);
          if (coin(random)) corner = {std::floor(corner.x) + 0.5, std::floor(corner.y) + 0.5};
          corners.push_back(corner);
        }
      std::vector<int> covered(side * side);
      const auto cover = [&](int a, int b, int c) {
        const auto corner = [&](int at) { return corners[static_cast<std::size_t>(at)]; };
        each_covered({corner(a), corner(b), corner(c)}, side, {0, side},
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
      int wrong = 0;
      for (int y = 4; y < side - 4; ++y) // the square's own edges may be shaken inwards
        for (int x = 4; x < side - 4; ++x)
          wrong += covered[static_cast<std::size_t>(y * side + x)] != 1 ? 1 : 0;
      CHECK(wrong == 0);
    }
  }

  TEST_CASE("corners that are no numbers, far away or all in a line cover nothing") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    int covered = 0;
    const auto count = [&](int, int, const std::array<double, 3>&) { ++covered; };
    for (const double bad : {nan, 1e300, -1e300, std::numeric_limits<double>::infinity()})
      each_covered({RasterCorner{1, 1}, {30, 2}, {bad, 30}}, 32, {0, 32}, count);
    each_covered({RasterCorner{1, 1}, {10, 10}, {20, 20}}, 32, {0, 32}, count);
    CHECK(covered == 0);
  }
}

} // namespace raster_test
