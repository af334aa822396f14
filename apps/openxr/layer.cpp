// The layer's dispatch: what the loader negotiates with, and the intercepted functions of
// instances and sessions. The C++ library is not linked, and nothing throws.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "openxr/chain.hpp"
#include "openxr/layer_state.hpp"
#include "openxr/loader_interface.hpp"

namespace nendo::openxr {

constinit Tables tables;
pthread_mutex_t layer_lock = PTHREAD_MUTEX_INITIALIZER;

namespace {

constexpr std::int64_t between_looks_ns = 100'000'000;

template <class Function>
void resolve(const Instance& instance, const char* name, Function& function) noexcept {
  PFN_xrVoidFunction found = nullptr;
  if (XR_SUCCEEDED(instance.next.get_instance_proc_addr(instance.handle, name, &found)))
    function = reinterpret_cast<Function>(found);
}

/// Resolves the functions of the next layer. Returns false if one of the core is missing.
bool resolve_all(Instance& instance) noexcept {
  Functions& next = instance.next;
  resolve(instance, "xrDestroyInstance", next.destroy_instance);
  resolve(instance, "xrGetSystemProperties", next.get_system_properties);
  resolve(instance, "xrStructureTypeToString", next.structure_type_to_string);
  resolve(instance, "xrPollEvent", next.poll_event);
  resolve(instance, "xrCreateSession", next.create_session);
  resolve(instance, "xrDestroySession", next.destroy_session);
  resolve(instance, "xrCreateReferenceSpace", next.create_reference_space);
  resolve(instance, "xrDestroySpace", next.destroy_space);
  resolve(instance, "xrLocateSpace", next.locate_space);
  if (instance.below.has(Extension::hand_tracking)) {
    resolve(instance, "xrCreateHandTrackerEXT", next.create_hand_tracker);
    resolve(instance, "xrDestroyHandTrackerEXT", next.destroy_hand_tracker);
    resolve(instance, "xrLocateHandJointsEXT", next.locate_hand_joints);
  }
  if (instance.below.has(Extension::timespec))
    resolve(instance, "xrConvertTimespecTimeToTimeKHR", next.convert_timespec);
  return next.destroy_instance != nullptr && next.get_system_properties != nullptr &&
         next.structure_type_to_string != nullptr && next.poll_event != nullptr &&
         next.create_session != nullptr && next.destroy_session != nullptr &&
         next.create_reference_space != nullptr && next.destroy_space != nullptr &&
         next.locate_space != nullptr;
}

/// Reads NENDO_XR and NENDO_XR_STAGE.
void read_environment(Instance& instance) noexcept {
  const char* const name = std::getenv("NENDO_XR");
  if (name != nullptr && !instance.segment.set_name(name))
    std::fprintf(stderr,
                 "nendo-openxr: NENDO_XR: no name of a segment, so there are no hands; use NAME of "
                 "`nendo run --to shm:NAME`\n");
  const char* const stage = std::getenv("NENDO_XR_STAGE");
  if (stage != nullptr && !read_placement(stage, instance.placement))
    std::fprintf(stderr,
                 "nendo-openxr: NENDO_XR_STAGE: no placement, so the usual one is used; %s\n",
                 stage_placement_rule);
}

void report(Instance& instance, SegmentState state) noexcept {
  if (state == instance.reported) return;
  instance.reported = state;
  const char* const path = instance.segment.path();
  switch (state) {
  case SegmentState::mapped:
    std::fprintf(stderr, "nendo-openxr: %s: has the hands\n", path);
    break;
  case SegmentState::missing:
    std::fprintf(stderr,
                 "nendo-openxr: %s: no run publishes hands there yet; start `nendo run --to "
                 "shm:NAME` with the NAME in NENDO_XR\n",
                 path);
    break;
  case SegmentState::refused:
    std::fprintf(stderr,
                 "nendo-openxr: %s: cannot be opened: %s; run nendo as the same user, or "
                 "with --to 'shm:NAME?group=GROUP'\n",
                 path, std::strerror(instance.segment.error()));
    break;
  case SegmentState::unusable:
    std::fprintf(stderr,
                 "nendo-openxr: %s: is no segment of version %d; use a nendo-openxr of the same "
                 "release as nendo\n",
                 path, NENDO_PUBLISH_MAJOR);
    break;
  }
}

XrResult XRAPI_CALL destroy_instance(XrInstance handle) noexcept {
  Instance* const instance = tables.instances.find(handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  const LayerLock lock; // throughout, for the runtime may give the handle to another instance then
  const XrResult result = instance->next.destroy_instance(handle);
  if (XR_FAILED(result)) return result;
  // Its sessions and trackers are destroyed with it.
  tables.trackers.for_each([instance](const Tracker& tracker) {
    if (tracker.instance == instance) tables.trackers.remove(&tracker);
  });
  tables.sessions.for_each([instance](const Session& session) {
    if (session.instance == instance) tables.sessions.remove(&session);
  });
  instance->segment.close();
  tables.instances.remove(instance);
  return result;
}

XrResult XRAPI_CALL get_system_properties(XrInstance handle, XrSystemId system,
                                          XrSystemProperties* properties) noexcept {
  Instance* const instance = tables.instances.find(handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  if (properties == nullptr) return XR_ERROR_VALIDATION_FAILURE;
  constexpr XrStructureType type = XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT;
  auto* const hands = in_chain<XrSystemHandTrackingPropertiesEXT>(properties->next, type);
  XrResult result = XR_SUCCESS;
  {
    const HiddenInChain hidden(*properties, type, !instance->below.has(Extension::hand_tracking));
    result = instance->next.get_system_properties(handle, system, properties);
  }
  if (XR_SUCCEEDED(result) && hands != nullptr) hands->supportsHandTracking = XR_TRUE;
  return result;
}

/// The runtime knows no names of structures that only this layer has.
XrResult XRAPI_CALL structure_type_to_string(XrInstance handle, XrStructureType type,
                                             char buffer[XR_MAX_STRUCTURE_NAME_SIZE]) noexcept {
  const Instance* const instance = tables.instances.find(handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  const NamedStructure* const own = structure_of(type);
  if (own == nullptr || !instance->enabled.has(own->extension) ||
      instance->below.has(own->extension))
    return instance->next.structure_type_to_string(handle, type, buffer);
  if (buffer == nullptr) return XR_ERROR_VALIDATION_FAILURE;
  std::snprintf(buffer, XR_MAX_STRUCTURE_NAME_SIZE, "%s", own->name);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL create_session(XrInstance handle, const XrSessionCreateInfo* info,
                                   XrSession* session) noexcept {
  Instance* const instance = tables.instances.find(handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  const XrResult result = instance->next.create_session(handle, info, session);
  if (XR_FAILED(result)) return result;
  const LayerLock lock;
  Session* const entry = tables.sessions.reserve();
  if (entry == nullptr) {
    instance->next.destroy_session(*session);
    *session = XR_NULL_HANDLE;
    return XR_ERROR_LIMIT_REACHED;
  }
  entry->instance = instance;
  entry->handle = *session;
  tables.sessions.add(entry, *session);
  return result;
}

XrResult XRAPI_CALL destroy_session(XrSession handle) noexcept {
  Session* const session = tables.sessions.find(handle);
  if (session == nullptr) return XR_ERROR_HANDLE_INVALID;
  const LayerLock lock;
  const Functions& next = session->instance->next;
  tables.trackers.for_each([&](const Tracker& tracker) {
    if (tracker.session != session) return;
    if (tracker.is_below) next.destroy_hand_tracker(tracker.handle);
    tables.trackers.remove(&tracker);
  });
  if (session->stage != XR_NULL_HANDLE) next.destroy_space(session->stage);
  session->stage = XR_NULL_HANDLE;
  const XrResult result = next.destroy_session(handle);
  if (XR_SUCCEEDED(result)) tables.sessions.remove(session);
  return result;
}

XrResult XRAPI_CALL poll_event(XrInstance handle, XrEventDataBuffer* event) noexcept {
  Instance* const instance = tables.instances.find(handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  const XrResult result = instance->next.poll_event(handle, event);
  if (result == XR_SUCCESS && event->type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
    const auto& change = *reinterpret_cast<const XrEventDataSessionStateChanged*>(event);
    if (Session* const session = tables.sessions.find(change.session))
      session->has_focus.store(change.state == XR_SESSION_STATE_FOCUSED, std::memory_order_relaxed);
  }
  // Once per frame would be too often for system calls.
  if (now_ns() < instance->next_look_ns.load(std::memory_order_relaxed)) return result;
  if (::pthread_mutex_trylock(&layer_lock) == 0) {
    look_around(*instance);
    ::pthread_mutex_unlock(&layer_lock);
  }
  return result;
}

struct Intercepted {
  const char* name;
  PFN_xrVoidFunction function;
};
template <class Function>
PFN_xrVoidFunction untyped(Function* function) noexcept {
  return reinterpret_cast<PFN_xrVoidFunction>(function);
}

XrResult XRAPI_CALL get_instance_proc_addr(XrInstance handle, const char* name,
                                           PFN_xrVoidFunction* function) noexcept {
  if (name == nullptr || function == nullptr) return XR_ERROR_VALIDATION_FAILURE;
  *function = nullptr;
  const Instance* const instance = tables.instances.find(handle);
  if (instance == nullptr) return XR_ERROR_HANDLE_INVALID;
  const std::array always{Intercepted{"xrGetInstanceProcAddr", untyped(get_instance_proc_addr)},
                          Intercepted{"xrDestroyInstance", untyped(destroy_instance)}};
  const std::array for_hands{
      Intercepted{"xrGetSystemProperties", untyped(get_system_properties)},
      Intercepted{"xrStructureTypeToString", untyped(structure_type_to_string)},
      Intercepted{"xrCreateSession", untyped(create_session)},
      Intercepted{"xrDestroySession", untyped(destroy_session)},
      Intercepted{"xrPollEvent", untyped(poll_event)},
      Intercepted{"xrCreateHandTrackerEXT", untyped(create_hand_tracker)},
      Intercepted{"xrDestroyHandTrackerEXT", untyped(destroy_hand_tracker)},
      Intercepted{"xrLocateHandJointsEXT", untyped(locate_hand_joints)}};
  const auto find = [&](const auto& list) {
    for (const Intercepted& each : list)
      if (std::strcmp(each.name, name) == 0) *function = each.function;
    return *function != nullptr;
  };
  // An application that does not ask for hands reaches the runtime directly.
  if (find(always) || (instance->enabled.has(Extension::hand_tracking) && find(for_hands)))
    return XR_SUCCESS;
  return instance->next.get_instance_proc_addr(handle, name, function);
}

/// Returns the function of the end of the chain, which asks the runtime. The layers between, such
/// as Debian's that validate, answer nothing before there is an instance, and some do not bear the
/// question, or a failed attempt.
PFN_xrGetInstanceProcAddr runtime_functions(const NextInfo& own) noexcept {
  const NextInfo* last = &own;
  while (last->next != nullptr && last->next->next_get_instance_proc_addr != nullptr)
    last = last->next;
  return last->next_get_instance_proc_addr;
}

/// Calls down with the extensions that are there. `below` becomes those that the runtime has.
XrResult create_below(const XrInstanceCreateInfo& info, const CreateInfo& layer_info,
                      ExtensionSet& below, XrInstance* handle) noexcept {
  const NextInfo& own = *layer_info.next_info;
  CreateInfo for_next = layer_info;
  for_next.next_info = own.next;
  InfoForBelow filtered;
  const bool is_known = ask_runtime(runtime_functions(own), below);
  if (!is_known) below = enabled_by(info); // try whether the runtime has them
  if (!filtered.fill(info, below)) return XR_ERROR_OUT_OF_MEMORY;
  const XrResult result = own.next_create_api_layer_instance(&filtered.info(), &for_next, handle);
  if (is_known || result != XR_ERROR_EXTENSION_NOT_PRESENT) return result;
  below = {};
  if (!filtered.fill(info, below)) return XR_ERROR_OUT_OF_MEMORY;
  return own.next_create_api_layer_instance(&filtered.info(), &for_next, handle);
}

bool is_complete(const XrInstanceCreateInfo* info, const CreateInfo* layer_info) noexcept {
  return info != nullptr && layer_info != nullptr &&
         layer_info->type == LoaderStructure::create_info &&
         layer_info->version == loader_structure_version &&
         layer_info->size == sizeof(CreateInfo) && layer_info->next_info != nullptr &&
         layer_info->next_info->type == LoaderStructure::next_info &&
         layer_info->next_info->version == loader_structure_version &&
         layer_info->next_info->size == sizeof(NextInfo) &&
         layer_info->next_info->next_get_instance_proc_addr != nullptr &&
         layer_info->next_info->next_create_api_layer_instance != nullptr;
}

XrResult XRAPI_CALL create_layer_instance(const XrInstanceCreateInfo* info,
                                          const CreateInfo* layer_info,
                                          XrInstance* handle) noexcept {
  if (!is_complete(info, layer_info) || handle == nullptr) return XR_ERROR_INITIALIZATION_FAILED;
  const LayerLock lock;
  Instance* const instance = tables.instances.reserve();
  if (instance == nullptr) return XR_ERROR_LIMIT_REACHED;
  instance->enabled = enabled_by(*info);
  const XrResult result = create_below(*info, *layer_info, instance->below, handle);
  if (XR_FAILED(result)) return result;
  instance->handle = *handle;
  instance->next.get_instance_proc_addr = layer_info->next_info->next_get_instance_proc_addr;
  if (!resolve_all(*instance)) {
    if (instance->next.destroy_instance != nullptr) instance->next.destroy_instance(*handle);
    *handle = XR_NULL_HANDLE;
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  if (instance->enabled.has(Extension::hand_tracking)) read_environment(*instance);
  tables.instances.add(instance, *handle);
  return result;
}

} // namespace

void look_around(Instance& instance) noexcept {
  const std::int64_t now = now_ns();
  instance.next_look_ns.store(now + between_looks_ns, std::memory_order_relaxed);
  if (instance.segment.path()[0] != '\0') report(instance, instance.segment.look());
  if (instance.next.convert_timespec == nullptr) return;
  const timespec monotonic{now / 1'000'000'000, now % 1'000'000'000};
  XrTime time = 0;
  if (XR_SUCCEEDED(instance.next.convert_timespec(instance.handle, &monotonic, &time)))
    instance.clock_offset_ns.store(time - now, std::memory_order_relaxed);
}

} // namespace nendo::openxr

/// The only exported function. OpenXR names it.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" __attribute__((visibility("default"))) XrResult XRAPI_CALL
xrNegotiateLoaderApiLayerInterface(const nendo::openxr::LoaderInfo* info, const char* layer_name,
                                   nendo::openxr::LayerRequest* request) noexcept {
  // NOLINTEND(readability-identifier-naming)
  using namespace nendo::openxr;
  static_cast<void>(layer_name); // the name in the manifest, whatever it is
  if (info == nullptr || request == nullptr || info->type != LoaderStructure::loader_info ||
      info->version != loader_structure_version || info->size != sizeof(LoaderInfo) ||
      request->type != LoaderStructure::layer_request ||
      request->version != loader_structure_version || request->size != sizeof(LayerRequest) ||
      info->min_interface_version > layer_interface_version ||
      info->max_interface_version < layer_interface_version ||
      info->min_api_version > XR_CURRENT_API_VERSION ||
      info->max_api_version < XR_MAKE_VERSION(1, 0, 0))
    return XR_ERROR_INITIALIZATION_FAILED;
  request->interface_version = layer_interface_version;
  request->api_version = XR_CURRENT_API_VERSION;
  request->get_instance_proc_addr = get_instance_proc_addr;
  request->create_api_layer_instance = create_layer_instance;
  return XR_SUCCESS;
}
