#include <nendo/hand/wrist_tracking.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/skeleton.hpp>

#include "support/restraint.hpp"

namespace wrist_tracking_test {

using namespace nendo;
using namespace nendo::hand;
using namespace std::chrono_literals;
using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double tau = 6.283185307179586;
constexpr HostTime begin{1h};

/// A FASTRAK's axes on the stage: x away from the operator, y right, z down.
Quaterniond stage_from_fastrak() {
  Matrix3d turn;
  turn << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  return Quaterniond(turn);
}

Quaterniond about(const Vector3d& axis, double angle_rad) {
  return Quaterniond(AngleAxisd(angle_rad, axis.normalized()));
}
Isometry3d pose_at(const Vector3d& position_m, const Quaterniond& turn = Quaterniond::Identity()) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = position_m;
  pose.linear() = turn.toRotationMatrix();
  return pose;
}
double angle_between(const Isometry3d& a, const Isometry3d& b) {
  return Quaterniond(a.linear()).angularDistance(Quaterniond(b.linear()));
}

PoseSample sample_of(const Isometry3d& T_tracker_station, HostTime time) {
  PoseSample sample;
  sample.arrival = time;
  sample.measured = time - 4ms;
  Vector3d::Map(sample.position_m.data()) = T_tracker_station.translation();
  Eigen::Vector4d::Map(sample.turn_xyzw.data()) = Quaterniond(T_tracker_station.linear()).coeffs();
  return sample;
}

TrackingOptions fastrak_options() {
  TrackingOptions options;
  options.mount = usual_mount(stage_from_fastrak());
  return options;
}

const Isometry3d usual_start = pose_at({0.2, 0.3, 0.1});
const Isometry3d usual_station = pose_at({0.4, 0.2, -0.1});

/// A tracked wrist and a clock. A tick takes one pose.
struct Tracked {
  WristTracking tracking;
  HostTime now = begin;
  bool must_release = false;

  explicit Tracked(const TrackingOptions& options = fastrak_options(),
                   const Isometry3d& T_stage_wrist = usual_start)
      : tracking(options, T_stage_wrist) {}

  const Isometry3d& tick(const std::optional<Isometry3d>& T_tracker_station,
                         HostClock::duration interval = 8ms) {
    now += interval;
    if (T_tracker_station) tracking.take(sample_of(*T_tracker_station, now));
    must_release = tracking.advance(now);
    return tracking.T_stage_wrist();
  }
  /// Ticks with the same pose, until a return is over.
  const Isometry3d& rest(const Isometry3d& T_tracker_station, int ticks = 125) {
    for (int n = 0; n < ticks; ++n)
      tick(T_tracker_station);
    return tracking.T_stage_wrist();
  }
};

/// A hand with straight fingers: the greatest speed of a fingertip between poses of its wrist.
struct FingertipSpeed {
  HandSkeleton skeleton{Side::right, {.length_m = 0.21}};
  std::optional<Eigen::Matrix<double, 3, 5>> last;
  double max_m_s = 0.0;

  void add(const Isometry3d& T_stage_wrist, double interval_s) {
    const auto tips = skeleton.pose({}, T_stage_wrist).fingertip_positions();
    if (last) max_m_s = std::max(max_m_s, (tips - *last).colwise().norm().maxCoeff() / interval_s);
    last = tips;
  }
};

/// Returns whether `a` and `b` differ by a turn about the vertical only.
bool have_same_slopes(const Isometry3d& a, const Isometry3d& b) {
  return (a.linear().row(1) - b.linear().row(1)).norm() < 1e-9;
}

} // namespace

