#include "takes/joint_study.hpp"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

namespace joint_study_test {

using namespace nendo;
using hand::Angle;

namespace {

/// All joints of a hand that closes and opens by two motions that have nothing in common: fingers
/// bend, DIP joints by two thirds of PIP joints, while the thumb goes its own way.
std::vector<hand::JointAngles> two_motions(std::size_t samples, double noise_rad) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, noise_rad > 0.0 ? noise_rad : 1.0);
  std::vector<hand::JointAngles> angles(samples);
  for (std::size_t at = 0; at < samples; ++at) {
    const double time_s = static_cast<double>(at) / 100.0;
    const double curl = 0.6 + 0.5 * std::sin(time_s), thumb = 0.4 + 0.3 * std::cos(2.0 * time_s);
    for (hand::FingerAngles& finger : angles[at].fingers)
      finger = {0.5 * curl, 0.0, curl, 2.0 / 3.0 * curl};
    angles[at].thumb_mcp_flexion_rad = thumb;
    angles[at].thumb_ip_flexion_rad = 0.5 * thumb;
    if (noise_rad > 0.0)
      for (std::size_t angle = 0; angle < hand::angle_count; ++angle)
        angles[at][hand::angle_at(angle)] += noise(random);
  }
  return angles;
}

const takes::JointPair& pair_of(const takes::JointStudy& study, Angle one, Angle other) {
  for (const takes::JointPair& pair : study.pairs)
    if (pair.one == one && pair.other == other) return pair;
  FAIL("no such pair");
  return study.pairs.front();
}

} // namespace

TEST_SUITE("joint_study") {
  TEST_CASE("ranges, couplings and components are those of the motion") {
    // Whole turns of both motions.
    const auto study = takes::study_joints(two_motions(6283, 0.0), sensors_22);
    CHECK(study.samples == 6283);
    const takes::JointRange& pip = study.ranges[hand::index_of(Angle::ring_pip_flexion)];
    CHECK(pip.source == hand::AngleSource::measured);
    CHECK(pip.min_rad == doctest::Approx(0.1).epsilon(1e-3));
    CHECK(pip.max_rad == doctest::Approx(1.1).epsilon(1e-3));
    CHECK(pip.median_rad == doctest::Approx(0.6).epsilon(1e-2));
    // A sine is below -cos(5 % of half a turn) for 5 % of the time.
    CHECK(pip.low_rad == doctest::Approx(0.6 - 0.5 * std::cos(0.05 * M_PI)).epsilon(1e-2));
    CHECK(pip.beyond == 0.0);
    CHECK(pip.noise_rad < 1e-4);
    const auto& dip = pair_of(study, Angle::ring_pip_flexion, Angle::ring_dip_flexion);
    CHECK(dip.correlation == doctest::Approx(1.0));
    CHECK(dip.slope == doctest::Approx(2.0 / 3.0));
    CHECK(pair_of(study, Angle::index_mcp_flexion, Angle::middle_mcp_flexion).correlation ==
          doctest::Approx(1.0));
    REQUIRE(study.components.size() > 2);
    CHECK(study.components[0] < 0.999);
    CHECK(study.components[1] == doctest::Approx(1.0)); // two motions, two components
    CHECK(study.components.back() == doctest::Approx(1.0));
  }

  TEST_CASE("noise is reported although the hand moves") {
    for (const double noise_rad : {0.002, 0.01}) {
      const auto study = takes::study_joints(two_motions(4000, noise_rad), sensors_22);
      for (const Angle angle : {Angle::index_pip_flexion, Angle::thumb_ip_flexion})
        // The calmest quarter of windows is a little calmer than the mean.
        CHECK(study.ranges[hand::index_of(angle)].noise_rad ==
              doctest::Approx(0.9 * noise_rad).epsilon(0.15));
    }
  }

  TEST_CASE("what lies beyond the published range is counted") {
    auto angles = two_motions(1000, 0.0);
    for (std::size_t at = 0; at < 250; ++at)
      angles[at].fingers[0].pip_flexion_rad = 1.95; // 112 degrees
    const auto study = takes::study_joints(angles, sensors_22);
    CHECK(study.ranges[hand::index_of(Angle::index_pip_flexion)].beyond == 0.25);
  }

  TEST_CASE("a glove with 18 sensors has no DIP joints to compare, and a still hand no pairs") {
    const auto study = takes::study_joints(two_motions(1000, 0.0), sensors_18);
    CHECK(hand::is_estimated(study.ranges[hand::index_of(Angle::index_dip_flexion)].source));
    for (const takes::JointPair& pair : study.pairs)
      CHECK(pair.other != Angle::index_dip_flexion);
    const auto still = takes::study_joints(std::vector<hand::JointAngles>(100), sensors_22);
    CHECK(still.pairs.empty());
    CHECK(still.components.empty());
    CHECK(takes::study_joints(std::vector<hand::JointAngles>{}, sensors_22).samples == 0);
    CHECK(takes::study_joints(std::vector<hand::JointAngles>(1), sensors_22).samples == 1);
  }
}

} // namespace joint_study_test
