#include <nendo/hand/calibration_fit.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/held_poses.hpp"
#include "support/rounds.hpp"

namespace calibration_fit_test {

using namespace nendo;
using namespace nendo::hand;
using namespace nendo::test;

namespace {

bool names(const Result<CalibrationFit>& fit, std::string_view what) {
  REQUIRE_FALSE(fit);
  CAPTURE(fit.error().message);
  CHECK(fit.error().code == Errc::bad_input);
  CHECK(fit.error().message.find('\n') == std::string::npos);
  return fit.error().message.find(what) != std::string::npos;
}

} // namespace

TEST_SUITE("calibration_fit") {
  TEST_CASE("poses held exactly give back lines and couplings, whatever the glove") {
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
      const Calibration truth = some_truth(seed);
      const auto readings = exact_readings(truth);
      const auto fit = fit_calibration(readings, Side::right, sensors_22);
      REQUIRE(fit);
      // The default's pull, which is weak beside poses that are known to some degrees.
      CHECK(largest_difference_rad(fit->calibration, truth, readings) < 3.5 * rad);
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        if (!sensors_22.has(static_cast<Sensor>(slot))) continue;
        CAPTURE(std::string(name_of(static_cast<Sensor>(slot))));
        CHECK(fit->sensors[slot].gain_determined);
        CHECK(fit->sensors[slot].residual_rad < 2.5 * rad);
        CHECK(fit->sensors[slot].deviation_rad < 7.0 * rad);
      }
      for (std::size_t k = 0; k < couplings.size(); ++k)
        CHECK(fit->calibration.coupling_gains[k] ==
              doctest::Approx(truth.coupling_gains[k]).epsilon(0.1));
      CHECK(fit->undetermined.bits == 0);
      CHECK(fit->condition > 1.0);
      CHECK(fit->condition < 1000.0);
    }
  }

  TEST_CASE(
      "the more often poses are held exactly, the nearer the fit is, up to what may be habit") {
    const Calibration truth = some_truth(4);
    double before = 1.0;
    for (const int times : {1, 6, 36}) {
      const auto readings = exact_readings(truth, times);
      const double off = largest_difference_rad(fitted(readings), truth, readings);
      CAPTURE(times);
      CHECK(off < before);
      before = off;
    }
    // A habit is 0.6 of the wearers' deviations, 6 degrees where fingers are spread; the default's
    // pull may be taken for one.
    CHECK(before < 4.0 * rad);
  }

  TEST_CASE("two poses give the flexion sensors' lines, and leave the rest at the default") {
    const Calibration truth = some_truth(5);
    const auto readings = quick_readings(truth);
    FitOptions options;
    options.mode = FitMode::quick;
    const auto fit = fit_calibration(readings, Side::right, sensors_22, options);
    REQUIRE(fit);
    const Calibration start = default_calibration();
    for (const Sensor sensor : {Sensor::index_mcp, Sensor::ring_pip, Sensor::little_dip}) {
      CHECK(fit->sensors[slot_of(sensor)].gain_determined);
      CHECK(fit->calibration[sensor].gain_rad_per_count ==
            doctest::Approx(truth[sensor].gain_rad_per_count).epsilon(0.02));
    }
    for (const Sensor sensor : {Sensor::wrist_yaw, Sensor::wrist_pitch, Sensor::palm_arch,
                                Sensor::thumb_roll, Sensor::index_middle_abduction}) {
      CHECK(fit->undetermined.has(sensor));
      CHECK_FALSE(fit->sensors[slot_of(sensor)].gain_determined);
      CHECK(fit->calibration[sensor].gain_rad_per_count == start[sensor].gain_rad_per_count);
      CHECK(fit->sensors[slot_of(sensor)].offset_determined); // by the flat hand
      const double flat = readings[0].held.mean_counts[slot_of(sensor)];
      CHECK(fit->calibration[sensor].offset_counts == doctest::Approx(flat).epsilon(0.02));
    }
    CHECK_FALSE(fit->undetermined.has(Sensor::index_mcp));
    CHECK(fit->calibration.coupling_gains == start.coupling_gains);
  }

  TEST_CASE("what no pose shows stays at the default to the last bit, and is said") {
    const Calibration truth = some_truth(6);
    auto readings = exact_readings(truth);
    std::erase_if(readings, [](const PoseReading& reading) {
      return reading.pose == PoseId::wrist_down || reading.pose == PoseId::wrist_back;
    });
    const auto fit = fit_calibration(readings, Side::right, sensors_22);
    REQUIRE(fit);
    CHECK(fit->undetermined.bits == 1U << slot_of(Sensor::wrist_pitch));
    CHECK(fit->calibration[Sensor::wrist_pitch].gain_rad_per_count ==
          default_calibration()[Sensor::wrist_pitch].gain_rad_per_count);
    CHECK(fit->sensors[slot_of(Sensor::wrist_yaw)].gain_determined);
    CHECK(fit->calibration.middle_bias == default_calibration().middle_bias);
  }

  TEST_CASE("touches correct a thumb whose poses were not held as asked") {
    const Calibration truth = some_truth(7);
    const HandSkeleton skeleton(Side::right);
    std::mt19937 random(8);
    auto readings = exact_readings(truth);
    for (auto& reading : readings) { // 10 degrees short, and 6 too far
      SensorAngles angles = exact(reading.pose, random);
      if (reading.pose == PoseId::thumb_up) angles[roll] -= 10.0 * rad;
      if (reading.pose == PoseId::thumb_up || reading.pose == PoseId::thumb_out)
        angles[web] += 6.0 * rad;
      reading.held = held(angles, truth);
    }
    std::vector<PoseReading> touched;
    for (const PoseId id : full_poses()) {
      if (pose_of(id).touch) touched.push_back({id, held(touching(id, skeleton), truth)});
    }
    std::erase_if(readings, [](const auto& reading) { return pose_of(reading.pose).touch; });
    auto with_touches = readings;
    with_touches.insert(with_touches.end(), touched.begin(), touched.end());
    const Calibration without = fitted(readings);
    const auto with = fit_calibration(with_touches, Side::right, sensors_22);
    REQUIRE(with);
    CHECK(largest_difference_rad(with->calibration, truth, touched) <
          0.75 * largest_difference_rad(without, truth, touched));
    for (std::size_t n = readings.size(); n < with_touches.size(); ++n)
      CHECK(with->readings[n].gap_m < 0.004);
  }

  TEST_CASE("loops that were closed stay closed") {
    const auto fit = fit_calibration(exact_readings(some_truth(18)), Side::right, sensors_22);
    REQUIRE(fit);
    for (const ReadingFit& reading : fit->readings)
      CHECK(reading.gap_m < 0.004);
  }

  TEST_CASE("the ends of a free motion correct fists that were held too loosely") {
    const Calibration truth = some_truth(19);
    std::mt19937 random(20);
    std::vector<PoseReading> loose;
    for (const PoseId id : full_poses()) {
      if (pose_of(id).touch) continue;
      SensorAngles angles = exact(id, random);
      for (std::size_t slot = 4; slot < 20; ++slot)
        if (angles[slot] > 50.0 * rad) angles[slot] -= 8.0 * rad;
      loose.push_back({id, held(angles, truth)});
    }
    SensorAngles fully_bent{}; // as the tables say
    fully_bent[1] = 58.0 * rad;
    fully_bent[2] = 79.0 * rad;
    for (std::size_t f = 0; f < 4; ++f) {
      fully_bent[4 * f + 4] = 93.0 * rad;
      fully_bent[4 * f + 5] = 103.0 * rad;
      fully_bent[4 * f + 6] = 81.0 * rad;
    }
    FitOptions options;
    options.free_motion.present = sensors_22;
    options.free_motion.high_counts = counts_at(fully_bent, truth);
    options.free_motion.low_counts.fill(200.0); // which no pose stays above: says nothing
    const std::vector<PoseReading> bent{{PoseId::fist, held(fully_bent, truth)}};
    const double without = largest_difference_rad(fitted(loose), truth, bent);
    CHECK(largest_difference_rad(fitted(loose, options), truth, bent) < without);
    // A motion that stayed behind the poses says nothing, whatever it holds.
    const Calibration plain = fitted(loose);
    for (const double counts : {30.0, -1e300, std::numeric_limits<double>::quiet_NaN()}) {
      options.free_motion.high_counts.fill(counts);
      CHECK(largest_difference_rad(fitted(loose, options), plain, loose) == 0.0);
    }
  }

  TEST_CASE("one pose that was another one does less harm than by least squares") {
    const Calibration truth = some_truth(21);
    auto readings = exact_readings(truth, 2);
    constexpr std::size_t slot = slot_of(Sensor::ring_pip);
    for (auto& reading : readings) {
      if (reading.pose != PoseId::hook) continue;
      reading.held.mean_counts[slot] = readings[0].held.mean_counts[slot]; // straight
      break;
    }
    const auto fit = fit_calibration(readings, Side::right, sensors_22);
    REQUIRE(fit);
    const auto whole = fit_calibration(exact_readings(truth, 2), Side::right, sensors_22);
    REQUIRE(whole);
    // The mean of the bent poses, of which there are a dozen, would be off by their twelfth part.
    const double counts = readings[1].held.mean_counts[slot] /* the fist's */;
    const auto angle = [&](const Calibration& of) {
      return of.sensors[slot].gain_rad_per_count * (counts - of.sensors[slot].offset_counts);
    };
    CHECK(std::abs(angle(fit->calibration) - angle(whole->calibration)) < 98.0 * rad / 12.0 / 2.0);
  }

  TEST_CASE("the order of the readings is of no consequence") {
    auto readings = exact_readings(some_truth(9));
    const Calibration in_order = fitted(readings);
    std::mt19937 random(10);
    std::shuffle(readings.begin(), readings.end(), random);
    CHECK(largest_difference_rad(fitted(readings), in_order, readings) < 1e-7);
  }

  TEST_CASE("a finer converter of the same glove gets the same angles, with smaller gains") {
    const auto readings = exact_readings(some_truth(11));
    auto fine = readings;
    const double ratio = 4095.0 / 255.0;
    for (auto& reading : fine) {
      for (double& counts : reading.held.mean_counts)
        counts *= ratio;
    }
    FitOptions options;
    options.scale.max_count = 4095;
    const Calibration coarse_fit = fitted(readings), fine_fit = fitted(fine, options);
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      CHECK(fine_fit.sensors[slot].gain_rad_per_count * ratio ==
            doctest::Approx(coarse_fit.sensors[slot].gain_rad_per_count).epsilon(1e-6));
      CHECK(fine_fit.sensors[slot].offset_counts / ratio ==
            doctest::Approx(coarse_fit.sensors[slot].offset_counts).epsilon(1e-6));
    }
  }

  TEST_CASE("a left hand that sends the same counts gets the same calibration") {
    auto readings = exact_readings(some_truth(12));
    std::mt19937 random(13);
    for (const PoseId id : {PoseId::pinch_index, PoseId::thumb_across})
      readings.push_back({id, held(exact(id, random), some_truth(12))});
    CHECK(largest_difference_rad(fitted(readings, {}, Side::left),
                                 fitted(readings, {}, Side::right), readings) < 1e-7);
  }

  TEST_CASE("holding the poses again makes the angles surer, but for what is habit") {
    const auto once = exact_readings(some_truth(14));
    auto often = once;
    for (int n = 0; n < 3; ++n)
      often.insert(often.end(), once.begin(), once.end());
    const auto a = fit_calibration(once, Side::right, sensors_22);
    const auto b = fit_calibration(often, Side::right, sensors_22);
    REQUIRE(a);
    REQUIRE(b);
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      if (!sensors_22.has(static_cast<Sensor>(slot))) continue;
      const double times = b->sensors[slot].deviation_rad / a->sensors[slot].deviation_rad;
      // Four times the evidence is half the deviation, but for the default's little part.
      CHECK(times < 0.9);
      CHECK(times > 0.5);
    }
  }

  TEST_CASE("gloves with fewer sensors, and those that know their range, are calibrated, too") {
    SensorMask curls;
    for (const Sensor sensor : {Sensor::thumb_mcp, Sensor::index_mcp, Sensor::middle_mcp,
                                Sensor::ring_mcp, Sensor::little_mcp})
      curls.add(sensor);
    FitOptions options;
    options.scale = {1000, true};
    std::vector<PoseReading> readings(2);
    readings[0].held.present = readings[1].held.present = curls;
    readings[1].pose = PoseId::fist;
    readings[1].held.mean_counts.fill(1000.0); // the end of the scale is no fault here
    const auto fit = fit_calibration(readings, Side::left, curls, options);
    REQUIRE(fit);
    const double fist = pose_of(PoseId::fist).assumed[slot_of(Sensor::ring_mcp)].angle_rad;
    CHECK(fit->calibration[Sensor::ring_mcp].angle_rad(RawCount{1000}) ==
          doctest::Approx(fist).epsilon(0.02));
    CHECK(std::abs(fit->calibration[Sensor::ring_mcp].angle_rad(RawCount{0})) < 1.0 * rad);
    const auto eighteen = fit_calibration(exact_readings(some_truth(15)), Side::left, sensors_18);
    REQUIRE(eighteen);
    CHECK(eighteen->undetermined.bits == 0);
  }

  TEST_CASE("what cannot be a wearer's poses is refused, in one line that names it") {
    const Calibration truth = some_truth(16);
    const auto good = exact_readings(truth);
    const auto fit = [](const std::vector<PoseReading>& readings, SensorMask mask = sensors_22,
                        const FitOptions& options = {}) {
      return fit_calibration(readings, Side::right, mask, options);
    };
    CHECK(names(fit({}), "flat"));
    CHECK(names(fit({good[0]}), "fist"));
    CHECK(names(fit(good, SensorMask{}), "sensors"));
    FitOptions options;
    options.scale.max_count = 0;
    CHECK(names(fit(good, sensors_22, options), "scale"));
    options = {};
    options.size.length_m = std::numeric_limits<double>::quiet_NaN();
    CHECK(names(fit(good, sensors_22, options), "long"));

    constexpr std::size_t slot = slot_of(Sensor::ring_pip);
    for (const double counts :
         {0.0, 1.0, 255.0, 256.0, -5.0, 1e300, std::numeric_limits<double>::quiet_NaN(),
          std::numeric_limits<double>::infinity()}) {
      auto bad = good;
      bad[3].held.mean_counts[slot] = counts;
      CHECK(names(fit(bad), "ring_pip"));
      CHECK(names(fit(bad), pose_of(bad[3].pose).name));
    }
    auto lacking = good;
    lacking[1].held.present = sensors_18;
    CHECK(names(fit(lacking), "index_dip"));
    auto unknown = good;
    unknown[2].pose = static_cast<PoseId>(200);
    CHECK(names(fit(unknown), "pose"));
    auto reversed = good;
    for (auto& reading : reversed)
      reading.held.mean_counts[slot] = 255.0 - reading.held.mean_counts[slot];
    CHECK(names(fit(reversed), "ring_pip"));
    auto dead = good;
    for (auto& reading : dead)
      reading.held.mean_counts[slot] = 90.0;
    CHECK(names(fit(dead), "ring_pip"));
    auto exchanged = quick_readings(truth);
    std::swap(exchanged[0].held, exchanged[1].held);
    CHECK_FALSE(fit(exchanged));
  }

  TEST_CASE("random counts under random names give an error or finite numbers") {
    std::mt19937 random(17);
    int fits = 0;
    for (int round = 0; round < test::rounds(12); ++round) {
      const auto sensors =
          round % 2 == 0 ? sensors_22 : SensorMask{static_cast<std::uint32_t>(random())};
      std::vector<PoseReading> readings(2 + random() % 12);
      for (std::size_t n = 0; n < readings.size(); ++n) {
        readings[n].pose =
            n < 2 ? static_cast<PoseId>(n) : static_cast<PoseId>(random() % pose_count);
        readings[n].held.present = sensors;
        for (double& counts : readings[n].held.mean_counts)
          counts = static_cast<double>(round % 3 < 2 ? 100 + random() % 3 + 90 * (n == 1)
                                                     : 2 + random() % 250);
      }
      const auto fit = fit_calibration(readings, Side::right, sensors);
      if (!fit) continue;
      ++fits;
      CHECK(std::isfinite(fit->condition));
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        CHECK(std::isfinite(fit->calibration.sensors[slot].gain_rad_per_count));
        CHECK(std::isfinite(fit->calibration.sensors[slot].offset_counts));
        CHECK(std::isfinite(fit->sensors[slot].residual_rad));
        CHECK(std::isfinite(fit->sensors[slot].deviation_rad));
      }
      for (const double mix : fit->calibration.coupling_gains)
        CHECK(std::isfinite(mix));
    }
    CHECK(fits > 0);
  }
}

} // namespace calibration_fit_test
