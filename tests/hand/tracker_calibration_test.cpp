// The mount and the time offset of a tracker, from exercises that this file simulates by itself:
// an arm whose circles vary in size and speed, a mount, noise of the tracker, skin, and an 8-bit
// glove.

#include <nendo/hand/tracker_calibration.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

namespace tracker_calibration_test {

using namespace nendo;
using namespace nendo::hand;
using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;

/// FASTRAK's axes on the stage: its x to the front, its y to the right, its z down.
const Quaterniond z_down(0.5, 0.5, 0.5, -0.5);

struct Scene {
  Side side = Side::right;
  double pose_rate_hz = 120.0;
  double glove_rate_hz = 90.0;
  double duration_s = 10.0;
  double late_s = 0.012; ///< delay of the poses
  double cone_deg = 25.0;
  double narrow = 1.0;     ///< the cone's other axis, relative to the first one
  double unevenness = 0.3; ///< variation of the circles' size and speed
  double noise_mm = 0.8, noise_deg = 0.15;
  double skin_mm = 1.0;
  double heading_deg = 0.0, tilt_deg = 0.0; ///< how the hand lies
  double glove_step_rad = 0.0125;           ///< step of its 8-bit counts
  double glove_noise_rad = 0.006;
  double glove_gain = 1.0;
  double slide_mm = 0.0; ///< the hand moves by this, half-way
  double bad_part = 0.0; ///< share of poses that are mirrored, torn or elsewhere
  bool is_on_hand = false;
  bool has_glove = true;
};

/// A slow motion to and fro, whose length has the root mean square 1.
struct Wander {
  std::array<Vector3d, 12> amplitude, phase;
  std::array<double, 12> hz{};

  explicit Wander(std::mt19937_64& random) {
    std::uniform_real_distribution<double> any(0.0, 1.0);
    for (std::size_t k = 0; k < 12; ++k) {
      hz[k] = 0.1 + 4.0 * any(random);
      for (int axis = 0; axis < 3; ++axis) {
        amplitude[k][axis] = std::sqrt(2.0 / 12.0 / 3.0);
        phase[k][axis] = 2.0 * pi * any(random);
      }
    }
  }
  Vector3d at(double time_s) const {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t k = 0; k < 12; ++k)
      for (int axis = 0; axis < 3; ++axis)
        sum[axis] += amplitude[k][axis] * std::sin(2.0 * pi * hz[k] * time_s + phase[k][axis]);
    return sum;
  }
};

