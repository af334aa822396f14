// The layer as an application has it: loaded by Debian's loader, by the manifest in the build
// folder, over the mock runtime. Expected joints are products of homogeneous matrices, from the
// numbers in the segment and from places that the runtime itself reports.

#include <algorithm>
#include <cmath>
#include <memory>

#include <Eigen/Geometry>

#include "openxr/application.hpp"
#include "support/eventually.hpp"
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

namespace {

constexpr XrPosef usual_stage{{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, -0.4F, -0.6F}};

Eigen::Isometry3d matrix_of(const XrPosef& pose) {
  const auto& q = pose.orientation;
  const auto& p = pose.position;
  return Eigen::Translation3d(Eigen::Vector3f(p.x, p.y, p.z).cast<double>()) *
         Eigen::Quaternionf(q.w, q.x, q.y, q.z).cast<double>().normalized();
}
Eigen::Isometry3d matrix_of(const WrittenJoint& joint) {
  return matrix_of(
      XrPosef{{joint[3], joint[4], joint[5], joint[6]}, {joint[0], joint[1], joint[2]}});
}

/// The farthest distances, in metres and radians, of located joints from those expected.
struct Distance {
  double position = 0.0;
  double turn = 0.0;
};
Distance distance(const LocatedHand& located, const WrittenHand& written,
                  const Eigen::Isometry3d& stage_in_base) {
  Distance max;
  for (std::size_t k = 0; k < 26; ++k) {
    const Eigen::Isometry3d is = matrix_of(located.joints[k].pose);
    const Eigen::Isometry3d should = stage_in_base * matrix_of(written.joints[k]);
    max.position = std::max(max.position, (is.translation() - should.translation()).norm());
    max.turn = std::max(max.turn, (is.linear() - should.linear()).norm());
  }
  return max;
}

/// Spaces that are at different places in the world, and move.
void let_move(MockRuntime& runtime) {
  runtime.local.place = {{0.0F, 0.6F, 0.0F, 0.8F}, {0.5F, 1.2F, -0.3F}};
  runtime.view.place = {{0.1F, 0.1F, 0.1F, 0.98488579F}, {0.4F, 1.6F, 0.2F}};
  runtime.view.radius_m = 0.1;
  runtime.view.turns_per_s = 0.5;
  runtime.stage.place = {{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, 0.1F}};
  runtime.action.place = {{0.0F, 0.0F, 0.70710678F, 0.70710678F}, {0.3F, 1.0F, -0.2F}};
  runtime.action.radius_m = 0.3;
  runtime.action.turns_per_s = -1.0;
}

const std::array<XrHandEXT, 2> both_hands{XR_HAND_LEFT_EXT, XR_HAND_RIGHT_EXT};

/// A session with the focus, by the loader, with a segment that has two hands at rest.
struct Opened {
  explicit Opened(const std::string& what,
                  const std::vector<const char*>& extensions = usual_extensions())
      : name(WrittenSegment::unique_name(what)), environment(name),
        segment(std::make_unique<WrittenSegment>(name)),
        hands{sample_hand(-0.2F), sample_hand(0.1F)} {
    write_still();
    instance = std::make_unique<OpenInstance>(XR_NULL_HANDLE, xrGetInstanceProcAddr);
    const InstanceInfo info(extensions);
    REQUIRE(xrCreateInstance(info.get(), &instance->handle) == XR_SUCCESS);
    session = std::make_unique<OpenSession>(*instance);
  }
  ~Opened() {
    session.reset();
    instance.reset();
  }

  /// Records of some ticks, in which nothing moves.
  void write_still() {
    const std::int64_t now = monotonic_ns();
    for (int tick = 4; tick >= 0; --tick)
      (*segment)->write(hands, now - tick * 11'111'111);
  }
  XrTime now() const { return monotonic_ns() + runtime->clock_offset_ns; }
  /// Locates the right hand in LOCAL, now.
  LocatedHand locate(XrHandTrackerEXT tracker) const {
    return session->locate(tracker, session->spaces[1], now());
  }
  /// Waits until the layer has looked for the segment again.
  template <class Condition>
  bool polled_until(Condition&& condition) const {
    return eventually([&] {
      session->poll();
      return condition();
    });
  }

