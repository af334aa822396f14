#include <nendo/sculpting/placing.hpp>

#include <doctest/doctest.h>

#include "support/test_meshes.hpp"

namespace placing_test {

using namespace nendo;

TEST_SUITE("placing") {
  TEST_CASE("the usual radius is a part of the model's longest side, and more of it in clay") {
    for (const double size : {0.02, 3.0}) {
      const auto ball = test::sphere(12, 24, 0.5 * size);
      const auto radius = [&](flow::Mode mode) {
        return deform::min_radius(sculpting::usual_supports(ball, mode)) / size;
      };
      CHECK(radius(flow::Mode::type1) == doctest::Approx(0.2));
      CHECK(radius(flow::Mode::type2) == doctest::Approx(0.2));
      CHECK(radius(flow::Mode::clay) == doctest::Approx(0.32));
    }
  }

  TEST_CASE("pieces of type 2 are short for the radius, whatever the model's unit") {
    for (const double radius : {1e-3, 1.0, 250.0}) {
      flow::SculptorOptions sculptor;
      sculpting::set_supports(deform::one_radius(radius), sculptor);
      CHECK(sculptor.piece_length == doctest::Approx(0.05 * radius));
      CHECK(sculptor.deformer.csrbf.merge_fraction == 0.05);
    }
  }

  TEST_CASE("undo begins with a part of its memory, and never has more than all") {
    const auto ball = test::sphere(12, 24, 1.0);
    for (const std::size_t most : {std::size_t{0}, std::size_t{1000}, std::size_t{1} << 30}) {
      flow::LoopOptions loop;
      sculpting::set_undo_space(ball, most, loop);
      CHECK(loop.sculptor.deformer.undo_bytes + loop.undo_max_bytes == most);
      CHECK(loop.sculptor.deformer.undo_bytes <= std::size_t{64} << 20);
    }
  }
}

} // namespace placing_test
