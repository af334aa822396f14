#include "calibrate/hand_drawing.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "support/rounds.hpp"

namespace limb_canvas_test {

using namespace nendo::calibrate;

namespace {

struct Seen {
  double depth_m = -1e300;
  std::uint8_t part = LimbCanvas::nothing;
};

/// What a ray through a place meets of a limb, found by walking along it in hundreds of balls.
void look(const Limb& limb, double x, double y, Seen& seen) {
  for (int step = 0; step <= 400; ++step) {
    const double t = step / 400.0;
    const double radius = limb.begin_radius + t * (limb.end_radius - limb.begin_radius);
    const double dx = x - (limb.begin.x() + t * (limb.end.x() - limb.begin.x()));
    const double dy = y - (limb.begin.y() + t * (limb.end.y() - limb.begin.y()));
    const double left = radius * radius - dx * dx - dy * dy;
    if (left < 0.0) continue;
    const double depth = limb.begin.z() + t * (limb.end.z() - limb.begin.z()) + std::sqrt(left);
    if (depth > seen.depth_m) seen = {depth, limb.part};
  }
}

Limb random_limb(std::mt19937& random, std::uint8_t part, bool flat) {
  std::uniform_real_distribution<double> place(-0.2, 0.2), radius(0.0, 0.03);
  Limb limb{{place(random), place(random), place(random)},
            {place(random), place(random), place(random)},
            radius(random),
            0.0,
            part};
  limb.end_radius = limb.begin_radius; // so that the nearest ball is the one beside the dot
  if (flat) limb.end.z() = limb.begin.z();
  return limb;
}

} // namespace

TEST_SUITE("limb_canvas") {
  TEST_CASE("a limb covers the dots within its radius, wherever it lies, and no others") {
    std::mt19937 random(1);
    std::size_t covered = 0;
    for (int turn = 0; turn < nendo::test::rounds(30); ++turn) {
      const auto columns = static_cast<int>(1 + random() % 10);
      const auto rows = static_cast<int>(1 + random() % 6);
      LimbCanvas canvas(columns, rows);
      const Limb limb = random_limb(random, 3, true);
      canvas.draw(limb);
      for (int row = 0; row < rows * LimbCanvas::dots_down; ++row)
        for (int column = 0; column < columns * LimbCanvas::dots_across; ++column) {
          const Eigen::Vector2d at = canvas.place_m(column, row);
          Seen seen;
          look(limb, at.x(), at.y(), seen);
          const bool drawn = canvas.part(column, row) == 3;
          if (drawn) ++covered;
          // Between two of the balls the limb is a little wider than they are.
          Limb wider = limb;
          wider.begin_radius = wider.end_radius = limb.begin_radius + 1e-3;
          Seen nearly;
          look(wider, at.x(), at.y(), nearly);
          if (seen.part == 3) REQUIRE(drawn);
          if (nearly.part != 3) REQUIRE_FALSE(drawn);
        }
    }
    CHECK(covered > static_cast<std::size_t>(nendo::test::rounds(200)));
  }

  TEST_CASE("of limbs that overlap the nearest is seen, in whatever order they are drawn") {
    std::mt19937 random(2);
    for (int turn = 0; turn < nendo::test::rounds(4); ++turn) {
      std::vector<Limb> limbs;
      for (std::uint8_t part = 0; part < 5; ++part) {
        limbs.push_back(random_limb(random, part, true));
        limbs.back().begin.z() = limbs.back().end.z() = 0.1 * static_cast<double>(random() % 1000);
      }
      LimbCanvas canvas(12, 6), backwards(12, 6);
      for (const Limb& limb : limbs)
        canvas.draw(limb);
      for (auto limb = limbs.rbegin(); limb != limbs.rend(); ++limb)
        backwards.draw(*limb);
      for (int row = 0; row < 6 * LimbCanvas::dots_down; ++row)
        for (int column = 0; column < 12 * LimbCanvas::dots_across; ++column) {
          REQUIRE(canvas.part(column, row) == backwards.part(column, row));
          const Eigen::Vector2d at = canvas.place_m(column, row);
          Seen seen;
          for (const Limb& limb : limbs)
            look(limb, at.x(), at.y(), seen);
          if (seen.part != LimbCanvas::nothing) REQUIRE(canvas.part(column, row) == seen.part);
        }
    }
  }

  TEST_CASE("limbs outside of the canvas, and such as are none, draw nothing and do no harm") {
    LimbCanvas canvas(10, 5);
    canvas.draw({{5.0, 0.0, 0.0}, {6.0, 0.0, 0.0}, 0.1, 0.1, 1});
    canvas.draw({{0.0, -5.0, 0.0}, {0.0, -6.0, 0.0}, 0.1, 0.1, 1});
    canvas.draw({{-1e300, 1e300, 0.0}, {-1e300, 1e300, 0.0}, 0.1, 0.1, 1});
    const double nan = std::nan("");
    canvas.draw({{nan, nan, nan}, {0.0, nan, 0.0}, nan, 0.1, 1});
    for (int row = -1; row <= 40; ++row)
      for (int column = -1; column <= 40; ++column)
        CHECK(canvas.part(column, row) == LimbCanvas::nothing);
    for (int row = 0; row < 5; ++row)
      for (int column = 0; column < 10; ++column)
        CHECK(canvas.character(column, row) == ' ');
  }
}

} // namespace limb_canvas_test