  MockRuntime* runtime = &fresh_runtime();
  std::string name;
  LoaderEnvironment environment;
  std::unique_ptr<WrittenSegment> segment;
  std::array<WrittenHand, 2> hands;
  std::unique_ptr<OpenInstance> instance;
  std::unique_ptr<OpenSession> session;
};

} // namespace

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

  TEST_CASE("wrong arguments are refused") {
    Opened opened("arguments");
    OpenSession& session = *opened.session;
    const auto tracker = session.track(XR_HAND_RIGHT_EXT);
    const auto function =
        opened.instance->function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT");
    std::array<XrHandJointLocationEXT, 27> joints{};
    std::array<XrHandJointVelocityEXT, 27> speeds{};
    XrHandJointVelocitiesEXT velocities{XR_TYPE_HAND_JOINT_VELOCITIES_EXT, nullptr, 26,
                                        speeds.data()};
    XrHandJointsMotionRangeInfoEXT range{XR_TYPE_HAND_JOINTS_MOTION_RANGE_INFO_EXT, nullptr,
                                         XR_HAND_JOINTS_MOTION_RANGE_UNOBSTRUCTED_EXT};
    XrHandJointsLocateInfoEXT info{XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT, &range, session.spaces[1],
                                   opened.now()};
    XrHandJointLocationsEXT locations{XR_TYPE_HAND_JOINT_LOCATIONS_EXT, &velocities, XR_FALSE, 26,
                                      joints.data()};
    const auto result = [&] { return function(tracker, &info, &locations); };
    REQUIRE(result() == XR_SUCCESS);
    XrResult expected = XR_ERROR_VALIDATION_FAILURE;
    SUBCASE("the number of joints") {
      locations.jointCount = 25;
    }
    SUBCASE("one joint more") {
      locations.jointCount = 27;
    }
    SUBCASE("no joints") {
      locations.jointLocations = nullptr;
    }
    SUBCASE("the number of velocities") {
      velocities.jointCount = 27;
    }
    SUBCASE("no velocities") {
      velocities.jointVelocities = nullptr;
    }
    SUBCASE("the type of the locations") {
      locations.type = XR_TYPE_SPACE_LOCATION;
    }
    SUBCASE("the type of the info") {
      info.type = XR_TYPE_SPACE_LOCATION;
    }
    SUBCASE("the motion range") {
      range.handJointsMotionRange = XR_HAND_JOINTS_MOTION_RANGE_MAX_ENUM_EXT;
    }
    SUBCASE("the time") {
      info.time = 0;
      expected = XR_ERROR_TIME_INVALID;
    }
    SUBCASE("the space") {
      info.baseSpace = XR_NULL_HANDLE;
      expected = XR_ERROR_HANDLE_INVALID;
    }
    CHECK(result() == expected);
    if (expected == XR_ERROR_HANDLE_INVALID) {
      opened.hands[1].is_present = false; // also without a hand
      opened.write_still();
      CHECK(result() == expected);
    }
    CHECK(function(tracker, nullptr, &locations) == XR_ERROR_VALIDATION_FAILURE);
    CHECK(function(tracker, &info, nullptr) == XR_ERROR_VALIDATION_FAILURE);
    CHECK(function(XR_NULL_HANDLE, &info, &locations) == XR_ERROR_HANDLE_INVALID);
  }

  TEST_CASE("a tracker is refused for another hand, another set of joints, another session") {
    Opened opened("refused");
    OpenSession& session = *opened.session;
    XrHandTrackerEXT tracker = XR_NULL_HANDLE;
    CHECK(session.track(XR_HAND_MAX_ENUM_EXT, &tracker) == XR_ERROR_VALIDATION_FAILURE);
    const auto create =
        opened.instance->function<PFN_xrCreateHandTrackerEXT>("xrCreateHandTrackerEXT");
    XrHandTrackerCreateInfoEXT info{XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT, nullptr, XR_HAND_LEFT_EXT,
                                    XR_HAND_JOINT_SET_MAX_ENUM_EXT};
    CHECK(create(session.handle, &info, &tracker) == XR_ERROR_VALIDATION_FAILURE);
    info.handJointSet = XR_HAND_JOINT_SET_DEFAULT_EXT;
    CHECK(create(session.handle, &info, nullptr) == XR_ERROR_VALIDATION_FAILURE);
    CHECK(create(session.handle, nullptr, &tracker) == XR_ERROR_VALIDATION_FAILURE);
    CHECK(create(XR_NULL_HANDLE, &info, &tracker) == XR_ERROR_HANDLE_INVALID);
    REQUIRE(create(session.handle, &info, &tracker) == XR_SUCCESS);
    const auto destroy =
        opened.instance->function<PFN_xrDestroyHandTrackerEXT>("xrDestroyHandTrackerEXT");
    CHECK(destroy(tracker) == XR_SUCCESS);
    CHECK(destroy(tracker) == XR_ERROR_HANDLE_INVALID);
    CHECK(session.locate(tracker, session.spaces[1], opened.now()).result ==
          XR_ERROR_HANDLE_INVALID);
  }

  TEST_CASE("trackers beyond the layer's limit are refused, and nothing else") {
    Opened opened("limit");
    OpenSession& session = *opened.session;
    std::vector<XrHandTrackerEXT> trackers;
    XrHandTrackerEXT tracker = XR_NULL_HANDLE;
    XrResult result = XR_SUCCESS;
    while (trackers.size() < 1000 &&
           (result = session.track(XR_HAND_LEFT_EXT, &tracker)) == XR_SUCCESS)
      trackers.push_back(tracker);
    CHECK(result == XR_ERROR_LIMIT_REACHED);
    CHECK(trackers.size() >= 16);
    opened.write_still();
    CHECK(opened.locate(trackers.back()).is_active);
    opened.instance->call<PFN_xrDestroyHandTrackerEXT>("xrDestroyHandTrackerEXT", trackers[3]);
    CHECK(session.track(XR_HAND_RIGHT_EXT, &tracker) == XR_SUCCESS);
    CHECK(opened.locate(tracker).is_active);
  }

  TEST_CASE("the runtime gets no extension that only the layer has, and no structure of one") {
    Opened opened("list",
                  {XR_EXT_HAND_JOINTS_MOTION_RANGE_EXTENSION_NAME, XR_MND_HEADLESS_EXTENSION_NAME,
                   XR_EXT_HAND_TRACKING_EXTENSION_NAME, "XR_EXT_hand_tracking_data_source"});
    const MockRuntime& runtime = *opened.runtime;
    CHECK(runtime.create_calls == 1);
    REQUIRE(runtime.extensions == 2);
    CHECK(std::string(runtime.extension[0]) == XR_MND_HEADLESS_EXTENSION_NAME);
    CHECK(std::string(runtime.extension[1]) == "XR_KHR_convert_timespec_time");
    XrSystemHandTrackingPropertiesEXT hands{XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT, nullptr,
                                            XR_FALSE};
    XrSystemProperties properties{};
    properties.type = XR_TYPE_SYSTEM_PROPERTIES;
    properties.next = &hands;
    CHECK(opened.instance->call<PFN_xrGetSystemProperties>(
              "xrGetSystemProperties", opened.instance->handle, opened.session->system,
              &properties) == XR_SUCCESS);
    CHECK(hands.supportsHandTracking == XR_TRUE);
    CHECK(properties.next == &hands);
    const auto tracker = opened.session->track(XR_HAND_RIGHT_EXT);
    CHECK(opened.locate(tracker).is_active);
    CHECK(runtime.foreign_structures == 0);
    char name[XR_MAX_STRUCTURE_NAME_SIZE] = "";
    const auto name_of = [&](int type) {
      CHECK(opened.instance->call<PFN_xrStructureTypeToString>(
                "xrStructureTypeToString", opened.instance->handle,
                static_cast<XrStructureType>(type), static_cast<char*>(name)) == XR_SUCCESS);
      return std::string(name);
    };
    CHECK(name_of(1000051002) == "XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT");
    CHECK(name_of(1000428000) == "XR_TYPE_HAND_TRACKING_DATA_SOURCE_INFO_EXT");
    CHECK(name_of(8) == "structure 8"); // the runtime's
    // One space of its own, and no tracker of the runtime.
    CHECK(runtime.spaces == 4);
    CHECK(runtime.trackers == 0);
    opened.session->destroy();
    CHECK(runtime.spaces == 0);
    CHECK(runtime.sessions == 0);
  }

  TEST_CASE("a runtime's own hands are there while no glove is live") {
    fresh_runtime();
    Opened opened("own", {XR_EXT_HAND_TRACKING_EXTENSION_NAME});
    // Opened makes a new runtime: give it hands before the next instance.
    opened.session.reset();
    opened.instance->destroy();
    MockRuntime& runtime = *opened.runtime;
    runtime.has_hand_tracking = true;
    const InstanceInfo info({XR_EXT_HAND_TRACKING_EXTENSION_NAME,
                             XR_EXT_HAND_JOINTS_MOTION_RANGE_EXTENSION_NAME,
                             "XR_EXT_hand_tracking_data_source"});
    REQUIRE(xrCreateInstance(info.get(), &opened.instance->handle) == XR_SUCCESS);
    CHECK(std::string(runtime.extension[0]) == XR_EXT_HAND_TRACKING_EXTENSION_NAME);
    opened.session = std::make_unique<OpenSession>(*opened.instance);
    OpenSession& session = *opened.session;
    const auto is_runtimes = [](const LocatedHand& hand) { return hand.joints[0].radius == 1.0F; };
    const auto tracker = session.track(XR_HAND_RIGHT_EXT);
    CHECK(runtime.trackers == 1);
    opened.write_still();
    CHECK_FALSE(is_runtimes(opened.locate(tracker)));
    CHECK(runtime.located_hands == 0);
    opened.hands[1].is_present = false;
    opened.write_still();
    XrHandJointsMotionRangeInfoEXT range{XR_TYPE_HAND_JOINTS_MOTION_RANGE_INFO_EXT, nullptr,
                                         XR_HAND_JOINTS_MOTION_RANGE_UNOBSTRUCTED_EXT};
    CHECK(is_runtimes(session.locate(tracker, session.spaces[1], opened.now(), &range)));
    CHECK(runtime.located_hands == 1);
    CHECK(runtime.foreign_structures == 0);
    session.set_state(XR_SESSION_STATE_VISIBLE); // the runtime knows that itself
    CHECK(is_runtimes(opened.locate(tracker)));
    opened.instance->call<PFN_xrDestroyHandTrackerEXT>("xrDestroyHandTrackerEXT", tracker);
    CHECK(runtime.trackers == 0);
    runtime.lacks_cameras = true; // gloves track hands all the same
    session.set_state(XR_SESSION_STATE_FOCUSED);
    opened.hands[1].is_present = true;
    const auto gloves = session.track(XR_HAND_RIGHT_EXT);
    opened.write_still();
    CHECK(opened.locate(gloves).is_active);
    CHECK(runtime.trackers == 0);
  }

  TEST_CASE("without NENDO_XR, or with DISABLE_NENDO_XR, the layer is not loaded") {
    fresh_runtime();
    const LoaderEnvironment environment("nothing");
    const InstanceInfo info(usual_extensions());
    XrInstance instance = XR_NULL_HANDLE;
    {
      const Variable disabled("DISABLE_NENDO_XR", "1");
      CHECK(xrCreateInstance(info.get(), &instance) == XR_ERROR_EXTENSION_NOT_PRESENT);
    }
    ::unsetenv("NENDO_XR");
    CHECK(xrCreateInstance(info.get(), &instance) == XR_ERROR_EXTENSION_NOT_PRESENT);
  }

  TEST_CASE("an application that does not ask for hands has the runtime's functions") {
    Opened opened("plain", {XR_MND_HEADLESS_EXTENSION_NAME});
    CHECK(opened.runtime->extensions == 1);
    CHECK(opened.runtime->spaces == 3);
    CHECK((opened.instance->function<PFN_xrCreateHandTrackerEXT>("xrCreateHandTrackerEXT") ==
           nullptr));
  }

  TEST_CASE("a name in NENDO_XR that is none gives no hands") {
    for (const char* const name : {"", "../etc/passwd", "a b", "x\n"}) {
      Opened opened("name");
      opened.session.reset();
      opened.instance->destroy();
      const Variable wrong("NENDO_XR", name);
      const InstanceInfo info(usual_extensions());
      REQUIRE(xrCreateInstance(info.get(), &opened.instance->handle) == XR_SUCCESS);
      opened.session = std::make_unique<OpenSession>(*opened.instance);
      const auto tracker = opened.session->track(XR_HAND_RIGHT_EXT);
      CHECK_FALSE(opened.locate(tracker).is_active);
    }
  }

  TEST_CASE("data sources: gloves are unobstructed hands") {
    Opened opened("sources",
                  {XR_EXT_HAND_TRACKING_EXTENSION_NAME, "XR_EXT_hand_tracking_data_source"});
    OpenSession& session = *opened.session;
    struct Info { // by the specification
      std::int32_t type = 1000428000;
      const void* next = nullptr;
      std::uint32_t count = 0;
      const std::int32_t* sources = nullptr;
    };
    struct State {
      std::int32_t type = 1000428001;
      void* next = nullptr;
      XrBool32 is_active = 7;
      std::int32_t source = 0;
    };
    const auto create = [&](const std::vector<std::int32_t>& sources, XrHandTrackerEXT* tracker) {
      Info info;
      info.count = static_cast<std::uint32_t>(sources.size());
      info.sources = sources.data();
      return session.track(XR_HAND_RIGHT_EXT, tracker, &info);
    };
    XrHandTrackerEXT tracker = XR_NULL_HANDLE;
    for (const std::vector<std::int32_t>& wrong :
         {std::vector<std::int32_t>{}, {1, 1}, {2, 1, 2}, {3}, {0}})
      CHECK(create(wrong, &tracker) == XR_ERROR_VALIDATION_FAILURE);
    for (const std::vector<std::int32_t>& wanted :
         {std::vector<std::int32_t>{1}, {2, 1}, {1, 2}, {2}}) {
      const bool wants_gloves = wanted != std::vector<std::int32_t>{2};
      REQUIRE(create(wanted, &tracker) == XR_SUCCESS);
      opened.write_still();
      State state;
      const LocatedHand hand =
          session.locate(tracker, session.spaces[1], opened.now(), nullptr, &state);
      CHECK(hand.is_active == wants_gloves);
      CHECK((state.is_active == XR_TRUE) == wants_gloves);
      if (wants_gloves) CHECK(state.source == 1);
      if (!wants_gloves) CHECK(hand.all_have(0, 0));
    }
    CHECK(opened.runtime->foreign_structures == 0);
  }

  TEST_CASE("both motion ranges give the same joints, because nothing is held") {
    Opened opened("range", {XR_EXT_HAND_TRACKING_EXTENSION_NAME,
                            XR_EXT_HAND_JOINTS_MOTION_RANGE_EXTENSION_NAME});
    OpenSession& session = *opened.session;
    const auto tracker = session.track(XR_HAND_RIGHT_EXT);
    for (const auto value : {XR_HAND_JOINTS_MOTION_RANGE_UNOBSTRUCTED_EXT,
                             XR_HAND_JOINTS_MOTION_RANGE_CONFORMING_TO_CONTROLLER_EXT}) {
      XrHandJointsMotionRangeInfoEXT range{XR_TYPE_HAND_JOINTS_MOTION_RANGE_INFO_EXT, nullptr,
                                           value};
      opened.write_still();
      const LocatedHand hand = session.locate(tracker, session.spaces[1], opened.now(), &range);
      REQUIRE(hand.is_active);
      CHECK(distance(hand, opened.hands[1], matrix_of(usual_stage)).position < 1e-6);
    }
  }
}

} // namespace openxr_layer_test