/// One arm with one mount, and what a tracker and a glove say of its exercise.
class Recording {
public:
  Recording(const Scene& scene, std::uint64_t seed) : scene_(scene), random_(seed), skin_(random_) {
    const double lever = between(0.03, 0.09);
    T_station_wrist.translation() = lever * direction() + Vector3d(0.0, 0.0, -0.02);
    T_station_wrist.linear() = AngleAxisd(between(0.0, pi), direction()).toRotationMatrix();
    const double sign = between(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
    stage_hand_ = AngleAxisd(scene.heading_deg * degree, Vector3d::UnitY()) *
                  AngleAxisd(sign * scene.tilt_deg * degree, direction());
    period_s_ = between(1.2, 2.2);
    phase_ = between(0.0, 2.0 * pi);
    slow_ = between(4.0, 7.0);
    wrist_m_ = Vector3d(between(-0.2, 0.2), between(-0.1, 0.1), between(-0.5, -0.3));
    poses_ = poses();
    wrist_ = wrist();
  }

  Result<TrackerCalibration> calibrate() const {
    return calibrate_tracker(
        {scene_.side, z_down, scene_.is_on_hand, poses_,
         scene_.has_glove ? std::span<const WristAngles>(wrist_) : std::span<const WristAngles>()});
  }
  double centre_error_mm(const TrackerCalibration& made) const {
    return 1e3 * (made.mount.T_station_wrist.translation() - T_station_wrist.translation()).norm();
  }
  double turn_error_deg(const TrackerCalibration& made) const {
    const Matrix3d between =
        made.mount.T_station_wrist.linear().transpose() * T_station_wrist.linear();
    return AngleAxisd(between).angle() / degree;
  }
  double late_error_ms(const TrackerCalibration& made) const {
    return 1e3 * std::abs(made.mount.late_s - scene_.late_s);
  }

  Isometry3d T_station_wrist = Isometry3d::Identity();
  std::vector<PoseSample>& poses_of_tracker() { return poses_; }

private:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double normal() { return std::normal_distribution<double>()(random_); }
  Vector3d normals() { return {normal(), normal(), normal()}; }
  Vector3d direction() { return normals().normalized(); }

  /// The joints of the wrist: flexion and radial deviation.
  std::array<double, 2> joints(double time_s) const {
    if (scene_.is_on_hand) return {0.0, 0.0};
    const double u = scene_.unevenness;
    const double phase = phase_ + 2.0 * pi * time_s / period_s_ +
                         u * slow_ / (2.0 * period_s_) * std::sin(2.0 * pi * time_s / slow_);
    const double size =
        scene_.cone_deg * degree * (1.0 + 0.4 * u * std::sin(2.0 * pi * time_s / (0.7 * slow_)));
    return {size * std::sin(phase), size * scene_.narrow * std::cos(phase)};
  }
  /// Radial deviation turns the hand towards the thumb, flexion towards the palm.
  Quaterniond hand_in_forearm(double time_s) const {
    const auto [flexion, radial] = joints(time_s);
    const double left = scene_.side == Side::left ? -1.0 : 1.0;
    return Quaterniond(AngleAxisd(left * radial, Vector3d::UnitY()) *
                       AngleAxisd(-flexion, Vector3d::UnitX()));
  }

  std::vector<PoseSample> poses() {
    std::vector<PoseSample> samples;
    const int count = static_cast<int>(scene_.duration_s * scene_.pose_rate_hz);
    for (int k = 0; k < count; ++k) {
      const double time_s = k / scene_.pose_rate_hz;
      const Quaterniond stage_forearm = stage_hand_ * hand_in_forearm(time_s).conjugate();
      const Quaterniond stage_station =
          stage_forearm * Quaterniond(T_station_wrist.linear()).conjugate();
      Vector3d wrist = wrist_m_ + 1e-3 * scene_.skin_mm * skin_.at(time_s);
      if (time_s > 0.5 * scene_.duration_s) wrist.x() += 1e-3 * scene_.slide_mm;
      const Vector3d stage_place = wrist - stage_station * T_station_wrist.translation();
      Vector3d place = z_down.conjugate() * stage_place + 1e-3 * scene_.noise_mm * normals();
      const Vector3d noise = scene_.noise_deg * degree * normals();
      Quaterniond turn = z_down.conjugate() * stage_station *
                         Quaterniond(AngleAxisd(noise.norm() + 1e-12, noise.normalized()));
      if (between(0.0, 1.0) < scene_.bad_part) spoil(place, turn);
      PoseSample sample;
      sample.measured = HostTime(from_seconds(100.0 + time_s + scene_.late_s));
      sample.arrival = sample.measured;
      sample.position_m = {place.x(), place.y(), place.z()};
      sample.turn_xyzw = {turn.x(), turn.y(), turn.z(), turn.w()};
      samples.push_back(sample);
    }
    return samples;
  }
  void spoil(Vector3d& place, Quaterniond& turn) {
    switch (random_() % 3) {
    case 0:
      place = -place;
      break;
    case 1:
      place += 0.2 * direction();
      turn = Quaterniond(AngleAxisd(between(0.0, pi), direction()));
      break;
    default:
      place.x() = std::numeric_limits<double>::quiet_NaN();
    }
  }

  std::vector<WristAngles> wrist() {
    std::vector<WristAngles> samples;
    const double first_s = -between(0.0, 0.01);
    const int count = static_cast<int>(scene_.duration_s * scene_.glove_rate_hz);
    for (int k = 0; k < count; ++k) {
      const double time_s = first_s + k / scene_.glove_rate_hz;
      const auto measured = [&](double angle) {
        const double read = scene_.glove_gain * angle + scene_.glove_noise_rad * normal();
        return scene_.glove_step_rad * std::round(read / scene_.glove_step_rad);
      };
      const auto [flexion, radial] = joints(time_s);
      samples.push_back(
          {HostTime(from_seconds(100.0 + time_s)), measured(flexion), measured(radial)});
    }
    return samples;
  }

  Scene scene_;
  std::mt19937_64 random_;
  Wander skin_;
  Quaterniond stage_hand_;
  double period_s_ = 2.0, phase_ = 0.0, slow_ = 5.0;
  Vector3d wrist_m_;
  std::vector<PoseSample> poses_;
  std::vector<WristAngles> wrist_;
};

/// The errors over many arms, and how many were refused.
struct Worst {
  double centre_mm = 0.0, turn_deg = 0.0, late_ms = 0.0;
  double median_late_ms = 0.0;
  double centre_95_mm = 0.0; ///< the 95th percentile
  double rms_centre_mm = 0.0;
  int refused = 0, without_time = 0;
  std::string message;
};

Worst worst_of(const std::vector<Scene>& scenes, int seeds, std::uint64_t first_seed) {
  Worst worst;
  std::vector<double> centres, lates;
  for (Scene scene : scenes) {
    for (int k = 0; k < seeds; ++k) {
      scene.side = k % 2 == 0 ? Side::right : Side::left;
      const Recording recording(scene, first_seed + static_cast<std::uint64_t>(k));
      const auto made = recording.calibrate();
      if (!made) {
        ++worst.refused;
        worst.message = made.error().message;
        continue;
      }
      centres.push_back(recording.centre_error_mm(*made));
      worst.turn_deg = std::max(worst.turn_deg, recording.turn_error_deg(*made));
      if (made->report.time_offset == TimeOffset::measured)
        lates.push_back(recording.late_error_ms(*made));
      else
        ++worst.without_time;
    }
  }
  std::sort(centres.begin(), centres.end());
  std::sort(lates.begin(), lates.end());
  if (!lates.empty()) {
    worst.late_ms = lates.back();
    worst.median_late_ms = lates[lates.size() / 2];
  }
  if (!centres.empty()) {
    worst.centre_mm = centres.back();
    worst.centre_95_mm = centres[centres.size() * 19 / 20];
    double square = 0.0;
    for (const double centre_mm : centres)
      square += centre_mm * centre_mm;
    worst.rms_centre_mm = std::sqrt(square / static_cast<double>(centres.size()));
  }
  return worst;
}

Worst worst_of(const Scene& scene, int seeds, std::uint64_t first_seed) {
  return worst_of(std::vector{scene}, seeds, first_seed);
}

/// The same. Checks that each arm gives a mount and a time.
template <class Scenes>
Worst worst_of_all(const Scenes& scenes, int seeds, std::uint64_t first_seed) {
  const Worst worst = worst_of(scenes, seeds, first_seed);
  CAPTURE(worst.message);
  CHECK(worst.refused == 0);
  CHECK(worst.without_time == 0);
  return worst;
}

/// A FASTRAK with one, two and four stations.
std::vector<Scene> fastrak_scenes(double cone_deg, double skin_mm) {
  std::vector<Scene> scenes;
  for (const double rate_hz : {120.0, 60.0, 30.0}) {
    scenes.emplace_back();
    scenes.back().cone_deg = cone_deg;
    scenes.back().skin_mm = skin_mm;
    scenes.back().pose_rate_hz = rate_hz;
  }
  return scenes;
}

} // namespace

