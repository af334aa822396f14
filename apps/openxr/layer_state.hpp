#pragma once
// What the layer keeps for each instance, session and hand tracker of an application.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <type_traits>

#include <openxr/openxr.h>
#include <pthread.h>

#define XR_USE_TIMESPEC
#include <openxr/openxr_platform.h>

#include "openxr/extensions.hpp"
#include "openxr/handle_table.hpp"
#include "openxr/segment_follower.hpp"
#include "openxr/stage_placement.hpp"

namespace nendo::openxr {

/// The functions of the next layer or of the runtime. Those of extensions may be null.
struct Functions {
  PFN_xrGetInstanceProcAddr get_instance_proc_addr = nullptr;
  PFN_xrDestroyInstance destroy_instance = nullptr;
  PFN_xrGetSystemProperties get_system_properties = nullptr;
  PFN_xrStructureTypeToString structure_type_to_string = nullptr;
  PFN_xrPollEvent poll_event = nullptr;
  PFN_xrCreateSession create_session = nullptr;
  PFN_xrDestroySession destroy_session = nullptr;
  PFN_xrCreateReferenceSpace create_reference_space = nullptr;
  PFN_xrDestroySpace destroy_space = nullptr;
  PFN_xrLocateSpace locate_space = nullptr;
  PFN_xrCreateHandTrackerEXT create_hand_tracker = nullptr;
  PFN_xrDestroyHandTrackerEXT destroy_hand_tracker = nullptr;
  PFN_xrLocateHandJointsEXT locate_hand_joints = nullptr;
  PFN_xrConvertTimespecTimeToTimeKHR convert_timespec = nullptr;
};

struct Instance {
  XrInstance handle = XR_NULL_HANDLE;
  Functions next;
  ExtensionSet enabled; ///< those that the application asked for
  ExtensionSet below;   ///< those that the runtime has
  StagePlacement placement;
  SegmentFollower segment;
  SegmentState reported = SegmentState::mapped;
  std::atomic<std::int64_t> next_look_ns{0};
  std::atomic<std::int64_t> clock_offset_ns{0}; ///< XrTime minus CLOCK_MONOTONIC
};

struct Session {
  Instance* instance = nullptr;
  XrSession handle = XR_NULL_HANDLE;
  XrSpace stage = XR_NULL_HANDLE; ///< Nendo's, made with the first tracker
  std::atomic<bool> has_focus{false};
};

struct Tracker {
  Instance* instance = nullptr;
  Session* session = nullptr;
  XrHandTrackerEXT handle = XR_NULL_HANDLE;
  XrSpace stage = XR_NULL_HANDLE;
  std::size_t side = 0;     ///< 0 left, 1 right
  bool is_below = false;    ///< the runtime has made it
  bool wants_gloves = true; ///< the data sources include unobstructed hands
};

/// Space for more than runtimes allow; the layer refuses handles beyond.
struct Tables {
  HandleTable<XrInstance, Instance, 8> instances;
  HandleTable<XrSession, Session, 16> sessions;
  HandleTable<XrHandTrackerEXT, Tracker, 64> trackers;
};
static_assert(std::is_trivially_destructible_v<Tables>, "nothing is left to do at dlclose()");

extern constinit Tables tables;
extern pthread_mutex_t layer_lock;

/// Holds the layer's lock, which is taken where handles are made and destroyed, and tried in
/// xrPollEvent.
class LayerLock {
public:
  LayerLock() noexcept { ::pthread_mutex_lock(&layer_lock); }
  ~LayerLock() noexcept { ::pthread_mutex_unlock(&layer_lock); }
  LayerLock(const LayerLock&) = delete;
  LayerLock& operator=(const LayerLock&) = delete;
};

/// Returns CLOCK_MONOTONIC. No system call where the kernel maps its clock.
inline std::int64_t now_ns() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// Under the lock. Looks for the segment, and for the runtime's clock. Prints a line if there is
/// no segment.
void look_around(Instance& instance) noexcept;

// The intercepted functions of trackers (hand_trackers.cpp).
XrResult XRAPI_CALL create_hand_tracker(XrSession session, const XrHandTrackerCreateInfoEXT* info,
                                        XrHandTrackerEXT* tracker) noexcept;
XrResult XRAPI_CALL destroy_hand_tracker(XrHandTrackerEXT tracker) noexcept;
XrResult XRAPI_CALL locate_hand_joints(XrHandTrackerEXT tracker,
                                       const XrHandJointsLocateInfoEXT* info,
                                       XrHandJointLocationsEXT* locations) noexcept;

} // namespace nendo::openxr
