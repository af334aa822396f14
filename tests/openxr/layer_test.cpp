// The layer as an application has it: loaded by Debian's loader, by the manifest in the build
// folder, over the mock runtime. Expected joints are products of homogeneous matrices, from the
// numbers in the segment and from places that the runtime itself reports.

#include <cmath>

#include "openxr/layer_fixtures.hpp"
#include "support/restraint.hpp"
#include "support/sanitizers.hpp"

#if NENDO_WATCHES_MEMORY
/// Debian's loader 1.0.20 does not free the names that it read from manifests.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the sanitizer's name
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libopenxr_loader";
}
#endif

namespace openxr_layer_test {

using namespace nendo::test;

TEST_SUITE("layer") {
  TEST_CASE("joints have the published places and axes, in the order of OpenXR") {
    Opened opened("order");
    const XrSpace stage = opened.session->space(XR_REFERENCE_SPACE_TYPE_LOCAL, usual_stage);
    for (std::size_t side = 0; side < 2; ++side) {
      const auto tracker = opened.session->track(both_hands[side]);
      opened.write_still();
      const LocatedHand hand = opened.session->locate(tracker, stage, opened.now());
      REQUIRE(hand.result == XR_SUCCESS);
      REQUIRE(hand.is_active);
      CHECK(hand.all_have(tracked_place, valid_velocity));
      const Distance far = distance(hand, opened.hands[side], Eigen::Isometry3d::Identity());
      CHECK(far.position < 1e-6);
      CHECK(far.turn < 1e-6);
      for (std::size_t k = 0; k < 26; ++k)
        CHECK(hand.joints[k].radius == sample_radius(side, k));
    }
  }

  TEST_CASE("10,000 calls in all spaces, which move, give the same hand") {
    Opened opened("spaces");
    let_move(*opened.runtime);
    OpenSession& session = *opened.session;
    session.spaces.push_back(session.action_space());
    session.spaces.push_back(session.space(XR_REFERENCE_SPACE_TYPE_VIEW,
                                           {{0.5F, 0.5F, 0.5F, 0.5F}, {0.1F, -0.2F, 0.3F}}));
    const std::array trackers{session.track(XR_HAND_LEFT_EXT), session.track(XR_HAND_RIGHT_EXT)};
    Distance far;
    int active = 0;
    for (int call = 0; call < 10'000; ++call) {
      if (call % 100 == 0) opened.write_still();
      const auto side = static_cast<std::size_t>(call % 2);
      const XrSpace base = session.spaces[static_cast<std::size_t>(call / 2) % 5];
      const XrTime time = opened.now() + (call % 30) * 1'000'000;
      const LocatedHand hand = session.locate(trackers[side], base, time);
      active += hand.result == XR_SUCCESS && hand.is_active &&
                hand.all_have(tracked_place, valid_velocity);
      const Eigen::Isometry3d local = matrix_of(session.place(session.spaces[1], base, time).pose);
      const Distance here = distance(hand, opened.hands[side], local * matrix_of(usual_stage));
      far.position = std::max(far.position, here.position);
      far.turn = std::max(far.turn, here.turn);
    }
    CHECK(active == 10'000);
    CHECK(far.position < 2e-6); // two places that were rounded to float, 2 m apart
    CHECK(far.turn < 2e-6);
  }

  TEST_CASE("NENDO_XR_STAGE places the stage in LOCAL or STAGE") {
    const Variable stage("NENDO_XR_STAGE", "stage:1,0.8,-0.5,90");
    Opened opened("stage");
    let_move(*opened.runtime);
    OpenSession& session = *opened.session;
    const auto tracker = session.track(XR_HAND_RIGHT_EXT);
    const LocatedHand hand = session.locate(tracker, session.spaces[2], opened.now());
    REQUIRE(hand.is_active);
    // 90 degrees to the left: what was to the right (x) is now ahead (-z).
    Eigen::Matrix4d placement;
    placement << 0, 0, 1, 1, 0, 1, 0, 0.8, -1, 0, 0, -0.5, 0, 0, 0, 1;
    CHECK(distance(hand, opened.hands[1], Eigen::Isometry3d(placement)).position < 1e-6);
  }

  TEST_CASE("a stage in a space that the runtime does not have gives no hands, and no error") {
    const Variable stage("NENDO_XR_STAGE", "stage:0,0,0");
    Opened opened("no-stage");
    opened.runtime->has_stage = false;
    const auto tracker = opened.session->track(XR_HAND_RIGHT_EXT);
    const LocatedHand hand = opened.locate(tracker);
    CHECK(hand.result == XR_SUCCESS);
    CHECK_FALSE(hand.is_active);
    CHECK(hand.all_have(0, 0));
  }

  TEST_CASE("velocities are those of the joints in the base space, also if that moves") {
    Opened opened("velocity");
    let_move(*opened.runtime);
    OpenSession& session = *opened.session;
    session.spaces.push_back(session.action_space());
    const auto tracker = session.track(XR_HAND_RIGHT_EXT);
    // The whole hand moves by 0.9 m/s, so that bones keep their directions.
    const std::int64_t now = monotonic_ns();
    for (int tick = 7; tick >= 0; --tick) {
      auto moved = opened.hands;
      for (WrittenJoint& joint : moved[1].joints)
        joint[0] += -0.01F * static_cast<float>(tick);
      (*opened.segment)->write(moved, now - tick * 11'111'111);
    }
    constexpr XrTime step = 2'000'000; // extrapolated
    for (const XrSpace base : session.spaces) {
      const XrTime time = now + 20'000'000;
      const LocatedHand at = session.locate(tracker, base, time);
      const LocatedHand before = session.locate(tracker, base, time - step);
      const LocatedHand after = session.locate(tracker, base, time + step);
      REQUIRE(at.all_have(tracked_place, valid_velocity));
      for (std::size_t k = 0; k < 26; ++k) {
        const auto position = [k](const LocatedHand& hand) {
          return Eigen::Vector3d(matrix_of(hand.joints[k].pose).translation());
        };
        const Eigen::Vector3d linear = (position(after) - position(before)) / (2e-9 * step);
        const auto& v = at.velocities[k].linearVelocity;
        CHECK((linear - Eigen::Vector3f(v.x, v.y, v.z).cast<double>()).norm() < 5e-3);
        const Eigen::AngleAxisd turn(
            Eigen::Matrix3d(matrix_of(after.joints[k].pose).linear() *
                            matrix_of(before.joints[k].pose).linear().transpose()));
        const Eigen::Vector3d angular = turn.angle() * turn.axis() / (2e-9 * step);
        const auto& w = at.velocities[k].angularVelocity;
        CHECK((angular - Eigen::Vector3f(w.x, w.y, w.z).cast<double>()).norm() < 5e-3);
      }
    }
    SUBCASE("without velocities of the runtime, none is valid") {
      opened.runtime->has_velocities = false;
      CHECK(session.locate(tracker, session.spaces[0], now).all_have(tracked_place, 0));
    }
  }

  TEST_CASE("xrLocateHandJointsEXT neither allocates nor locks") {
    Opened opened("restraint");
    OpenSession& session = *opened.session;
    const auto tracker = session.track(XR_HAND_RIGHT_EXT);
    const auto function =
        opened.instance->function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT");
    int active = 0;
    RestraintCounts counts;
    {
      const Restraint restraint;
      for (int call = 0; call < 1000; ++call) {
        const XrSpace base = session.spaces[static_cast<std::size_t>(call) % 3];
        const XrTime time = monotonic_ns();
        active += OpenSession::locate_by(function, tracker, base, time, nullptr, nullptr).is_active;
      }
      counts = restraint.counts();
    }
    CHECK(active > 0);
    CHECK(counts.allocations == 0);
    CHECK(counts.frees == 0);
    CHECK(counts.locks == 0);
    // The control: what the layer does is counted. It locks where it makes handles.
    XrHandTrackerEXT another = XR_NULL_HANDLE;
    XrHandTrackerCreateInfoEXT info{XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT, nullptr, XR_HAND_LEFT_EXT,
                                    XR_HAND_JOINT_SET_DEFAULT_EXT};
    const auto create =
        opened.instance->function<PFN_xrCreateHandTrackerEXT>("xrCreateHandTrackerEXT");
    {
      const Restraint restraint;
      create(session.handle, &info, &another);
      counts = restraint.counts();
    }
    CHECK((counts.locks > 0) == restraint_is_counted);
  }

  TEST_CASE("the runtime's clock may differ from CLOCK_MONOTONIC") {
    Opened opened("clock");
    opened.runtime->clock_offset_ns = 5'000'000'000'000;
    const auto tracker = opened.session->track(XR_HAND_RIGHT_EXT);
    const std::int64_t now = monotonic_ns();
    for (int tick = 7; tick >= 0; --tick) {
      auto moved = opened.hands;
      for (WrittenJoint& joint : moved[1].joints)
        joint[0] += -0.01F * static_cast<float>(tick);
      (*opened.segment)->write(moved, now - tick * 10'000'000);
    }
    OpenSession& session = *opened.session;
    const XrTime newest = now + opened.runtime->clock_offset_ns;
    const auto x_at = [&](XrTime time) {
      return session.locate(tracker, session.spaces[1], time).joints[0].pose.position.x;
    };
    // 1 m/s; at most 50 ms before and after the newest record.
    CHECK(x_at(newest) == doctest::Approx(0.1).epsilon(1e-5));
    CHECK(x_at(newest + 20'000'000) == doctest::Approx(0.12).epsilon(1e-3));
    CHECK(x_at(newest + 300'000'000) == doctest::Approx(0.15).epsilon(1e-3));
    CHECK(x_at(newest - 20'000'000) == doctest::Approx(0.08).epsilon(1e-3));
    CHECK(x_at(newest - 300'000'000) == doctest::Approx(0.05).epsilon(1e-3));
    CHECK(x_at(1) == doctest::Approx(0.1).epsilon(1e-5)); // of another clock: the newest pose
  }

  TEST_CASE("without a glove, without the focus and without a place there is no hand") {
    Opened opened("inactive");
    OpenSession& session = *opened.session;
    const std::array trackers{session.track(XR_HAND_LEFT_EXT), session.track(XR_HAND_RIGHT_EXT)};
    const auto is_active = [&](std::size_t side) {
      const LocatedHand hand = opened.locate(trackers[side]);
      CHECK(hand.result == XR_SUCCESS);
      if (!hand.is_active) CHECK(hand.all_have(0, 0));
      return hand.is_active;
    };
    CHECK(is_active(0));
    CHECK(is_active(1));
    SUBCASE("a glove that is not there") {
      opened.hands[0].is_present = false;
      opened.write_still();
      CHECK_FALSE(is_active(0));
      CHECK(is_active(1));
    }
    SUBCASE("the focus") {
      for (const auto state : {XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_SYNCHRONIZED,
                               XR_SESSION_STATE_STOPPING, XR_SESSION_STATE_LOSS_PENDING}) {
        session.set_state(state);
        CHECK_FALSE(is_active(1));
        session.set_state(XR_SESSION_STATE_FOCUSED);
        CHECK(is_active(1));
      }
    }
    SUBCASE("a place") {
      opened.runtime->loses_places = true;
      CHECK_FALSE(is_active(1));
    }
    SUBCASE("numbers that are not those of a hand") {
      for (const float wrong : {std::nanf(""), INFINITY, 1e9F}) {
        opened.hands[0].joints[7][1] = wrong;
        opened.write_still();
        CHECK_FALSE(is_active(0));
        CHECK(is_active(1));
      }
      opened.hands[0] = sample_hand();
      opened.hands[0].joints[25] = {}; // no quaternion
      opened.write_still();
      CHECK_FALSE(is_active(0));
    }
  }

  TEST_CASE("a silent glove and a lost tracker give valid places that are not tracked") {
    Opened opened("silent");
    const auto tracker = opened.session->track(XR_HAND_RIGHT_EXT);
    bool is_silent = false;
    SUBCASE("the glove") {
      is_silent = true;
    }
    SUBCASE("the tracker") {}
    opened.hands[1].is_silent = is_silent;
    opened.hands[1].is_lost = !is_silent;
    opened.write_still();
    const LocatedHand hand = opened.locate(tracker);
    CHECK(hand.is_active);
    CHECK(hand.all_have(valid_place, 0));
  }

  TEST_CASE("a place that the runtime does not track is not tracked") {
    Opened opened("untracked");
    const auto tracker = opened.session->track(XR_HAND_RIGHT_EXT);
    opened.runtime->tracked = XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;
    const LocatedHand hand = opened.locate(tracker);
    CHECK(hand.all_have(valid_place | XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT, valid_velocity));
  }

  TEST_CASE("a hand follows the run: it begins, ends, is killed, begins again") {
    Opened opened("runs");
    opened.segment.reset();
    const auto tracker = opened.session->track(XR_HAND_RIGHT_EXT);
    const auto is_active = [&] { return opened.locate(tracker).is_active; };
    CHECK_FALSE(is_active());
    const auto begin = [&] {
      opened.segment = std::make_unique<WrittenSegment>(opened.name);
      return opened.polled_until([&] {
        opened.write_still();
        return is_active();
      });
    };
    CHECK(begin());
    SUBCASE("it ends") {
      (*opened.segment)->set_state(2);
      CHECK_FALSE(is_active());
      opened.segment.reset();
      CHECK_FALSE(is_active());
      CHECK(begin());
    }
    SUBCASE("it is killed, which leaves the file") {
      (*opened.segment)->write(opened.hands, monotonic_ns() - 40'000'000'000);
      CHECK_FALSE(is_active());
      const auto remains = std::move(opened.segment); // and a run that replaces it
      CHECK(begin());
    }
    SUBCASE("a record of another generation than the setup") {
      (*opened.segment)->set_generation(2);
      CHECK_FALSE(is_active());
      opened.write_still();
      CHECK(is_active());
    }
    SUBCASE("the next run has another major version") {
      opened.segment = std::make_unique<WrittenSegment>(opened.name);
      (*opened.segment)->put(12, std::uint16_t{2});
      opened.write_still();
      CHECK(opened.polled_until([&] { return !is_active(); }));
      CHECK(begin());
    }
    SUBCASE("it is truncated before it is mapped") {
      opened.segment = std::make_unique<WrittenSegment>(opened.name, 4096);
      CHECK(opened.polled_until([&] { return !is_active(); }));
      CHECK(begin());
    }
  }

  TEST_CASE("what is no segment gives no hands") {
    Opened opened("nonsense");
    opened.segment.reset();
    const std::string path = "/dev/shm/nendo-" + opened.name;
    SUBCASE("an empty file") {
      write_file(path, "");
    }
    SUBCASE("text") {
      write_file(path, std::string(100'000, 'x'));
    }
    SUBCASE("a link to a segment") {
      const WrittenSegment other(opened.name + ".other");
      std::filesystem::create_symlink(other.path(), path);
    }
    SUBCASE("a folder") {
      std::filesystem::create_directory(path);
    }
    SUBCASE("a pipe without a writer") {
      REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
    }
    const auto tracker = opened.session->track(XR_HAND_RIGHT_EXT);
    const LocatedHand hand = opened.locate(tracker);
    CHECK(hand.result == XR_SUCCESS);
    CHECK_FALSE(hand.is_active);
    std::filesystem::remove(path);
  }
}

} // namespace openxr_layer_test
