#pragma once
// An application of OpenXR: by Debian's loader over the mock runtime, or by a chain of functions
// that a test has made itself.

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <doctest/doctest.h>
#include <openxr/openxr.h>

#include "openxr/mock_runtime.hpp"
#include "openxr/segment_writer.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace nendo::test {

/// The mock runtime, as it is at first. It stays loaded, so that the loader gets the same one.
inline MockRuntime& fresh_runtime() {
  static void* const library = ::dlopen(NENDO_MOCK_RUNTIME, RTLD_NOW | RTLD_LOCAL);
  REQUIRE_MESSAGE(library != nullptr, ::dlerror());
  auto* const get = reinterpret_cast<MockRuntime* (*)()>(::dlsym(library, mock_runtime_function));
  MockRuntime& runtime = *get();
  runtime = {};
  return runtime;
}
inline void send_event(XrSession session, XrSessionState state) {
  static void* const library = ::dlopen(NENDO_MOCK_RUNTIME, RTLD_NOW | RTLD_LOCAL);
  reinterpret_cast<void (*)(XrSession, XrSessionState)>(::dlsym(library, mock_event_function))(
      session, state);
}

/// A variable of the environment, as long as this exists.
class Variable {
public:
  Variable(const char* name, const std::string& value) : name_(name) {
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() { ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

private:
  const char* name_;
};

/// What the loader needs to find the mock runtime, and the layer by the manifest in the build
/// folder.
class LoaderEnvironment {
public:
  explicit LoaderEnvironment(const std::string& segment)
      : runtime_("XR_RUNTIME_JSON", manifest()), data_("XDG_DATA_HOME", NENDO_OPENXR_DATA),
        segment_("NENDO_XR", segment) {}

private:
  std::string manifest() {
    const std::string path = (folder_.path() / "runtime.json").string();
    write_file(path, R"({"file_format_version": "1.0.0", "runtime": {"library_path": ")" +
                         std::string(NENDO_MOCK_RUNTIME) + R"("}})");
    return path;
  }

  TemporaryFolder folder_;
  Variable runtime_;
  Variable data_;
  Variable segment_;
};

/// The joints of one call.
struct LocatedHand {
  XrResult result = XR_ERROR_RUNTIME_FAILURE;
  bool is_active = false;
  std::array<XrHandJointLocationEXT, XR_HAND_JOINT_COUNT_EXT> joints{};
  std::array<XrHandJointVelocityEXT, XR_HAND_JOINT_COUNT_EXT> velocities{};

  /// Whether all joints and velocities have these flags.
  bool all_have(XrSpaceLocationFlags location, XrSpaceVelocityFlags velocity) const {
    for (std::size_t k = 0; k < joints.size(); ++k)
      if (joints[k].locationFlags != location || velocities[k].velocityFlags != velocity)
        return false;
    return true;
  }
};

inline constexpr XrSpaceLocationFlags valid_place =
    XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
inline constexpr XrSpaceLocationFlags tracked_place = valid_place |
                                                      XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT |
                                                      XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
inline constexpr XrSpaceVelocityFlags valid_velocity =
    XR_SPACE_VELOCITY_LINEAR_VALID_BIT | XR_SPACE_VELOCITY_ANGULAR_VALID_BIT;
inline constexpr XrPosef origin{{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, 0.0F}};

/// What xrCreateInstance gets.
class InstanceInfo {
public:
  explicit InstanceInfo(std::vector<const char*> extensions) : extensions_(std::move(extensions)) {
    info_.type = XR_TYPE_INSTANCE_CREATE_INFO;
    std::strcpy(info_.applicationInfo.applicationName, "nendo test");
    info_.applicationInfo.applicationVersion = 1;
    info_.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 20);
    info_.enabledExtensionCount = static_cast<std::uint32_t>(extensions_.size());
    info_.enabledExtensionNames = extensions_.data();
  }
  const XrInstanceCreateInfo* get() const { return &info_; }

private:
  std::vector<const char*> extensions_;
  XrInstanceCreateInfo info_{};
};

inline const std::vector<const char*>& usual_extensions() {
  static const std::vector<const char*> names{XR_EXT_HAND_TRACKING_EXTENSION_NAME,
                                              XR_MND_HEADLESS_EXTENSION_NAME};
  return names;
}

