// What the layer refuses, offers and leaves to the runtime, as an application sees it.

#include "openxr/layer_fixtures.hpp"

namespace openxr_layer_rules_test {

using namespace nendo::test;

TEST_SUITE("layer_rules") {
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

} // namespace openxr_layer_rules_test