TEST_SUITE("tracker calibration") {
  TEST_CASE("with a FASTRAK's noise, the centre is within a millimetre, and the time within 1 ms") {
    const Worst worst = worst_of_all(fastrak_scenes(15.0, 0.0), 20, 1);
    CHECK(worst.centre_mm <= 1.0);
    CHECK(worst.late_ms <= 1.0);
    CHECK(worst.turn_deg <= 0.5);
  }

  TEST_CASE("if skin moves as well, the centre is as near as the best method finds it") {
    // Least squares with the true covariance of skin and noise, the best unbiased method, has a
    // root mean square of 0.58, 0.62 and 0.68 mm for a cone of 15 degrees at the three rates, and
    // in proportion to 1 / sin(cone) for others. Its 95th percentile is 1.0 to 1.4 mm in a cone of
    // 15 degrees, and below a millimetre in 20 degrees.
    constexpr double bound_rms_mm = 0.63;
    for (const double cone_deg : {15.0, 20.0, 30.0}) {
      CAPTURE(cone_deg);
      const Worst worst = worst_of_all(fastrak_scenes(cone_deg, 1.0), 20, 1);
      CHECK(worst.rms_centre_mm <=
            1.1 * bound_rms_mm * std::sin(15.0 * degree) / std::sin(cone_deg * degree));
      CHECK(worst.centre_95_mm <= (cone_deg < 20.0 ? 1.3 : 1.0));
      CHECK(worst.late_ms <= 1.0);
      CHECK(worst.median_late_ms <= 0.3);
      CHECK(worst.turn_deg <= 0.5);
    }
  }

  TEST_CASE("circles of even speed give the time as well, if the hand lies flat") {
    Scene scene;
    scene.unevenness = 0.0;
    const Worst worst = worst_of_all(scene, 20, 100);
    CHECK(worst.centre_mm <= 1.0);
    CHECK(worst.late_ms <= 1.0);
  }

  TEST_CASE("a slow and noisy tracker is late by 5 ms less or more") {
    Scene scene;
    scene.pose_rate_hz = 30.0;
    scene.noise_mm = 3.0;
    scene.noise_deg = 2.5 / std::sqrt(3.0); // in each axis
    const Worst worst = worst_of_all(scene, 20, 200);
    CHECK(worst.median_late_ms <= 2.0);
    CHECK(worst.late_ms <= 5.0);
    CHECK(worst.centre_mm <= 3.0);
  }

  TEST_CASE("lateness has both signs, and the tracker's front need not be the hand's") {
    for (const double late_s : {-0.39, -0.2, -0.03, 0.0, 0.08, 0.3, 0.39}) {
      Scene scene;
      scene.late_s = late_s;
      scene.heading_deg = 500.0 * late_s;
      CAPTURE(late_s);
      const Worst worst = worst_of_all(scene, 4, 300);
      CHECK(worst.late_ms <= 1.0);
      CHECK(worst.turn_deg <= 0.5);
    }
    Scene scene;
    scene.heading_deg = 30.0;
    const auto made = Recording(scene, 310).calibrate();
    REQUIRE(made);
    CHECK(made->report.heading_deg == doctest::Approx(30.0).epsilon(0.02));
  }

  TEST_CASE("a hand that lies a few degrees off flat turns the mount by as much, and no more") {
    Scene scene;
    scene.tilt_deg = 4.0;
    const Worst worst = worst_of_all(scene, 20, 400);
    CHECK(worst.centre_mm <= 1.0);
    CHECK(worst.turn_deg <= 4.5);
    CHECK(worst.median_late_ms <= 4.0);
    CHECK(worst.late_ms <= 20.0);
  }

  TEST_CASE("a glove that measures less than each angle gives the time all the same") {
    Scene scene;
    scene.glove_gain = 0.7;
    const Worst worst = worst_of_all(scene, 20, 500);
    CHECK(worst.late_ms <= 1.0);
    CHECK(worst.turn_deg <= 2.0);
  }

  TEST_CASE("flipped, torn and missing poses are dropped, and counted") {
    Scene scene;
    scene.bad_part = 0.2;
    const Worst worst = worst_of(scene, 20, 600);
    CHECK(worst.refused == 0);
    CHECK(worst.centre_mm <= 1.2);
    CHECK(worst.late_ms <= 1.0);
    const Recording recording(scene, 600);
    const auto made = recording.calibrate();
    REQUIRE(made);
    CHECK(made->report.poses_used + made->report.poses_dropped == 1200);
    CHECK(made->report.poses_dropped == doctest::Approx(240.0).epsilon(0.2));
  }

  TEST_CASE("without a glove the mount has no time, and the hand points to the front") {
    Scene scene;
    scene.has_glove = false;
    const Recording recording(scene, 700);
    const auto made = recording.calibrate();
    REQUIRE(made);
    CHECK(made->report.time_offset == TimeOffset::no_wrist_angles);
    CHECK(made->mount.late_s == 0.0);
    CHECK(recording.centre_error_mm(*made) <= 1.0);
    CHECK(recording.turn_error_deg(*made) <= 5.0); // the mean of the wrist's angles
  }

  TEST_CASE("a glove whose wrist does something else gives no time, and the mount is kept") {
    for (const double gain : {0.0, -1.0}) { // it is still, or it is of the other hand
      Scene scene;
      scene.glove_gain = gain;
      scene.glove_noise_rad = gain == 0.0 ? 0.1 : 0.006;
      const Worst worst = worst_of(scene, 10, 800);
      CAPTURE(gain);
      CHECK(worst.refused == 0);
      CHECK(worst.without_time == 10);
      Recording one(scene, 800);
      CHECK(one.calibrate()->report.time_offset == TimeOffset::not_alike);
      CHECK(worst.centre_mm <= 1.0);
    }
  }

  TEST_CASE("the report says how good the centre is") {
    double square = 0.0, expected = 0.0;
    for (std::uint64_t seed = 900; seed < 930; ++seed) {
      Scene scene;
      scene.cone_deg = 20.0;
      const Recording recording(scene, seed);
      const auto made = recording.calibrate();
      REQUIRE(made);
      CHECK(made->report.cone_deg == doctest::Approx(20.0).epsilon(0.15));
      CHECK(made->report.residual_mm == doctest::Approx(std::sqrt(3 * 0.64 + 1.0)).epsilon(0.1));
      CHECK(made->report.condition >= 1.0);
      CHECK(made->report.correlation > 0.95);
      square += std::pow(recording.centre_error_mm(*made), 2);
      expected += std::pow(made->report.centre_uncertainty_mm, 2);
    }
    CHECK(std::sqrt(square / expected) > 0.5);
    CHECK(std::sqrt(square / expected) < 2.0);
  }

  TEST_CASE("bad exercises are refused, with what to do") {
    const auto refusal = [](auto change) {
      Scene scene;
      change(scene);
      const Worst worst = worst_of(scene, 6, 1000);
      CHECK(worst.refused == 6);
      CHECK(worst.message.find('\n') == std::string::npos);
      return worst.message;
    };
    const auto has = [](const std::string& message, const char* words) {
      CAPTURE(message);
      CHECK(message.find(words) != std::string::npos);
    };
    has(refusal([](Scene& scene) { scene.cone_deg = 6.0; }), "draw larger circles");
    has(refusal([](Scene& scene) {
          scene.cone_deg = 6.0;
          scene.noise_deg = 2.5; // which looks like a larger cone
        }),
        "draw larger circles");
    has(refusal([](Scene& scene) { scene.narrow = 0.1; }), "up and down");
    has(refusal([](Scene& scene) { scene.cone_deg = 0.0; }), "fasten this station to the forearm");
    has(refusal([](Scene& scene) { scene.slide_mm = 25.0; }), "keep the hand in its place");
    has(refusal([](Scene& scene) { scene.duration_s = 2.0; }), "continue for ten seconds");
    has(refusal([](Scene& scene) { scene.duration_s = 0.0; }), "only 0 poses");
    has(refusal([](Scene& scene) { scene.pose_rate_hz = 4.0; }), "only 40 poses");
    has(refusal([](Scene& scene) { scene.bad_part = 1.0; }), "away from metal");
    has(refusal([](Scene& scene) { scene.skin_mm = 40.0; }), "keep the hand");
  }

  TEST_CASE("hostile samples are refused or dropped") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      Recording recording(Scene(), seed);
      std::mt19937_64 random(seed);
      for (PoseSample& sample : recording.poses_of_tracker()) {
        if (random() % 4 != 0) continue;
        const double odd[] = {std::numeric_limits<double>::infinity(), -1e308, 1e300, 0.0,
                              std::numeric_limits<double>::quiet_NaN()};
        sample.position_m[random() % 3] = odd[random() % 5];
        sample.turn_xyzw[random() % 4] = odd[random() % 5];
        if (random() % 8 == 0) sample.measured = HostTime(HostClock::duration(random()));
      }
      const auto made = recording.calibrate();
      if (made) CHECK(recording.centre_error_mm(*made) <= 2.0);
    }
  }

  TEST_CASE("on the back of a still hand the station has a turn alone") {
    Scene scene;
    scene.is_on_hand = true;
    const Worst worst = worst_of(scene, 10, 1100);
    CHECK(worst.refused == 0);
    CHECK(worst.turn_deg <= 0.2);
    Scene moved;
    const Recording recording(moved, 1100);
    TrackerExercise exercise{Side::right, z_down, true, {}, {}};
    Recording copy = recording;
    exercise.poses = copy.poses_of_tracker();
    const auto made = calibrate_tracker(exercise);
    REQUIRE(!made);
    CHECK(made.error().message.find("keep it flat and still") != std::string::npos);
  }

  TEST_CASE("the same exercise gives the same bits") {
    const Recording recording(Scene(), 1200);
    const auto one = recording.calibrate(), other = recording.calibrate();
    REQUIRE(one);
    REQUIRE(other);
    CHECK(one->mount.T_station_wrist.matrix() == other->mount.T_station_wrist.matrix());
    CHECK(one->mount.late_s == other->mount.late_s);
  }
}

} // namespace tracker_calibration_test
