#include "bench/clay_trial.hpp"

#include <cmath>

#include <doctest/doctest.h>

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
    CHECK(trial.worst_behind_mm == 0.0);
    CHECK(std::abs(trial.last_volume) < 5e-4);
    CHECK(trial.shape.vertices.allFinite());
    CHECK(nendo::test::count_self_intersections(trial.shape) == 0);
  }

  TEST_CASE("slow hands keep the volume at all times") {
    const ClayTrial trial = measure_clay({.level = 4, .speed_m_s = 0.075});
    CHECK(trial.worst_volume < 1.5e-3);
    CHECK(nendo::test::count_self_intersections(trial.shape) == 0);
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