/// An instance, with the functions that it has. `get` is xrGetInstanceProcAddr, the loader's or
/// that of a chain. Destroys the instance in the end.
class OpenInstance {
public:
  OpenInstance(XrInstance instance, PFN_xrGetInstanceProcAddr get) : handle(instance), get_(get) {}
  ~OpenInstance() { destroy(); }
  OpenInstance(const OpenInstance&) = delete;
  OpenInstance& operator=(const OpenInstance&) = delete;

  void destroy() {
    if (handle != XR_NULL_HANDLE) call<PFN_xrDestroyInstance>("xrDestroyInstance", handle);
    handle = XR_NULL_HANDLE;
  }
  /// Returns a function, or null if the instance has none of that name.
  template <class Function>
  Function function(const char* name) const {
    PFN_xrVoidFunction found = nullptr;
    if (XR_FAILED(get_(handle, name, &found))) return nullptr;
    return reinterpret_cast<Function>(found);
  }
  template <class Function, class... Arguments>
  XrResult call(const char* name, Arguments... arguments) const {
    const auto called = function<Function>(name);
    return called == nullptr ? XR_ERROR_FUNCTION_UNSUPPORTED : called(arguments...);
  }

  XrInstance handle;

private:
  PFN_xrGetInstanceProcAddr get_;
};

/// A session with the focus, spaces and trackers.
class OpenSession {
public:
  explicit OpenSession(OpenInstance& instance) : instance_(instance) {
    XrSystemGetInfo get{};
    get.type = XR_TYPE_SYSTEM_GET_INFO;
    get.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
    REQUIRE(instance.call<PFN_xrGetSystem>("xrGetSystem", instance.handle, &get, &system) ==
            XR_SUCCESS);
    XrSessionCreateInfo create{};
    create.type = XR_TYPE_SESSION_CREATE_INFO;
    create.systemId = system;
    REQUIRE(instance.call<PFN_xrCreateSession>("xrCreateSession", instance.handle, &create,
                                               &handle) == XR_SUCCESS);
    for (const auto type : {XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL,
                            XR_REFERENCE_SPACE_TYPE_STAGE})
      spaces.push_back(space(type, origin));
    set_state(XR_SESSION_STATE_FOCUSED);
  }
  ~OpenSession() { destroy(); }
  OpenSession(const OpenSession&) = delete;
  OpenSession& operator=(const OpenSession&) = delete;