TEST_SUITE("wrist_tracking") {
  TEST_CASE("the usual mount: the station's identity points away from the operator, palm down") {
    Tracked tracked;
    CHECK(tracked.tracking.is_lost());
    CHECK(tracked.tick(usual_station).isApprox(usual_start, 1e-12));
    CHECK_FALSE(tracked.tracking.is_lost());
    // Front, right and down of the transmitter.
    const Vector3d ways[3][2] = {
        {{1, 0, 0}, {0, 0, -1}}, {{0, 1, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, -1, 0}}};
    for (const auto& [way_tracker, way_stage] : ways) {
      const Isometry3d moved = pose_at(usual_station.translation() + 0.005 * way_tracker);
      CHECK((tracked.rest(moved).translation() - usual_start.translation() - 0.005 * way_stage)
                .norm() < 1e-12);
      CHECK(angle_between(tracked.tracking.T_stage_wrist(), usual_start) < 1e-7);
      tracked.rest(usual_station);
    }
    // A transmitter's turn to the right, seen from above, is about its z.
    const Isometry3d turned = usual_station * Isometry3d(about({0, 0, 1}, 0.2));
    CHECK((tracked.rest(turned).linear() - about({0, 1, 0}, -0.2).toRotationMatrix()).norm() <
          1e-9);
  }

  TEST_CASE("the first pose leaves the wrist where it is, and its pitch and roll become true") {
    std::mt19937 random(1);
    std::normal_distribution<double> normal(0.0, 1.0);
    const auto any_turn = [&] {
      const double x = normal(random);
      const double y = normal(random);
      const double z = normal(random);
      return Quaterniond(normal(random), x, y, z).normalized();
    };
    for (int round = 0; round < 200; ++round) {
      const Isometry3d start = pose_at({0.1, 0.2, 0.3}, any_turn());
      const Isometry3d station = pose_at({0.4, 0.2, -0.1}, any_turn());
      Tracked tracked(fastrak_options(), start);
      CHECK(tracked.tick(std::nullopt).isApprox(start, 0.0)); // waits
      FingertipSpeed speed;
      speed.add(start, 0.008);
      for (int n = 0; n < 125; ++n)
        speed.add(tracked.tick(station), 0.008);
      CHECK(speed.max_m_s < 2.1);
      CHECK_FALSE(tracked.must_release);
      CHECK(tracked.tracking.counts().losses == 0);
      const Isometry3d& wrist = tracked.tracking.T_stage_wrist();
      CHECK((wrist.translation() - start.translation()).norm() < 1e-12);
      const Isometry3d unturned =
          pose_at(Vector3d::Zero(), stage_from_fastrak() * Quaterniond(station.linear()) *
                                        stage_from_fastrak().conjugate());
      CHECK(have_same_slopes(wrist, unturned));
      // If both are far from vertical, they point to the same side.
      const Vector3d was = -start.linear().col(2);
      const Vector3d is = -wrist.linear().col(2);
      if (std::max(std::abs(was.y()), std::abs(is.y())) < 0.85)
        CHECK(std::abs(was.x() * is.z() - was.z() * is.x()) +
                  std::max(0.0, -was.x() * is.x() - was.z() * is.z()) <
              1e-9);
    }
  }

  TEST_CASE("recentring places the wrist at once, keeps the vertical, and turns the movements") {
    Tracked tracked;
    const Quaterniond slope = about({0, 1, 0}, 0.3) * about({1, 0, 0}, -0.2);
    const Isometry3d station = pose_at({0.4, 0.2, -0.1}, slope);
    const Isometry3d before = tracked.rest(station);
    for (const double heading_rad : {0.0, 1.0, -2.0, 3.1, tau / 2}) {
      const Isometry3d to = pose_at({-0.4, 0.1, 0.6}, about({0, 1, 0}, heading_rad));
      tracked.tracking.recentre(to);
      const Isometry3d recentred = tracked.tracking.T_stage_wrist();
      CHECK((recentred.translation() - to.translation()).norm() < 1e-12);
      CHECK(have_same_slopes(recentred, before));
      const Vector3d way = about({0, 1, 0}, heading_rad) * Vector3d(0.0, 0.0, -1.0);
      Vector3d ahead = -recentred.linear().col(2);
      ahead.y() = 0.0;
      CHECK((ahead.normalized() - way).norm() < 1e-9);
      CHECK(tracked.tick(station).isApprox(recentred, 1e-12)); // no way back
      // To the front of the transmitter.
      const Isometry3d moved =
          tracked.tick(pose_at(station.translation() + Vector3d(0.002, 0, 0), slope));
      CHECK((moved.translation() - to.translation() - 0.002 * way).norm() < 1e-9);
      tracked.tick(station);
    }
  }

  TEST_CASE("a steep forearm's heading is that of the back of the hand") {
    // From level to straight down, and beyond, about x: the heading does not jump.
    for (double pitch_rad = -1.5; pitch_rad <= 1.5; pitch_rad += 0.1) {
      Tracked tracked;
      // A nose-down turn in the transmitter's axes is about -y.
      tracked.rest(pose_at({0.4, 0.2, -0.1}, about({0, 1, 0}, pitch_rad)));
      const Matrix3d wrist = tracked.tracking.T_stage_wrist().linear();
      CHECK((wrist.col(0) - Vector3d::UnitX()).norm() < 1e-7); // no yaw
    }
  }

  TEST_CASE("recentring before the first pose, and during a loss, moves the waiting wrist") {
    Tracked tracked;
    const Isometry3d elsewhere = pose_at({-0.5, 0.0, 0.3});
    tracked.tracking.recentre(elsewhere);
    CHECK(tracked.tick(std::nullopt).isApprox(elsewhere, 0.0));
    CHECK(tracked.tick(usual_station).isApprox(elsewhere, 1e-12));
    for (int n = 0; n < 20; ++n)
      tracked.tick(std::nullopt);
    REQUIRE(tracked.tracking.is_lost());
    tracked.tracking.recentre(usual_start);
    CHECK(tracked.tick(std::nullopt).isApprox(usual_start, 1e-12));
    CHECK(tracked.tick(usual_station).isApprox(usual_start, 1e-12));
    CHECK_FALSE(tracked.must_release);
  }

  TEST_CASE("a turn about the wrist moves it nowhere, wherever the station is fastened") {
    TrackingOptions options = fastrak_options();
    options.mount.T_station_wrist.translation() = Vector3d(0.06, 0.0, 0.025);
    options.movement_scale = 2.0;
    options.filter.kind = FilterKind::one_euro;
    Tracked tracked(options);
    const Vector3d centre_m(0.5, 0.1, 0.0);
    for (int n = 0; n < 600; ++n) {
      const double phase = tau * n / 250.0;
      const Quaterniond turn =
          about({0, 0, 1}, 0.4 * std::cos(phase)) * about({0, 1, 0}, 0.4 * std::sin(phase));
      const Vector3d station_m = centre_m - turn * options.mount.T_station_wrist.translation();
      REQUIRE((tracked.tick(pose_at(station_m, turn)).translation() - usual_start.translation())
                  .norm() < 1e-12);
    }
    CHECK(tracked.tracking.counts().refused == 0);
  }

  TEST_CASE("movements can be scaled, about the point of the recentring") {
    for (const double scale : {0.5, 1.0, 3.0}) {
      TrackingOptions options = fastrak_options();
      options.movement_scale = scale;
      Tracked tracked(options);
      tracked.rest(usual_station, 50);
      for (int n = 0; n <= 50; ++n)
        tracked.tick(pose_at(usual_station.translation() + Vector3d(0.0, 0.004 * n, 0.0)));
      const Vector3d moved =
          tracked.tracking.T_stage_wrist().translation() - usual_start.translation();
      CHECK((moved - Vector3d(0.2 * scale, 0.0, 0.0)).norm() < 1e-12);
      tracked.tracking.recentre(usual_start);
      for (int n = 50; n >= 0; --n)
        tracked.tick(pose_at(usual_station.translation() + Vector3d(0.0, 0.004 * n, 0.0)));
      const Vector3d back =
          tracked.tracking.T_stage_wrist().translation() - usual_start.translation();
      CHECK((back + Vector3d(0.2 * scale, 0.0, 0.0)).norm() < 1e-12);
    }
  }

  TEST_CASE("without poses the wrist freezes in 0.1 s and a tick, where it was") {
    Tracked tracked;
    for (int n = 0; n < 100; ++n)
      tracked.tick(pose_at(usual_station.translation() + Vector3d(0.004 * n, 0.0, 0.0)));
    const Isometry3d last = tracked.tracking.T_stage_wrist();
    const HostTime silent_since = tracked.now;
    PoseSample bad = sample_of(usual_station, tracked.now);
    bad.turn_xyzw = {0, 0, 0, 0};
    while (!tracked.tracking.is_lost()) {
      bad.arrival = bad.measured = tracked.now;
      tracked.tracking.take(bad); // refused: no sign of life
      REQUIRE(tracked.tick(std::nullopt).matrix() == last.matrix());
    }
    CHECK(tracked.now - silent_since > 100ms);
    CHECK(tracked.now - silent_since <= 108ms);
    CHECK(tracked.tracking.counts().losses == 1);
    for (int n = 0; n < 100; ++n)
      REQUIRE(tracked.tick(std::nullopt).matrix() == last.matrix());
    CHECK(tracked.tracking.counts().losses == 1);
    CHECK(tracked.tracking.counts().refused == 13);
    CHECK(tracked.tracking.latest().turn_xyzw[3] == 1.0);
  }

  TEST_CASE("after a loss the hand goes to the measured pose, no fingertip faster than 3 m/s") {
    for (const double loss_s : {0.15, 0.4, 3.0}) {
      for (const double away_m : {0.0, 0.05, 0.2, 0.6}) {
        for (const double turned_rad : {0.0, 0.7}) {
          for (const FilterKind kind : {FilterKind::off, FilterKind::one_euro}) {
            // Within the gate's tolerance after such a loss.
            if (away_m > 0.3 && loss_s < 0.2) continue;
            TrackingOptions options = fastrak_options();
            options.filter.kind = kind;
            Tracked tracked(options);
            FingertipSpeed speed;
            const auto tick = [&](const std::optional<Isometry3d>& station) {
              speed.add(tracked.tick(station), 0.008);
            };
            for (int n = 0; n < 50; ++n)
              tick(usual_station);
            for (int n = 0; n < loss_s / 0.008; ++n)
              tick(std::nullopt);
            REQUIRE(tracked.tracking.is_lost());
            bool must_release = false;
            int ticks = 0;
            // The hand also moves, at 0.5 m/s.
            const auto station = [&] {
              return pose_at(usual_station.translation() + Vector3d(0.004 * ticks, away_m, 0.0),
                             about({0, 0, 1}, turned_rad));
            };
            for (; ticks < 100; ++ticks) {
              tick(station());
              must_release = must_release || tracked.must_release;
              CHECK_FALSE((tracked.must_release && ticks > 0)); // once
            }
            CAPTURE(loss_s);
            CAPTURE(away_m);
            CAPTURE(turned_rad);
            CHECK(speed.max_m_s < 3.0);
            CHECK(must_release == (away_m > 0.5));
            CHECK_FALSE(tracked.tracking.is_lost());
            CHECK(tracked.tracking.counts().refused == 0);
            const Isometry3d& wrist = tracked.tracking.T_stage_wrist();
            const Vector3d expected =
                usual_start.translation() + Vector3d(away_m, 0.0, -0.004 * 99);
            const double late_m = kind == FilterKind::off ? 1e-9 : 0.5 * 0.02;
            CHECK((wrist.translation() - expected).norm() < late_m);
            CHECK(Quaterniond(wrist.linear()).angularDistance(about({0, 1, 0}, -turned_rad)) <
                  0.02);
          }
        }
      }
    }
  }

  TEST_CASE("a return over a short way takes 0.1 s") {
    Tracked tracked;
    tracked.rest(usual_station, 50);
    for (int n = 0; n < 100; ++n)
      tracked.tick(std::nullopt);
    const Isometry3d station = pose_at(usual_station.translation() + Vector3d(0.0, 0.1, 0.0));
    const Vector3d there = usual_start.translation() + Vector3d(0.1, 0.0, 0.0);
    CHECK(tracked.tick(station).isApprox(usual_start, 1e-12)); // continuous
    const HostTime returned = tracked.now;
    double last_m = 0.1;
    while (tracked.now - returned < 100ms) {
      const double left_m = (tracked.tick(station).translation() - there).norm();
      CHECK(left_m < last_m);
      last_m = left_m;
    }
    CHECK(last_m < 1e-12);
  }

  TEST_CASE("a jump to which the gate gives in is a return without a loss") {
    for (const double away_m : {0.15, 0.4}) {
      Tracked tracked;
      const Isometry3d before = tracked.rest(usual_station, 50);
      const Isometry3d station = pose_at(usual_station.translation() + Vector3d(0.0, away_m, 0.0));
      FingertipSpeed speed;
      speed.add(before, 0.008);
      for (int n = 0; n < 100; ++n) {
        speed.add(tracked.tick(station), 0.008);
        if (n < 6) REQUIRE(tracked.tracking.T_stage_wrist().isApprox(before, 1e-12));
        CHECK(tracked.must_release == (n == 5 && away_m > 0.2));
      }
      CHECK(speed.max_m_s < 2.1);
      CHECK((tracked.tracking.T_stage_wrist().translation() - before.translation()).x() ==
            doctest::Approx(away_m));
      CHECK(tracked.tracking.counts().losses == 0);
      CHECK(tracked.tracking.counts().refused == 5);
    }
  }

  TEST_CASE("a loss during a return freezes the wrist on its way") {
    Tracked tracked;
    tracked.rest(usual_station, 50);
    for (int n = 0; n < 100; ++n)
      tracked.tick(std::nullopt);
    const Isometry3d station = pose_at(usual_station.translation() + Vector3d(0.0, 0.9, 0.0));
    for (int n = 0; n < 5; ++n)
      tracked.tick(station);
    while (!tracked.tracking.is_lost())
      tracked.tick(std::nullopt);
    const Isometry3d frozen = tracked.tracking.T_stage_wrist();
    CHECK(frozen.translation().x() > usual_start.translation().x());
    CHECK(frozen.translation().x() < usual_start.translation().x() + 0.9);
    for (int n = 0; n < 10; ++n)
      REQUIRE(tracked.tick(std::nullopt).matrix() == frozen.matrix());
    CHECK(tracked.tracking.counts().losses == 2);
    CHECK(tracked.tick(station).isApprox(frozen, 1e-12));
  }

  TEST_CASE("crossing the transmitter's hemisphere five times shows in no frame") {
    for (const FilterKind kind : {FilterKind::off, FilterKind::one_euro}) {
      TrackingOptions options = fastrak_options();
      options.filter.kind = kind;
      Tracked tracked(options);
      std::uint64_t beyond = 0;
      for (int n = 0; n < 2500; ++n) { // 20 s
        const Vector3d true_m(0.3 * std::cos(tau * n / 500.0), 0.25, -0.15);
        const bool is_beyond = true_m.x() < 0.0;
        beyond += is_beyond ? 1 : 0;
        const Isometry3d& wrist = tracked.tick(pose_at(is_beyond ? Vector3d(-true_m) : true_m));
        const Vector3d expected = usual_start.translation() + Vector3d(0.0, 0.0, 0.3 - true_m.x());
        REQUIRE((wrist.translation() - expected).norm() < (kind == FilterKind::off ? 1e-9 : 0.012));
      }
      CHECK(tracked.tracking.counts().flips == beyond);
      CHECK(tracked.tracking.counts().refused == 0);
      CHECK(tracked.tracking.counts().losses == 0);
      CHECK(tracked.tracking.counts().poses == 2500);
    }
  }

  TEST_CASE("the same poses and ticks give the same bits, without allocations or locks") {
    TrackingOptions options = fastrak_options();
    options.filter.kind = FilterKind::one_euro;
    std::mt19937 random(9);
    std::normal_distribution<double> noise(0.0, 0.0008);
    std::vector<PoseSample> samples;
    for (int n = 0; n < 2000; ++n) {
      if (n % 500 > 450) continue; // losses
      const Vector3d position_m(0.3 * std::cos(tau * n / 500.0) + noise(random), 0.25, -0.15);
      samples.push_back(sample_of(pose_at(position_m.x() < 0.0 ? Vector3d(-position_m) : position_m,
                                          about({1, 2, 0}, 0.5 * std::sin(0.02 * n))),
                                  begin + n * 4ms));
      if (random() % 50 == 0) samples.back().position_m[random() % 3] *= -2.0;
    }
    std::vector<Isometry3d> wrists(2 * 500, Isometry3d::Identity());
    for (std::size_t run = 0; run < 2; ++run) {
      WristTracking tracking(options, usual_start);
      std::size_t at = 0;
      test::RestraintCounts counts;
      {
        const test::Restraint restraint;
        for (std::size_t tick = 0; tick < 500; ++tick) {
          const HostTime now = begin + tick * 16ms;
          for (; at < samples.size() && samples[at].arrival <= now; ++at)
            tracking.take(samples[at]);
          tracking.advance(now);
          if (tick % 100 == 99) tracking.recentre(usual_start);
          wrists[500 * run + tick] = tracking.T_stage_wrist();
        }
        counts = restraint.counts();
      }
      CHECK(counts.allocations + counts.frees + counts.locks == 0);
      CHECK(tracking.counts().losses == 4);
      CHECK(tracking.counts().refused > 10);
      CHECK(tracking.counts().flips > 100);
    }
    for (std::size_t tick = 0; tick < 500; ++tick)
      REQUIRE(wrists[tick].matrix() == wrists[500 + tick].matrix());
  }
}

} // namespace wrist_tracking_test
