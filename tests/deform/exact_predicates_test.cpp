#include "geometry/exact_predicates.hpp"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

namespace exact_predicates_test {

using namespace nendo::deform;

// The reference: coordinates are whole numbers of 24 bits at most, so that 128 bits hold every
// determinant.
__extension__ using Wide = __int128;

int sign(Wide value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

Wide whole(double value) {
  return static_cast<Wide>(std::llround(value));
}

int reference_2d(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return sign((whole(b[0]) - whole(a[0])) * (whole(c[1]) - whole(a[1])) -
              (whole(b[1]) - whole(a[1])) * (whole(c[0]) - whole(a[0])));
}

Wide determinant(const Wide (&m)[3][3]) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

int reference_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
                     const PlanePoint& d) {
  Wide m[3][3];
  const PlanePoint* corners[] = {&a, &b, &c};
  for (int row = 0; row < 3; ++row) {
    for (std::size_t k = 0; k < 2; ++k)
      m[row][k] = whole((*corners[row])[k]) - whole(d[k]);
    m[row][2] = m[row][0] * m[row][0] + m[row][1] * m[row][1];
  }
  return sign(determinant(m));
}

int reference_3d(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c,
                 const SpacePoint& d) {
  Wide m[3][3];
  const SpacePoint* corners[] = {&a, &b, &c};
  for (int row = 0; row < 3; ++row)
    for (std::size_t k = 0; k < 3; ++k)
      m[row][k] = whole((*corners[row])[k]) - whole(d[k]);
  return sign(determinant(m));
}

TEST_SUITE("exact predicates") {
  TEST_CASE("signs are those of whole-number arithmetic, in narrow and wide boxes") {
    std::mt19937 random(7);
    for (const int size : {1, 2, 5, 1000, 1 << 24}) {
      std::uniform_int_distribution<int> coordinate(-size, size);
      const auto plane = [&] {
        return PlanePoint{1.0 * coordinate(random), 1.0 * coordinate(random)};
      };
      const auto space = [&] {
        return SpacePoint{1.0 * coordinate(random), 1.0 * coordinate(random),
                          1.0 * coordinate(random)};
      };
      for (int round = 0; round < 3000; ++round) {
        const PlanePoint a = plane(), b = plane(), c = plane(), d = plane();
        const int turn = orient_2d(a, b, c);
        REQUIRE(turn == reference_2d(a, b, c));
        if (turn > 0) REQUIRE(in_circle(a, b, c, d) == reference_circle(a, b, c, d));
        const SpacePoint p = space(), q = space(), r = space(), s = space();
        REQUIRE(orient_3d(p, q, r, s) == reference_3d(p, q, r, s));
        // Seen from beyond the plane, the same three turn the other way.
        const SpacePoint up{s[0] - p[0], s[1] - p[1], s[2] - p[2]};
        const double scale = std::ldexp(1.0, -std::ilogb(1.0 + size));
        REQUIRE(turn_about(p, q, r, {scale * up[0], scale * up[1], scale * up[2]}) ==
                -reference_3d(p, q, r, s));
      }
    }
  }

  TEST_CASE("the last bit of a coordinate decides, where plain doubles see nothing") {
    // A wide triangle scaled by a power of two keeps its sign; a point of its edge moved by one
    // unit in the last place lies on that side.
    for (const double scale : {1.0, std::ldexp(1.0, -200), std::ldexp(1.0, 200)}) {
      const PlanePoint a{0.5 * scale, 0.5 * scale}, b{12.0 * scale, 12.0 * scale};
      const PlanePoint c{24.0 * scale, 24.0 * scale};
      CHECK(orient_2d(a, b, c) == 0);
      CHECK(orient_2d(a, b, {c[0], std::nextafter(c[1], 1e300)}) == 1);
      CHECK(orient_2d(a, b, {c[0], std::nextafter(c[1], 0.0)}) == -1);
      const PlanePoint east{scale, 0.0}, north{0.0, scale}, west{-scale, 0.0};
      CHECK(in_circle(east, north, west, {0.0, -scale}) == 0);
      CHECK(in_circle(east, north, west, {0.0, std::nextafter(-scale, 0.0)}) == 1);
      CHECK(in_circle(east, north, west, {0.0, std::nextafter(-scale, -1e300)}) == -1);
      const SpacePoint o{0.1 * scale, 0.1 * scale, 0.1 * scale};
      const SpacePoint x{3.0 * scale, 0.1 * scale, 0.1 * scale};
      const SpacePoint y{0.1 * scale, 7.0 * scale, 0.1 * scale};
      CHECK(orient_3d(o, x, y, {scale, scale, 0.1 * scale}) == 0);
      CHECK(orient_3d(o, x, y, {scale, scale, std::nextafter(0.1 * scale, 0.0)}) == 1);
      CHECK(orient_3d(o, x, y, {scale, scale, std::nextafter(0.1 * scale, 1e300)}) == -1);
    }
  }

  TEST_CASE("exchanging two points turns the sign") {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> near(0.0, 1e-12);
    for (int round = 0; round < 2000; ++round) {
      // Almost on a line, and almost in a plane: most of these need the exact sum.
      const auto point = [&](double t) {
        return SpacePoint{0.3 + t * 0.7 + near(random), t * 0.1 + near(random), t + near(random)};
      };
      const SpacePoint a = point(0.1), b = point(0.2), c = point(0.7), d = point(0.9);
      CHECK(orient_3d(a, b, c, d) == -orient_3d(b, a, c, d));
      CHECK(orient_3d(a, b, c, d) == -orient_3d(a, b, d, c));
      const PlanePoint p{a[0], a[1]}, q{b[0], b[1]}, r{c[0], c[1]};
      CHECK(orient_2d(p, q, r) == -orient_2d(q, p, r));
      CHECK(orient_2d(p, q, r) == orient_2d(q, r, p));
    }
  }
}

} // namespace exact_predicates_test