  XrResult destroy() {
    if (handle == XR_NULL_HANDLE) return XR_SUCCESS;
    const XrSession session = handle;
    handle = XR_NULL_HANDLE;
    return instance_.call<PFN_xrDestroySession>("xrDestroySession", session);
  }
  XrSpace space(XrReferenceSpaceType type, const XrPosef& pose) const {
    XrReferenceSpaceCreateInfo info{};
    info.type = XR_TYPE_REFERENCE_SPACE_CREATE_INFO;
    info.referenceSpaceType = type;
    info.poseInReferenceSpace = pose;
    XrSpace made = XR_NULL_HANDLE;
    instance_.call<PFN_xrCreateReferenceSpace>("xrCreateReferenceSpace", handle, &info, &made);
    return made;
  }
  /// A space of a pose action.
  XrSpace action_space() const {
    XrActionSetCreateInfo set_info{};
    set_info.type = XR_TYPE_ACTION_SET_CREATE_INFO;
    std::strcpy(set_info.actionSetName, "set");
    std::strcpy(set_info.localizedActionSetName, "set");
    XrActionSet set = XR_NULL_HANDLE;
    instance_.call<PFN_xrCreateActionSet>("xrCreateActionSet", instance_.handle, &set_info, &set);
    XrActionCreateInfo action_info{};
    action_info.type = XR_TYPE_ACTION_CREATE_INFO;
    std::strcpy(action_info.actionName, "pose");
    std::strcpy(action_info.localizedActionName, "pose");
    action_info.actionType = XR_ACTION_TYPE_POSE_INPUT;
    XrAction action = XR_NULL_HANDLE;
    instance_.call<PFN_xrCreateAction>("xrCreateAction", set, &action_info, &action);
    XrActionSpaceCreateInfo info{};
    info.type = XR_TYPE_ACTION_SPACE_CREATE_INFO;
    info.action = action;
    info.poseInActionSpace = origin;
    XrSpace made = XR_NULL_HANDLE;
    instance_.call<PFN_xrCreateActionSpace>("xrCreateActionSpace", handle, &info, &made);
    return made;
  }
  /// Lets the runtime send an event, and polls until there is none.
  void set_state(XrSessionState state) {
    send_event(handle, state);
    poll();
  }
  void poll() const {
    XrEventDataBuffer event{};
    do {
      event = {};
      event.type = XR_TYPE_EVENT_DATA_BUFFER;
    } while (instance_.call<PFN_xrPollEvent>("xrPollEvent", instance_.handle, &event) ==
             XR_SUCCESS);
  }
  XrResult track(XrHandEXT hand, XrHandTrackerEXT* tracker, const void* next = nullptr) const {
    XrHandTrackerCreateInfoEXT info{};
    info.type = XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT;
    info.next = next;
    info.hand = hand;
    info.handJointSet = XR_HAND_JOINT_SET_DEFAULT_EXT;
    return instance_.call<PFN_xrCreateHandTrackerEXT>("xrCreateHandTrackerEXT", handle, &info,
                                                      tracker);
  }
  XrHandTrackerEXT track(XrHandEXT hand) const {
    XrHandTrackerEXT tracker = XR_NULL_HANDLE;
    REQUIRE(track(hand, &tracker) == XR_SUCCESS);
    return tracker;
  }
  /// Locates the joints of a hand. The caller may have changed the function's pointers in `info`
  /// and `locations`.
  LocatedHand locate(XrHandTrackerEXT tracker, XrSpace base, XrTime time,
                     const void* info_next = nullptr, void* locations_next = nullptr) const {
    static thread_local PFN_xrLocateHandJointsEXT function = nullptr;
    static thread_local XrInstance owner = XR_NULL_HANDLE;
    if (owner != instance_.handle)
      function = instance_.function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT");
    owner = instance_.handle;
    return locate_by(function, tracker, base, time, info_next, locations_next);
  }
  static LocatedHand locate_by(PFN_xrLocateHandJointsEXT function, XrHandTrackerEXT tracker,
                               XrSpace base, XrTime time, const void* info_next,
                               void* locations_next) {
    LocatedHand hand;
    // What a layer does not set would be seen.
    std::memset(static_cast<void*>(hand.joints.data()), 0xFF, sizeof hand.joints);
    std::memset(static_cast<void*>(hand.velocities.data()), 0xFF, sizeof hand.velocities);
    const XrHandJointsLocateInfoEXT info{XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT, info_next, base,
                                         time};
    XrHandJointVelocitiesEXT velocities{XR_TYPE_HAND_JOINT_VELOCITIES_EXT, locations_next,
                                        XR_HAND_JOINT_COUNT_EXT, hand.velocities.data()};
    XrHandJointLocationsEXT locations{XR_TYPE_HAND_JOINT_LOCATIONS_EXT, &velocities, XR_FALSE,
                                      XR_HAND_JOINT_COUNT_EXT, hand.joints.data()};
    hand.result = function(tracker, &info, &locations);
    hand.is_active = locations.isActive != XR_FALSE;
    return hand;
  }
  /// Where one space is in another.
  XrSpaceLocation place(XrSpace space, XrSpace base, XrTime time) const {
    XrSpaceLocation location{};
    location.type = XR_TYPE_SPACE_LOCATION;
    REQUIRE(instance_.call<PFN_xrLocateSpace>("xrLocateSpace", space, base, time, &location) ==
            XR_SUCCESS);
    return location;
  }

  XrSystemId system = XR_NULL_SYSTEM_ID;
  XrSession handle = XR_NULL_HANDLE;
  std::vector<XrSpace> spaces; ///< VIEW, LOCAL, STAGE

private:
  OpenInstance& instance_;
};

/// An instance by the loader.
inline OpenInstance
open_by_loader(const std::vector<const char*>& extensions = usual_extensions()) {
  const InstanceInfo info(extensions);
  XrInstance instance = XR_NULL_HANDLE;
  REQUIRE(xrCreateInstance(info.get(), &instance) == XR_SUCCESS);
  return {instance, xrGetInstanceProcAddr};
}

} // namespace nendo::test
