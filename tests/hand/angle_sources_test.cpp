#include <nendo/hand/angle_sources.hpp>

#include <optional>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joint_limits.hpp>

namespace angle_sources_test {

using namespace nendo;
using namespace nendo::hand;

namespace {

/// The sensor that is named after the same joint. Spreading has none: it is sums of gaps.
std::optional<Sensor> own_sensor(Angle angle) {
  constexpr std::array<std::optional<Sensor>, angle_count> own{
      Sensor::thumb_roll, Sensor::thumb_abduction,
      Sensor::thumb_mcp,  Sensor::thumb_ip,
      Sensor::index_mcp,  std::nullopt,
      Sensor::index_pip,  Sensor::index_dip,
      Sensor::middle_mcp, std::nullopt,
      Sensor::middle_pip, Sensor::middle_dip,
      Sensor::ring_mcp,   std::nullopt,
      Sensor::ring_pip,   Sensor::ring_dip,
      Sensor::little_mcp, std::nullopt,
      Sensor::little_pip, Sensor::little_dip,
      Sensor::palm_arch,  Sensor::wrist_pitch,
      Sensor::wrist_yaw};
  return own[index_of(angle)];
}

GloveSample random_sample(SensorMask present, std::mt19937& random) {
  GloveSample sample;
  sample.present = present;
  for (auto& raw : sample.raw)
    raw.value = static_cast<std::uint16_t>(random() % 256);
  return sample;
}

/// The sensors that move each angle in joint_angles() itself, found by trying.
std::array<SensorMask, angle_count> movers(SensorMask present, const Calibration& calibration,
                                           std::mt19937& random) {
  std::array<SensorMask, angle_count> found{};
  for (int round = 0; round < 40; ++round) {
    const GloveSample sample = random_sample(present, random);
    const JointAngles before = joint_angles(sample, calibration);
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      GloveSample other = sample;
      other.raw[slot].value ^= 96U;
      const JointAngles after = joint_angles(other, calibration);
      for (std::size_t n = 0; n < angle_count; ++n) {
        if (after[angle_at(n)] != before[angle_at(n)]) found[n].add(static_cast<Sensor>(slot));
      }
    }
  }
  return found;
}

} // namespace

TEST_SUITE("angle_sources") {
  TEST_CASE("what is said of an angle is what joint_angles does, whatever sensors a glove has") {
    std::mt19937 random(17);
    Calibration calibration = default_calibration();
    calibration.middle_bias = 0.4; // so that everything that can move does
    for (int round = 0; round < 150; ++round) {
      SensorMask present{static_cast<std::uint32_t>(random())};
      if (round % 2 == 0) present.bits &= static_cast<std::uint32_t>(random()); // fewer
      const AngleSources sources = angle_sources(present);
      const auto moved_by = movers(present, calibration, random);
      for (std::size_t n = 0; n < angle_count; ++n) {
        const Angle angle = angle_at(n);
        CAPTURE(name_of(angle));
        CAPTURE(present.bits);
        REQUIRE((moved_by[n].bits == 0) == (sources[n] == AngleSource::zero));
        if (const auto own = own_sensor(angle)) {
          REQUIRE(present.has(*own) == (sources[n] == AngleSource::measured));
          if (present.has(*own))
            REQUIRE(moved_by[n] == SensorMask{1U << static_cast<unsigned>(*own)});
        }
      }
    }
  }

  TEST_CASE("an angle that is assumed zero is zero for any counts") {
    std::mt19937 random(23);
    for (int round = 0; round < 300; ++round) {
      const SensorMask present{static_cast<std::uint32_t>(random() & random())};
      const AngleSources sources = angle_sources(present);
      const JointAngles angles =
          joint_angles(random_sample(present, random), default_calibration());
      for (std::size_t n = 0; n < angle_count; ++n) {
        if (sources[n] == AngleSource::zero) REQUIRE(angles[angle_at(n)] == 0.0);
      }
    }
  }

  TEST_CASE("the rule that is named is the one whose joint the angle follows") {
    // With the named joint's sensor alone the angle is there; it is not without it.
    const auto source = [](Angle angle, std::initializer_list<Sensor> sensors) {
      return angle_sources(mask_of(std::vector<Sensor>(sensors)))[index_of(angle)];
    };
    CHECK(source(Angle::ring_pip_flexion, {Sensor::ring_mcp}) == AngleSource::from_mcp);
    CHECK(source(Angle::ring_mcp_flexion, {Sensor::ring_pip}) == AngleSource::from_pip);
    CHECK(source(Angle::ring_dip_flexion, {Sensor::ring_pip}) == AngleSource::from_pip);
    CHECK(source(Angle::ring_dip_flexion, {Sensor::middle_pip}) == AngleSource::zero);
    CHECK(source(Angle::ring_pip_flexion, {Sensor::ring_dip}) == AngleSource::zero);
    CHECK(source(Angle::thumb_mcp_flexion, {Sensor::thumb_ip}) == AngleSource::from_ip);
    CHECK(source(Angle::thumb_ip_flexion, {Sensor::thumb_mcp}) == AngleSource::from_mcp);
    CHECK(source(Angle::thumb_roll, {Sensor::thumb_ip}) == AngleSource::opposition);
    CHECK(source(Angle::thumb_roll, {Sensor::index_mcp}) == AngleSource::zero);
    CHECK(source(Angle::little_mcp_abduction, {Sensor::ring_little_abduction}) ==
          AngleSource::from_gaps);
    CHECK(source(Angle::little_mcp_abduction,
                 {Sensor::ring_little_abduction, Sensor::middle_ring_abduction}) ==
          AngleSource::measured);
  }

  TEST_CASE(
      "the gloves that were sold measure all but the middle finger's direction and the DIPs") {
    const AngleSources of_22 = angle_sources(sensors_22);
    const AngleSources of_18 = angle_sources(sensors_18);
    for (std::size_t n = 0; n < angle_count; ++n) {
      CAPTURE(angle_names[n]);
      const bool middle = angle_at(n) == Angle::middle_mcp_abduction;
      const bool dip = angle_names[n].find("dip") != std::string_view::npos;
      CHECK(of_22[n] == (middle ? AngleSource::from_gaps : AngleSource::measured));
      if (dip) CHECK(of_18[n] == AngleSource::from_pip);
      if (!dip) CHECK(of_18[n] == of_22[n]);
    }
  }

  TEST_CASE("each source has a name of its own, and estimates are neither measured nor zero") {
    for (std::size_t a = 0; a < angle_source_count; ++a) {
      const auto source = static_cast<AngleSource>(a);
      CHECK_FALSE(name_of(source).empty());
      for (std::size_t b = 0; b < a; ++b)
        CHECK(name_of(source) != name_of(static_cast<AngleSource>(b)));
      CHECK(is_estimated(source) == (name_of(source) != "measured" && name_of(source) != "zero"));
    }
  }
}

} // namespace angle_sources_test
