// The functions of XR_EXT_hand_tracking. Where the runtime tracks hands itself, its own handles are
// passed to the application, so that other extensions work with them, and its joints are returned
// while no glove is live.

#include <bit>
#include <cmath>
#include <cstdio>

#include "openxr/chain.hpp"
#include "openxr/joint_locations.hpp"
#include "openxr/layer_state.hpp"
#include "openxr/loader_interface.hpp"

namespace nendo::openxr {
namespace {

bool is_valid(const DataSourceInfo& info) noexcept {
  if (info.count == 0 || info.sources == nullptr) return false;
  for (std::uint32_t n = 0; n < info.count; ++n) {
    if (info.sources[n] != DataSource::unobstructed && info.sources[n] != DataSource::controller)
      return false;
    for (std::uint32_t m = 0; m < n; ++m)
      if (info.sources[m] == info.sources[n]) return false;
  }
  return true;
}

/// Returns the data sources of the application, or null if it did not enable or chain them.
const DataSourceInfo* sources_of(const Instance& instance,
                                 const XrHandTrackerCreateInfoEXT& info) noexcept {
  if (!instance.enabled.has(Extension::data_source)) return nullptr;
  return in_chain<DataSourceInfo>(info.next, data_source_info_type);
}

bool is_valid(const Instance& instance, const XrHandTrackerCreateInfoEXT& info) noexcept {
  if (info.type != XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT) return false;
  if (info.hand != XR_HAND_LEFT_EXT && info.hand != XR_HAND_RIGHT_EXT) return false;
  if (info.handJointSet != XR_HAND_JOINT_SET_DEFAULT_EXT) return false;
  const DataSourceInfo* const sources = sources_of(instance, info);
  return sources == nullptr || is_valid(*sources);
}

/// Under the lock. Makes the space of Nendo's stage, once per session.
XrResult make_stage(Session& session) noexcept {
  if (session.stage != XR_NULL_HANDLE) return XR_SUCCESS;
  const Instance& instance = *session.instance;
  const XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr,
                                        instance.placement.space, instance.placement.pose};
  const XrResult result =
      instance.next.create_reference_space(session.handle, &info, &session.stage);
  if (XR_SUCCEEDED(result)) return result;
  session.stage = XR_NULL_HANDLE;
  if (result != XR_ERROR_REFERENCE_SPACE_UNSUPPORTED) return result;
  std::fprintf(stderr,
               "nendo-openxr: NENDO_XR_STAGE: the runtime has no space \"stage\", so there are "
               "no hands; use local:X,Y,Z\n");
  return XR_SUCCESS;
}

/// Under the lock. Lets the runtime make a tracker, if it tracks hands.
XrResult make_below(const Instance& instance, XrSession session,
                    const XrHandTrackerCreateInfoEXT& info, Tracker& tracker) noexcept {
  if (instance.next.create_hand_tracker == nullptr) return XR_SUCCESS;
  XrHandTrackerCreateInfoEXT for_below = info;
  for_below.next =
      without_first(info.next, data_source_info_type, !instance.below.has(Extension::data_source));
  const XrResult result = instance.next.create_hand_tracker(session, &for_below, &tracker.handle);
  // The runtime has the extension, but the system has no cameras for it.
  if (result == XR_ERROR_FEATURE_UNSUPPORTED) return XR_SUCCESS;
  tracker.is_below = XR_SUCCEEDED(result);
  return result;
}

/// Where the hand's joints are, if a glove is live and the application has the focus.
bool read_hand(const Tracker& tracker, XrTime time, PublishedHand& published,
               MovingHand& hand) noexcept {
  if (!tracker.wants_gloves || tracker.stage == XR_NULL_HANDLE) return false;
  if (!tracker.session->has_focus.load(std::memory_order_relaxed)) return false;
  const std::int64_t now = now_ns();
  if (!tracker.instance->segment.read(tracker.side, now, published)) return false;
  // A runtime whose clock is unknown asks for the newest pose.
  constexpr double max_distance_ns = 1e10;
  const std::int64_t offset = tracker.instance->clock_offset_ns.load(std::memory_order_relaxed);
  const double after_now_ns =
      static_cast<double>(time) - static_cast<double>(offset) - static_cast<double>(now);
  const bool is_known = std::abs(after_now_ns) <= max_distance_ns;
  hand = at_time(published, is_known ? time - offset : published.newest_ns);
  return true;
}

/// Asks the runtime. It gets no structures of extensions that it does not have.
XrResult locate_below(const Tracker& tracker, const XrHandJointsLocateInfoEXT& info,
                      XrHandJointLocationsEXT& locations) noexcept {
  const ExtensionSet& below = tracker.instance->below;
  XrHandJointsLocateInfoEXT for_below = info;
  for_below.next = without_first(info.next, XR_TYPE_HAND_JOINTS_MOTION_RANGE_INFO_EXT,
                                 !below.has(Extension::motion_range));
  auto* const state = source_state_of(locations);
  XrResult result = XR_SUCCESS;
  {
    const HiddenInChain hidden(locations, data_source_state_type,
                               !below.has(Extension::data_source));
    result = tracker.instance->next.locate_hand_joints(tracker.handle, &for_below, &locations);
  }
  if (state != nullptr && !below.has(Extension::data_source)) {
    state->is_active = locations.isActive;
    state->source = DataSource::unobstructed;
  }
  return result;
}

} // namespace

