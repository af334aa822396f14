#include "bench/clay_trial.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include "bench/clay_kneading.hpp"
#include "support/self_intersections.hpp"

namespace clay_trial_test {

using namespace nendo::bench;

TEST_SUITE("clay_trial") {
  TEST_CASE("both hands at 0.5 m/s leave no depth, no fold and the volume") {
    const ClayTrial trial = measure_clay({.level = 5, .judges_inside = true});
    CHECK(trial.ticks > 10);
    CHECK(trial.constraints > 50.0); // the hands are in contact indeed
    CHECK(trial.penetration_p99_mm < 0.05 * trial.mean_edge_mm);
    CHECK(trial.inside_p99_mm < 0.1 * trial.mean_edge_mm);
    CHECK(trial.max_remaining_path_mm == 0.0);
    CHECK(trial.worst_volume < 1.5e-3);
    CHECK(std::abs(trial.last_volume) < 1e-4);
    CHECK(trial.max_held == 0); // flat hands hold nothing
    CHECK(trial.shape.vertices.allFinite());
    CHECK(nendo::test::count_self_intersections(trial.shape) == 0);
  }

  TEST_CASE("slow hands keep the volume at all times") {
    const ClayTrial trial = measure_clay({.level = 4, .speed_m_s = 0.075});
    CHECK(trial.worst_volume < 1.5e-3);
    CHECK(nendo::test::count_self_intersections(trial.shape) == 0);
  }

  TEST_CASE("clay that would be too soft for hands is made stiffer, and does not fold") {
    const ClayTrial trial = measure_clay({.level = 5, .radius_mm = 10.0});
    CHECK(trial.penetration_p99_mm < 0.05 * trial.mean_edge_mm);
    CHECK(trial.worst_volume < 1.5e-3);
    CHECK(nendo::test::count_self_intersections(trial.shape) == 0);
  }

  TEST_CASE("hands make a flat cake, a bowl and a nose of a ball") {
    const auto size_of = [](const KneadedClay& clay) -> Eigen::Vector3d {
      return clay.shape.vertices.rowwise().maxCoeff() - clay.shape.vertices.rowwise().minCoeff();
    };
    for (const KneadedShape shape : {KneadedShape::cake, KneadedShape::bowl, KneadedShape::nose}) {
      const double before = 2.0 * ClayKneading(shape).ball_radius_mm();
      const KneadedClay clay = knead(shape, {.level = 4});
      CHECK(clay.shape.vertices.allFinite());
      CHECK(nendo::test::count_self_intersections(clay.shape) == 0);
      CHECK(clay.worst_volume < 1.5e-3);
      CHECK(std::abs(clay.last_volume) < 1e-4);
      CHECK(clay.penetration_p99_mm < 0.05);
      const Eigen::Vector3d size = size_of(clay);
      if (shape == KneadedShape::cake) {
        CHECK(size.z() < 0.5 * before);
        CHECK(size.x() > 1.4 * before);
      } else if (shape == KneadedShape::bowl) {
        // A wall all round, and nothing above the bottom in its middle.
        double highest = -1e9;
        for (const auto vertex : clay.shape.vertices.colwise())
          if (vertex.head<2>().norm() < 0.2 * before) highest = std::max(highest, vertex.z());
        CHECK(highest < clay.shape.vertices.row(2).maxCoeff() - 0.4 * before);
      } else {
        CHECK(clay.max_held > 4);
        CHECK(size.x() > before + 15.0);
      }
    }
  }

  // Rolling is chaotic, so nine balls are rolled that differ by rounding.
  TEST_CASE("two palms roll sausages, 2.3 times as long as wide and round to a fifth") {
    std::vector<double> lengths, flatnesses;
    for (int ball = 0; ball < 9; ++ball) {
      const KneadedClay clay =
          knead(KneadedShape::sausage, {.level = 4, .scale = 1.0 + 1e-6 * ball});
      CHECK(nendo::test::count_self_intersections(clay.shape) == 0);
      CHECK(clay.shape.vertices.allFinite());
      CHECK(clay.worst_volume < 1.5e-3);
      CHECK(std::abs(clay.last_volume) < 1e-4);
      CHECK(clay.penetration_p99_mm < 0.05);
      CHECK(clay.turned_rad > 2.0 * std::numbers::pi);
      const Eigen::Vector3d size = extents_mm(clay.shape.vertices);
      lengths.push_back(size.x() / size.y());
      flatnesses.push_back(size.y() / size.z() - 1.0);
    }
    std::ranges::sort(lengths);
    std::ranges::sort(flatnesses);
    CHECK(lengths[4] > 2.3);
    CHECK(flatnesses[4] < 0.2);
  }

  TEST_CASE("triangles of what is kneaded follow its shape, if asked") {
    const KneadedClay clay = knead(KneadedShape::sausage, {.level = 4, .refines = true});
    CHECK(clay.shape.vertices.cols() > 2562);
    CHECK(nendo::test::count_self_intersections(clay.shape) == 0);
    CHECK(clay.worst_volume < 1.5e-3);
    CHECK(clay.penetration_p99_mm < 0.05);
  }

  TEST_CASE("the plain program finds nearly the same pressed shape where no volume is kept") {
    const ClayTrialOptions slow{
        .level = 4, .hands = 1, .speed_m_s = 0.2, .friction = 0.0, .keeps_volume = false};
    const ClayTrial ours = measure_clay(slow);
    const ClayTrial plain = measure_plain_clay(slow);
    CHECK(plain.penetration_p99_mm <= 0.02);
    // Sub-steps and the choice of places differ.
    CHECK(ours.last_volume == doctest::Approx(plain.last_volume).epsilon(0.15));
    const auto gap = (ours.shape.vertices - plain.shape.vertices).colwise().norm();
    CHECK(gap.mean() < 1.5);
  }
}

} // namespace clay_trial_test
