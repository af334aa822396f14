// A runtime for OpenXR's loader, without devices, by the text of the specification. It shares
// nothing with the layer, and checks what it gets: handles, types, times, and that structures of
// extensions come only if these are enabled.

#include "openxr/mock_runtime.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <deque>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#define XR_USE_TIMESPEC
#include <openxr/openxr_platform.h>

namespace {

using nendo::test::MockMotion;
using nendo::test::MockRuntime;

MockRuntime runtime;

struct Vector {
  double x = 0.0, y = 0.0, z = 0.0;
};
struct Turn { // a unit quaternion
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};
struct Place {
  Turn turn;
  Vector at;
};

Turn times(const Turn& a, const Turn& b) {
  return {
      a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
      a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
Turn inverse(const Turn& a) {
  return {-a.x, -a.y, -a.z, a.w};
}
Vector turned(const Turn& a, const Vector& v) {
  const Turn result = times(times(a, {v.x, v.y, v.z, 0.0}), inverse(a));
  return {result.x, result.y, result.z};
}
Place times(const Place& a, const Place& b) {
  const Vector moved = turned(a.turn, b.at);
  return {times(a.turn, b.turn), {a.at.x + moved.x, a.at.y + moved.y, a.at.z + moved.z}};
}
Place inverse(const Place& a) {
  const Turn back = inverse(a.turn);
  const Vector at = turned(back, a.at);
  return {back, {-at.x, -at.y, -at.z}};
}
Place place_of(const XrPosef& pose) {
  const auto& q = pose.orientation;
  const auto& p = pose.position;
  return {{double(q.x), double(q.y), double(q.z), double(q.w)}, // NOLINT
          {double(p.x), double(p.y), double(p.z)}};             // NOLINT
}

struct Space {
  const MockMotion* motion;
  Place offset;
};
struct Event {
  XrSession session;
  XrSessionState state;
};
struct Instance {
  std::set<std::string> enabled;
  std::deque<Event> events;
};
struct Session {
  Instance* instance;
  std::set<Space*> spaces;
  std::set<XrHandTrackerEXT> trackers;
};

// Every handle that is alive; others are refused.
std::set<Instance*> instances;
std::set<Session*> sessions;
std::set<Space*> spaces;
std::set<XrHandTrackerEXT> trackers;

template <class Object, class Handle>
Object* object_of(const std::set<Object*>& alive, Handle handle) {
  auto* const object = reinterpret_cast<Object*>(handle);
  return alive.count(object) != 0 ? object : nullptr;
}

std::vector<std::string> offered() {
  std::vector<std::string> names{"XR_MND_headless"};
  if (runtime.has_hand_tracking) names.emplace_back("XR_EXT_hand_tracking");
  if (runtime.has_motion_range) names.emplace_back("XR_EXT_hand_joints_motion_range");
  if (runtime.has_data_source) names.emplace_back("XR_EXT_hand_tracking_data_source");
  if (runtime.has_timespec) names.emplace_back("XR_KHR_convert_timespec_time");
  return names;
}

/// Counts structures of extensions that this instance has not enabled.
void judge_chain(const Instance& instance, const void* next) {
  const std::array<std::pair<int, const char*>, 5> owners{
      {{1000051000, "XR_EXT_hand_tracking"},
       {1000051004, "XR_EXT_hand_tracking"},
       {1000080000, "XR_EXT_hand_joints_motion_range"},
       {1000428000, "XR_EXT_hand_tracking_data_source"},
       {1000428001, "XR_EXT_hand_tracking_data_source"}}};
  for (auto* at = static_cast<const XrBaseInStructure*>(next); at != nullptr; at = at->next)
    for (const auto& [type, owner] : owners)
      if (at->type == type && instance.enabled.count(owner) == 0) ++runtime.foreign_structures;
}

Place place_at(const Space& space, double time_s) {
  const MockMotion& motion = *space.motion;
  const double angle = 2.0 * std::numbers::pi * motion.turns_per_s * time_s;
  const Place moved{{0.0, std::sin(angle / 2.0), 0.0, std::cos(angle / 2.0)},
                    {motion.radius_m * std::cos(angle), 0.0, -motion.radius_m * std::sin(angle)}};
  return times(times(place_of(motion.place), moved), space.offset);
}

Place relative_at(const Space& space, const Space& base, double time_s) {
  return times(inverse(place_at(base, time_s)), place_at(space, time_s));
}

// --- what the loader and layers call -------------------------------------------------------

XrResult XRAPI_CALL enumerate_extensions(const char* layer, uint32_t capacity, uint32_t* count,
                                         XrExtensionProperties* properties) {
  if (layer != nullptr) return XR_ERROR_API_LAYER_NOT_PRESENT;
  const auto names = offered();
  *count = static_cast<uint32_t>(names.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < *count) return XR_ERROR_SIZE_INSUFFICIENT;
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (properties[n].type != XR_TYPE_EXTENSION_PROPERTIES) return XR_ERROR_VALIDATION_FAILURE;
    std::strncpy(properties[n].extensionName, names[n].c_str(), XR_MAX_EXTENSION_NAME_SIZE - 1);
    properties[n].extensionVersion = 1;
  }
  return XR_SUCCESS;
}

XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo* info, XrInstance* handle) {
  ++runtime.create_calls;
  const auto names = offered();
  runtime.extensions = 0;
  auto made = std::make_unique<Instance>();
  for (uint32_t n = 0; n < info->enabledExtensionCount; ++n) {
    const std::string name = info->enabledExtensionNames[n];
    if (runtime.extensions < 32)
      std::strncpy(runtime.extension[runtime.extensions++], name.c_str(),
                   XR_MAX_EXTENSION_NAME_SIZE - 1);
    bool has = false;
    for (const std::string& each : names)
      has |= each == name;
    if (!has) {
      ++runtime.refused_creates;
      return XR_ERROR_EXTENSION_NOT_PRESENT;
    }
    made->enabled.insert(name);
  }
  ++runtime.instances;
  instances.insert(made.get());
  *handle = reinterpret_cast<XrInstance>(made.release());
  return XR_SUCCESS;
}

void end_session(Session* session) {
  for (Space* const space : session->spaces) {
    spaces.erase(space);
    delete space; // NOLINT
    --runtime.spaces;
  }
  for (const XrHandTrackerEXT tracker : session->trackers) {
    trackers.erase(tracker);
    --runtime.trackers;
  }
  sessions.erase(session);
  delete session; // NOLINT
  --runtime.sessions;
}

XrResult XRAPI_CALL destroy_instance(XrInstance handle) {
  auto* const instance = object_of(instances, handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  const auto all = sessions;
  for (Session* const session : all)
    if (session->instance == instance) end_session(session);
  instances.erase(instance);
  delete instance; // NOLINT
  --runtime.instances;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL get_instance_properties(XrInstance handle, XrInstanceProperties* properties) {
  if (object_of(instances, handle) == nullptr) return XR_ERROR_HANDLE_INVALID;
  properties->runtimeVersion = XR_MAKE_VERSION(1, 0, 0);
  std::strcpy(properties->runtimeName, "mock");
  return XR_SUCCESS;
}

// api_dump asks for these names.
XrResult XRAPI_CALL result_to_string(XrInstance, XrResult value, char* buffer) {
  std::snprintf(buffer, XR_MAX_RESULT_STRING_SIZE, "result %d", value);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL structure_type_to_string(XrInstance, XrStructureType value, char* buffer) {
  std::snprintf(buffer, XR_MAX_STRUCTURE_NAME_SIZE, "structure %d", value);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL poll_event(XrInstance handle, XrEventDataBuffer* buffer) {
  auto* const instance = object_of(instances, handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  if (buffer == nullptr || buffer->type != XR_TYPE_EVENT_DATA_BUFFER)
    return XR_ERROR_VALIDATION_FAILURE;
  if (instance->events.empty()) return XR_EVENT_UNAVAILABLE;
  const Event event = instance->events.front();
  instance->events.pop_front();
  XrEventDataSessionStateChanged changed{};
  changed.type = XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED;
  changed.session = event.session;
  changed.state = event.state;
  std::memcpy(buffer, &changed, sizeof changed);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL get_system(XrInstance handle, const XrSystemGetInfo*, XrSystemId* system) {
  if (object_of(instances, handle) == nullptr) return XR_ERROR_HANDLE_INVALID;
  *system = 1;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL get_system_properties(XrInstance handle, XrSystemId system,
                                          XrSystemProperties* properties) {
  auto* const instance = object_of(instances, handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  if (system != 1) return XR_ERROR_SYSTEM_INVALID;
  judge_chain(*instance, properties->next);
  properties->systemId = 1;
  for (auto* at = static_cast<XrBaseOutStructure*>(properties->next); at != nullptr; at = at->next)
    if (at->type == XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT)
      reinterpret_cast<XrSystemHandTrackingPropertiesEXT*>(at)->supportsHandTracking =
          runtime.lacks_cameras ? XR_FALSE : XR_TRUE;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL create_session(XrInstance handle, const XrSessionCreateInfo* info,
                                   XrSession* session) {
  auto* const instance = object_of(instances, handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  if (info->systemId != 1) return XR_ERROR_SYSTEM_INVALID;
  auto* const made = new Session{instance, {}, {}}; // NOLINT
  sessions.insert(made);
  ++runtime.sessions;
  *session = reinterpret_cast<XrSession>(made);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_session(XrSession handle) {
  auto* const session = object_of(sessions, handle);
  if (session == nullptr) return XR_ERROR_HANDLE_INVALID;
  end_session(session);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL begin_session(XrSession handle, const XrSessionBeginInfo*) {
  return object_of(sessions, handle) != nullptr ? XR_SUCCESS : XR_ERROR_HANDLE_INVALID;
}
XrResult XRAPI_CALL leave_session(XrSession handle) {
  return object_of(sessions, handle) != nullptr ? XR_SUCCESS : XR_ERROR_HANDLE_INVALID;
}

XrResult make_space(XrSession handle, const MockMotion& motion, const XrPosef& pose,
                    XrSpace* space) {
  auto* const session = object_of(sessions, handle);
  if (session == nullptr) return XR_ERROR_HANDLE_INVALID;
  auto* const made = new Space{&motion, place_of(pose)}; // NOLINT
  session->spaces.insert(made);
  spaces.insert(made);
  ++runtime.spaces;
  *space = reinterpret_cast<XrSpace>(made);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL create_reference_space(XrSession handle, const XrReferenceSpaceCreateInfo* info,
                                           XrSpace* space) {
  const auto& q = info->poseInReferenceSpace.orientation;
  const double norm = std::hypot(std::hypot(double(q.x), double(q.y)),  // NOLINT
                                 std::hypot(double(q.z), double(q.w))); // NOLINT
  if (std::abs(norm - 1.0) > 0.01) return XR_ERROR_POSE_INVALID;
  switch (info->referenceSpaceType) {
  case XR_REFERENCE_SPACE_TYPE_VIEW:
    return make_space(handle, runtime.view, info->poseInReferenceSpace, space);
  case XR_REFERENCE_SPACE_TYPE_LOCAL:
    return make_space(handle, runtime.local, info->poseInReferenceSpace, space);
  case XR_REFERENCE_SPACE_TYPE_STAGE:
    if (!runtime.has_stage) return XR_ERROR_REFERENCE_SPACE_UNSUPPORTED;
    return make_space(handle, runtime.stage, info->poseInReferenceSpace, space);
  default:
    return XR_ERROR_REFERENCE_SPACE_UNSUPPORTED;
  }
}

XrResult XRAPI_CALL create_action_set(XrInstance handle, const XrActionSetCreateInfo*,
                                      XrActionSet* set) {
  if (object_of(instances, handle) == nullptr) return XR_ERROR_HANDLE_INVALID;
  *set = reinterpret_cast<XrActionSet>(std::uintptr_t{0x5E7});
  return XR_SUCCESS;
}
XrResult XRAPI_CALL create_action(XrActionSet, const XrActionCreateInfo*, XrAction* action) {
  *action = reinterpret_cast<XrAction>(std::uintptr_t{0xAC7});
  return XR_SUCCESS;
}
XrResult XRAPI_CALL create_action_space(XrSession handle, const XrActionSpaceCreateInfo* info,
                                        XrSpace* space) {
  return make_space(handle, runtime.action, info->poseInActionSpace, space);
}
XrResult XRAPI_CALL string_to_path(XrInstance, const char*, XrPath* path) {
  *path = 1;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_space(XrSpace handle) {
  auto* const space = object_of(spaces, handle);
  if (space == nullptr) return XR_ERROR_HANDLE_INVALID;
  for (Session* const session : sessions)
    session->spaces.erase(space);
  spaces.erase(space);
  delete space; // NOLINT
  --runtime.spaces;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL locate_space(XrSpace handle, XrSpace base_handle, XrTime time,
                                 XrSpaceLocation* location) {
  const auto* const space = object_of(spaces, handle);
  const auto* const base = object_of(spaces, base_handle);
  if (space == nullptr || base == nullptr) return XR_ERROR_HANDLE_INVALID;
  if (time <= 0) return XR_ERROR_TIME_INVALID;
  if (location == nullptr || location->type != XR_TYPE_SPACE_LOCATION)
    return XR_ERROR_VALIDATION_FAILURE;
  constexpr double step_s = 1e-4;
  const double time_s = static_cast<double>(time % 1'000'000'000'000) / 1e9; // keeps microseconds
  const Place now = relative_at(*space, *base, time_s);
  location->locationFlags = 0;
  if (runtime.loses_places) return XR_SUCCESS;
  location->locationFlags = XR_SPACE_LOCATION_ORIENTATION_VALID_BIT |
                            XR_SPACE_LOCATION_POSITION_VALID_BIT | runtime.tracked;
  location->pose = {
      {static_cast<float>(now.turn.x), static_cast<float>(now.turn.y),
       static_cast<float>(now.turn.z), static_cast<float>(now.turn.w)},
      {static_cast<float>(now.at.x), static_cast<float>(now.at.y), static_cast<float>(now.at.z)}};
  for (auto* at = static_cast<XrBaseOutStructure*>(location->next); at != nullptr; at = at->next) {
    if (at->type != XR_TYPE_SPACE_VELOCITY) continue;
    auto& velocity = *reinterpret_cast<XrSpaceVelocity*>(at);
    velocity.velocityFlags = 0;
    if (!runtime.has_velocities) continue;
    // By differences of the place, a little later and a little earlier.
    const Place later = relative_at(*space, *base, time_s + step_s);
    const Place earlier = relative_at(*space, *base, time_s - step_s);
    Turn turned_by = times(later.turn, inverse(earlier.turn));
    if (turned_by.w < 0.0) turned_by = {-turned_by.x, -turned_by.y, -turned_by.z, -turned_by.w};
    velocity.velocityFlags =
        XR_SPACE_VELOCITY_LINEAR_VALID_BIT | XR_SPACE_VELOCITY_ANGULAR_VALID_BIT;
    velocity.linearVelocity = {static_cast<float>((later.at.x - earlier.at.x) / (2.0 * step_s)),
                               static_cast<float>((later.at.y - earlier.at.y) / (2.0 * step_s)),
                               static_cast<float>((later.at.z - earlier.at.z) / (2.0 * step_s))};
    // A small turn by an angle has half the angle as its imaginary part.
    velocity.angularVelocity = {static_cast<float>(turned_by.x / step_s),
                                static_cast<float>(turned_by.y / step_s),
                                static_cast<float>(turned_by.z / step_s)};
  }
  return XR_SUCCESS;
}

XrResult XRAPI_CALL convert_timespec(XrInstance handle, const timespec* time, XrTime* converted) {
  if (object_of(instances, handle) == nullptr) return XR_ERROR_HANDLE_INVALID;
  *converted = time->tv_sec * 1'000'000'000 + time->tv_nsec + runtime.clock_offset_ns;
  return XR_SUCCESS;
}

// The runtime's own hands have all joints at the origin of the base space, with a radius of 1 m.
XrResult XRAPI_CALL create_hand_tracker(XrSession handle, const XrHandTrackerCreateInfoEXT* info,
                                        XrHandTrackerEXT* tracker) {
  auto* const session = object_of(sessions, handle);
  if (session == nullptr) return XR_ERROR_HANDLE_INVALID;
  judge_chain(*session->instance, info->next);
  if (runtime.lacks_cameras) return XR_ERROR_FEATURE_UNSUPPORTED;
  static std::uintptr_t next = 0x7AC0;
  *tracker = reinterpret_cast<XrHandTrackerEXT>(next++);
  session->trackers.insert(*tracker);
  trackers.insert(*tracker);
  ++runtime.trackers;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_hand_tracker(XrHandTrackerEXT tracker) {
  if (trackers.erase(tracker) == 0) return XR_ERROR_HANDLE_INVALID;
  for (Session* const session : sessions)
    session->trackers.erase(tracker);
  --runtime.trackers;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL locate_hand_joints(XrHandTrackerEXT tracker,
                                       const XrHandJointsLocateInfoEXT* info,
                                       XrHandJointLocationsEXT* locations) {
  if (trackers.count(tracker) == 0) return XR_ERROR_HANDLE_INVALID;
  for (const Session* const session : sessions) {
    if (session->trackers.count(tracker) == 0) continue;
    judge_chain(*session->instance, info->next);
    judge_chain(*session->instance, locations->next);
  }
  ++runtime.located_hands;
  locations->isActive = XR_TRUE;
  for (uint32_t k = 0; k < locations->jointCount; ++k)
    locations->jointLocations[k] = {XR_SPACE_LOCATION_ORIENTATION_VALID_BIT |
                                        XR_SPACE_LOCATION_POSITION_VALID_BIT,
                                    {{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, 0.0F}},
                                    1.0F};
  return XR_SUCCESS;
}

template <class Function>
PFN_xrVoidFunction untyped(Function* function) {
  return reinterpret_cast<PFN_xrVoidFunction>(function);
}

XrResult XRAPI_CALL get_instance_proc_addr(XrInstance handle, const char* name,
                                           PFN_xrVoidFunction* function) {
  struct Named {
    std::string name;
    PFN_xrVoidFunction function;
    const char* extension = nullptr;
  };
  const std::string wanted = name;
  *function = nullptr;
  if (wanted == "xrEnumerateInstanceExtensionProperties" &&
      (runtime.answers_before_instance || handle != XR_NULL_HANDLE))
    *function = untyped(enumerate_extensions);
  if (wanted == "xrCreateInstance") *function = untyped(create_instance);
  if (*function != nullptr) return XR_SUCCESS;
  auto* const instance = object_of(instances, handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  const char* const hands = "XR_EXT_hand_tracking";
  const std::vector<Named> all{
      {"xrGetInstanceProcAddr", untyped(get_instance_proc_addr)},
      {"xrDestroyInstance", untyped(destroy_instance)},
      {"xrGetInstanceProperties", untyped(get_instance_properties)},
      {"xrResultToString", untyped(result_to_string)},
      {"xrStructureTypeToString", untyped(structure_type_to_string)},
      {"xrPollEvent", untyped(poll_event)},
      {"xrGetSystem", untyped(get_system)},
      {"xrGetSystemProperties", untyped(get_system_properties)},
      {"xrCreateSession", untyped(create_session)},
      {"xrDestroySession", untyped(destroy_session)},
      {"xrBeginSession", untyped(begin_session)},
      {"xrEndSession", untyped(leave_session)},
      {"xrCreateReferenceSpace", untyped(create_reference_space)},
      {"xrCreateActionSet", untyped(create_action_set)},
      {"xrCreateAction", untyped(create_action)},
      {"xrCreateActionSpace", untyped(create_action_space)},
      {"xrStringToPath", untyped(string_to_path)},
      {"xrDestroySpace", untyped(destroy_space)},
      {"xrLocateSpace", untyped(locate_space)},
      {"xrConvertTimespecTimeToTimeKHR", untyped(convert_timespec), "XR_KHR_convert_timespec_time"},
      {"xrCreateHandTrackerEXT", untyped(create_hand_tracker), hands},
      {"xrDestroyHandTrackerEXT", untyped(destroy_hand_tracker), hands},
      {"xrLocateHandJointsEXT", untyped(locate_hand_joints), hands}};
  for (const Named& each : all)
    if (each.name == wanted &&
        (each.extension == nullptr || instance->enabled.count(each.extension) != 0))
      *function = each.function;
  return *function != nullptr ? XR_SUCCESS : XR_ERROR_FUNCTION_UNSUPPORTED;
}

// What the loader passes, by the specification's chapter on loaders.
struct LoaderInfo {
  uint32_t type, version;
  size_t size;
  uint32_t min_interface, max_interface;
  XrVersion min_api, max_api;
};
struct RuntimeRequest {
  uint32_t type, version;
  size_t size;
  uint32_t interface_version;
  XrVersion api_version;
  PFN_xrGetInstanceProcAddr get_instance_proc_addr;
};

} // namespace

extern "C" {

__attribute__((visibility("default"))) XrResult XRAPI_CALL
xrNegotiateLoaderRuntimeInterface(const LoaderInfo* info, RuntimeRequest* request) {
  if (info->type != 1 || request->type != 3) return XR_ERROR_INITIALIZATION_FAILED;
  request->interface_version = 1;
  request->api_version = XR_MAKE_VERSION(1, 0, 20);
  request->get_instance_proc_addr = get_instance_proc_addr;
  return XR_SUCCESS;
}

__attribute__((visibility("default"))) MockRuntime* nendo_mock_runtime() {
  return &runtime;
}

__attribute__((visibility("default"))) void nendo_mock_event(XrSession session,
                                                             XrSessionState state) {
  if (auto* const found = object_of(sessions, session))
    found->instance->events.push_back({session, state});
}
}