XrResult XRAPI_CALL create_hand_tracker(XrSession handle, const XrHandTrackerCreateInfoEXT* info,
                                        XrHandTrackerEXT* tracker) noexcept {
  Session* const session = tables.sessions.find(handle);
  if (session == nullptr) return XR_ERROR_HANDLE_INVALID;
  Instance& instance = *session->instance;
  if (info == nullptr || tracker == nullptr || !is_valid(instance, *info))
    return XR_ERROR_VALIDATION_FAILURE;
  const LayerLock lock;
  Tracker* const entry = tables.trackers.reserve();
  if (entry == nullptr) return XR_ERROR_LIMIT_REACHED;
  if (const XrResult result = make_stage(*session); XR_FAILED(result)) return result;
  const XrResult result = make_below(instance, handle, *info, *entry);
  if (XR_FAILED(result)) return result;
  // A handle of the layer is an address in its tables, which no other handle is.
  if (!entry->is_below)
    entry->handle = std::bit_cast<XrHandTrackerEXT>(reinterpret_cast<std::uintptr_t>(entry));
  entry->instance = &instance;
  entry->session = session;
  entry->stage = session->stage;
  entry->side = info->hand == XR_HAND_LEFT_EXT ? 0 : 1;
  if (const DataSourceInfo* const sources = sources_of(instance, *info)) {
    entry->wants_gloves = false;
    for (std::uint32_t n = 0; n < sources->count; ++n)
      entry->wants_gloves |= sources->sources[n] == DataSource::unobstructed;
  }
  look_around(instance); // the first call of xrLocateHandJointsEXT then has hands
  tables.trackers.add(entry, entry->handle);
  *tracker = entry->handle;
  return result;
}

XrResult XRAPI_CALL destroy_hand_tracker(XrHandTrackerEXT handle) noexcept {
  Tracker* const tracker = tables.trackers.find(handle);
  if (tracker == nullptr) return XR_ERROR_HANDLE_INVALID;
  const LayerLock lock;
  const XrResult result =
      tracker->is_below ? tracker->instance->next.destroy_hand_tracker(handle) : XR_SUCCESS;
  if (XR_SUCCEEDED(result)) tables.trackers.remove(tracker);
  return result;
}

XrResult XRAPI_CALL locate_hand_joints(XrHandTrackerEXT handle,
                                       const XrHandJointsLocateInfoEXT* info,
                                       XrHandJointLocationsEXT* locations) noexcept {
  const Tracker* const tracker = tables.trackers.find(handle);
  if (tracker == nullptr) return XR_ERROR_HANDLE_INVALID;
  if (!is_valid(info, locations)) return XR_ERROR_VALIDATION_FAILURE;
  if (info->time <= 0) return XR_ERROR_TIME_INVALID;
  PublishedHand published;
  MovingHand hand;
  const bool is_live = read_hand(*tracker, info->time, published, hand);
  if (!is_live && tracker->is_below) return locate_below(*tracker, *info, *locations);
  set_inactive(*locations);
  if (tracker->stage == XR_NULL_HANDLE) return XR_SUCCESS;
  XrSpaceVelocity velocity{};
  velocity.type = XR_TYPE_SPACE_VELOCITY;
  XrSpaceLocation stage{};
  stage.type = XR_TYPE_SPACE_LOCATION;
  stage.next = &velocity;
  // Also without a hand, because the runtime knows whether the base space and the time are valid.
  const XrResult result =
      tracker->instance->next.locate_space(tracker->stage, info->baseSpace, info->time, &stage);
  if (XR_SUCCEEDED(result) && is_live) set_joints(hand, published, stage, velocity, *locations);
  return result;
}

} // namespace nendo::openxr
