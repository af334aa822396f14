// The layer without the loader, which has one instance at a time: the test negotiates and makes the
// chain itself, by the specification's chapter on loaders.

#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "openxr/application.hpp"
#include "support/sanitizers.hpp"
#include "support/shell.hpp"

namespace openxr_chain_test {

using namespace nendo::test;

namespace {

struct LoaderInfo {
  std::uint32_t type = 1, version = 1;
  std::size_t size = sizeof(LoaderInfo);
  std::uint32_t min_interface = 1, max_interface = 1;
  XrVersion min_api = XR_MAKE_VERSION(1, 0, 0), max_api = XR_MAKE_VERSION(1, 0x3FF, 0xFFF);
};
struct CreateInfo;
using Create = XrResult(XRAPI_PTR*)(const XrInstanceCreateInfo*, const CreateInfo*, XrInstance*);
struct Request {
  std::uint32_t type = 2, version = 1;
  std::size_t size = sizeof(Request);
  std::uint32_t interface_version = 0;
  XrVersion api_version = 0;
  PFN_xrGetInstanceProcAddr get = nullptr;
  Create create = nullptr;
};
struct NextInfo {
  std::uint32_t type = 5, version = 1;
  std::size_t size = sizeof(NextInfo);
  char layer[256] = "XR_APILAYER_NENDO_hand_tracking";
  PFN_xrGetInstanceProcAddr get = nullptr;
  Create create = nullptr;
  NextInfo* next = nullptr;
};
struct CreateInfo {
  std::uint32_t type = 4, version = 1;
  std::size_t size = sizeof(CreateInfo);
  void* loader_instance = nullptr;
  char settings[512] = {};
  NextInfo* next_info = nullptr;
};
using Negotiate = XrResult(XRAPI_PTR*)(const LoaderInfo*, const char*, Request*);
using NegotiateRuntime = XrResult(XRAPI_PTR*)(const LoaderInfo*, void*);

/// The mock runtime's xrGetInstanceProcAddr.
PFN_xrGetInstanceProcAddr runtime_functions() {
  struct RuntimeRequest {
    std::uint32_t type = 3, version = 1;
    std::size_t size = sizeof(RuntimeRequest);
    std::uint32_t interface_version = 0;
    XrVersion api_version = 0;
    PFN_xrGetInstanceProcAddr get = nullptr;
  } request;
  void* const library = ::dlopen(NENDO_MOCK_RUNTIME, RTLD_NOW | RTLD_LOCAL);
  const LoaderInfo info;
  REQUIRE(reinterpret_cast<NegotiateRuntime>(::dlsym(library, "xrNegotiateLoaderRuntimeInterface"))(
              &info, &request) == XR_SUCCESS);
  ::dlclose(library);
  return request.get;
}

/// What the end of the chain got.
struct Seen {
  const CreateInfo* create_info = nullptr;
  const NextInfo* next_info = nullptr;
  std::string settings;
  void* loader_instance = nullptr;
};
Seen seen;

XrResult XRAPI_CALL create_at_the_end(const XrInstanceCreateInfo* info,
                                      const CreateInfo* create_info, XrInstance* instance) {
  seen = {create_info, create_info->next_info, create_info->settings, create_info->loader_instance};
  PFN_xrVoidFunction create = nullptr;
  runtime_functions()(XR_NULL_HANDLE, "xrCreateInstance", &create);
  return reinterpret_cast<PFN_xrCreateInstance>(create)(info, instance);
}

/// A layer between that answers nothing before there is an instance.
XrResult XRAPI_CALL get_of_a_silent_layer(XrInstance instance, const char* name,
                                          PFN_xrVoidFunction* function) {
  if (instance == XR_NULL_HANDLE) return XR_ERROR_HANDLE_INVALID;
  return runtime_functions()(instance, name, function);
}

class LoadedLayer {
public:
  LoadedLayer() : library_(::dlopen(NENDO_OPENXR_LAYER, RTLD_NOW | RTLD_LOCAL)) {
    REQUIRE_MESSAGE(library_ != nullptr, ::dlerror());
    negotiate =
        reinterpret_cast<Negotiate>(::dlsym(library_, "xrNegotiateLoaderApiLayerInterface"));
    REQUIRE((negotiate != nullptr));
    next.get = runtime_functions();
    next.create = create_at_the_end;
    next.next = &for_end;
    info.next_info = &next;
    info.loader_instance = &for_end;
    std::strcpy(info.settings, "/etc/settings");
  }
  ~LoadedLayer() { ::dlclose(library_); }
  LoadedLayer(const LoadedLayer&) = delete;
  LoadedLayer& operator=(const LoadedLayer&) = delete;

  Request negotiated() const {
    const LoaderInfo loader;
    Request request;
    REQUIRE(negotiate(&loader, "XR_APILAYER_NENDO_hand_tracking", &request) == XR_SUCCESS);
    return request;
  }
  std::unique_ptr<OpenInstance>
  open(const std::vector<const char*>& extensions = usual_extensions()) {
    const Request request = negotiated();
    const InstanceInfo instance_info(extensions);
    XrInstance instance = XR_NULL_HANDLE;
    REQUIRE(request.create(instance_info.get(), &info, &instance) == XR_SUCCESS);
    return std::make_unique<OpenInstance>(instance, request.get);
  }

  Negotiate negotiate = nullptr;
  NextInfo for_end;
  NextInfo next;
  CreateInfo info;

private:
  void* library_;
};

bool is_mapped(const std::string& name) {
  return contents("/proc/self/maps").find(name) != std::string::npos;
}
/// How often this process has mapped a segment.
int mappings_of(const std::string& name) {
  int found = 0;
  for (const std::string& line : lines_of(contents("/proc/self/maps")))
    found += line.ends_with("nendo-" + name) ? 1 : 0;
  return found;
}

} // namespace

TEST_SUITE("chain") {
  TEST_CASE("a loader of another interface or with other structures is refused") {
    const LoadedLayer layer;
    const Request good = layer.negotiated();
    CHECK(good.interface_version == 1);
    CHECK(good.api_version >= XR_MAKE_VERSION(1, 0, 0));
    const auto refuses = [&](const std::function<void(LoaderInfo&, Request&)>& change) {
      LoaderInfo info;
      Request request;
      change(info, request);
      const bool refused =
          layer.negotiate(&info, "name", &request) == XR_ERROR_INITIALIZATION_FAILED;
      return refused && request.get == nullptr && request.create == nullptr;
    };
    CHECK(refuses([](LoaderInfo& info, Request&) { info.type = 2; }));
    CHECK(refuses([](LoaderInfo& info, Request&) { info.version = 2; }));
    CHECK(refuses([](LoaderInfo& info, Request&) { --info.size; }));
    CHECK(refuses([](LoaderInfo& info, Request&) { info.min_interface = info.max_interface = 2; }));
    CHECK(refuses([](LoaderInfo& info, Request&) { info.max_interface = 0; }));
    CHECK(refuses([](LoaderInfo& info, Request&) { info.min_api = XR_MAKE_VERSION(7, 0, 0); }));
    CHECK(refuses([](LoaderInfo& info, Request&) { info.max_api = XR_MAKE_VERSION(0, 9, 0); }));
    CHECK(refuses([](LoaderInfo&, Request& request) { request.type = 3; }));
    CHECK(refuses([](LoaderInfo&, Request& request) { request.version = 0; }));
    CHECK(refuses([](LoaderInfo&, Request& request) { request.size = 8; }));
    Request request;
    CHECK(layer.negotiate(nullptr, "name", &request) == XR_ERROR_INITIALIZATION_FAILED);
    const LoaderInfo info;
    CHECK(layer.negotiate(&info, "name", nullptr) == XR_ERROR_INITIALIZATION_FAILED);
  }

  TEST_CASE("the next layer gets a copy of the loader's structure, one step further") {
    fresh_runtime();
    LoadedLayer layer;
    const auto before = layer.info;
    const auto instance = layer.open();
    CHECK(std::memcmp(&before, &layer.info, sizeof before) == 0);
    CHECK(seen.create_info != &layer.info);
    CHECK(seen.next_info == &layer.for_end);
    CHECK(seen.settings == "/etc/settings");
    CHECK(seen.loader_instance == &layer.for_end);
  }

  TEST_CASE("an incomplete chain is refused") {
    MockRuntime& runtime = fresh_runtime();
    LoadedLayer layer;
    const Request request = layer.negotiated();
    const InstanceInfo info(usual_extensions());
    XrInstance instance = XR_NULL_HANDLE;
    const auto refuses = [&](const std::function<void(CreateInfo&, NextInfo&)>& change) {
      CreateInfo create = layer.info;
      NextInfo next = layer.next;
      create.next_info = &next;
      change(create, next);
      return request.create(info.get(), &create, &instance) == XR_ERROR_INITIALIZATION_FAILED;
    };
    CHECK(refuses([](CreateInfo& create, NextInfo&) { create.type = 5; }));
    CHECK(refuses([](CreateInfo& create, NextInfo&) { create.version = 9; }));
    CHECK(refuses([](CreateInfo& create, NextInfo&) { create.size = 0; }));
    CHECK(refuses([](CreateInfo& create, NextInfo&) { create.next_info = nullptr; }));
    CHECK(refuses([](CreateInfo&, NextInfo& next) { next.type = 4; }));
    CHECK(refuses([](CreateInfo&, NextInfo& next) { next.version = 0; }));
    CHECK(refuses([](CreateInfo&, NextInfo& next) { ++next.size; }));
    CHECK(refuses([](CreateInfo&, NextInfo& next) { next.get = nullptr; }));
    CHECK(refuses([](CreateInfo&, NextInfo& next) { next.create = nullptr; }));
    CHECK(request.create(nullptr, &layer.info, &instance) == XR_ERROR_INITIALIZATION_FAILED);
    CHECK(request.create(info.get(), nullptr, &instance) == XR_ERROR_INITIALIZATION_FAILED);
    CHECK(request.create(info.get(), &layer.info, nullptr) == XR_ERROR_INITIALIZATION_FAILED);
    CHECK(runtime.create_calls == 0);
  }

  TEST_CASE("two instances with two sessions each have their hands by themselves") {
    MockRuntime& runtime = fresh_runtime();
    LoadedLayer layer;
    const std::string name = WrittenSegment::unique_name("two");
    const std::string other_name = name + ".other";
    WrittenSegment segment(name);
    WrittenSegment other(other_name);
    std::unique_ptr<OpenInstance> one;
    std::unique_ptr<OpenInstance> two;
    {
      const Variable variable("NENDO_XR", name);
      one = layer.open();
    }
    {
      const Variable variable("NENDO_XR", other_name);
      two = layer.open();
    }
    const auto radius = sample_radius(1, 0);
    std::vector<std::unique_ptr<OpenSession>> sessions;
    std::vector<XrHandTrackerEXT> trackers;
    for (OpenInstance* const instance : {one.get(), two.get()})
      for (int n = 0; n < 2; ++n) {
        sessions.push_back(std::make_unique<OpenSession>(*instance));
        trackers.push_back(sessions.back()->track(XR_HAND_RIGHT_EXT));
      }
    segment->write({sample_hand(0.1F), sample_hand(0.2F)}, monotonic_ns());
    other->write({sample_hand(0.3F), sample_hand(0.4F)}, monotonic_ns());
    const auto x_of = [&](std::size_t n) {
      const LocatedHand hand =
          sessions[n]->locate(trackers[n], sessions[n]->spaces[1], monotonic_ns());
      return hand.is_active && hand.joints[0].radius == radius ? hand.joints[0].pose.position.x
                                                               : -1.0F;
    };
    CHECK(x_of(0) == 0.2F);
    CHECK(x_of(1) == 0.2F);
    CHECK(x_of(2) == 0.4F);
    CHECK(x_of(3) == 0.4F);
    sessions[2]->set_state(XR_SESSION_STATE_VISIBLE); // of this session alone
    CHECK(x_of(2) == -1.0F);
    CHECK(x_of(3) == 0.4F);
    sessions[0]->destroy();
    CHECK(x_of(1) == 0.2F);
    // An instance ends with what it has.
    const XrHandTrackerEXT gone = trackers[1];
    const auto locate = one->function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT");
    for (std::size_t n = 0; n < 2; ++n)
      sessions[n]->handle = XR_NULL_HANDLE;
    one->destroy();
    CHECK(mappings_of(name) == 1); // the writer's
    CHECK(
        OpenSession::locate_by(locate, gone, sessions[3]->spaces[1], 1, nullptr, nullptr).result ==
        XR_ERROR_HANDLE_INVALID);
    CHECK(x_of(3) == 0.4F);
    for (std::size_t n = 2; n < 4; ++n)
      CHECK(sessions[n]->destroy() == XR_SUCCESS);
    two->destroy();
    CHECK(runtime.instances == 0);
    CHECK(runtime.sessions == 0);
    CHECK(runtime.spaces == 0);
  }

  TEST_CASE("instances and sessions beyond the layer's limits are refused, and leave nothing") {
    MockRuntime& runtime = fresh_runtime();
    LoadedLayer layer;
    const Request request = layer.negotiated();
    const InstanceInfo info(usual_extensions());
    std::vector<std::unique_ptr<OpenInstance>> instances;
    XrResult result = XR_SUCCESS;
    while (instances.size() < 1000) {
      XrInstance instance = XR_NULL_HANDLE;
      result = request.create(info.get(), &layer.info, &instance);
      if (result != XR_SUCCESS) break;
      instances.push_back(std::make_unique<OpenInstance>(instance, request.get));
    }
    CHECK(result == XR_ERROR_LIMIT_REACHED);
    CHECK(runtime.instances == static_cast<int>(instances.size()));
    OpenInstance& last = *instances.back();
    XrSessionCreateInfo create{};
    create.type = XR_TYPE_SESSION_CREATE_INFO;
    create.systemId = 1;
    int sessions = 0;
    for (XrSession session = XR_NULL_HANDLE; sessions < 1000; ++sessions) {
      result = last.call<PFN_xrCreateSession>("xrCreateSession", last.handle, &create, &session);
      if (result != XR_SUCCESS) break;
    }
    CHECK(result == XR_ERROR_LIMIT_REACHED);
    CHECK(runtime.sessions == sessions);
    instances.clear();
    CHECK(runtime.instances == 0);
    CHECK(layer.open() != nullptr);
  }

  TEST_CASE("a runtime that answers no question before there is an instance is tried") {
    MockRuntime& runtime = fresh_runtime();
    runtime.answers_before_instance = false;
    LoadedLayer layer;
    SUBCASE("it has no hands") {
      const auto instance = layer.open();
      CHECK(runtime.refused_creates == 1);
      CHECK(runtime.extensions == 1);
      OpenSession session(*instance);
      session.track(XR_HAND_LEFT_EXT);
      CHECK(runtime.trackers == 0);
    }
    SUBCASE("it has hands") {
      runtime.has_hand_tracking = true;
      const auto instance = layer.open();
      CHECK(runtime.refused_creates == 0);
      OpenSession session(*instance);
      session.track(XR_HAND_LEFT_EXT);
      CHECK(runtime.trackers == 1);
    }
    SUBCASE("the application wants another extension that nothing has") {
      const Request request = layer.negotiated();
      const InstanceInfo info({XR_EXT_HAND_TRACKING_EXTENSION_NAME, "XR_EXT_nothing"});
      XrInstance instance = XR_NULL_HANDLE;
      CHECK(request.create(info.get(), &layer.info, &instance) == XR_ERROR_EXTENSION_NOT_PRESENT);
      CHECK(runtime.instances == 0);
    }
  }

  TEST_CASE("the runtime is asked for its extensions at the end of the chain") {
    MockRuntime& runtime = fresh_runtime();
    LoadedLayer layer;
    layer.next.get = get_of_a_silent_layer;
    layer.for_end.get = runtime_functions();
    const auto instance = layer.open();
    CHECK(runtime.create_calls == 1);
    REQUIRE(runtime.extensions == 2);
    CHECK(std::string(runtime.extension[0]) == XR_MND_HEADLESS_EXTENSION_NAME);
    OpenSession session(*instance);
    session.track(XR_HAND_LEFT_EXT);
  }

  TEST_CASE("unknown handles and names are refused") {
    fresh_runtime();
    LoadedLayer layer;
    const auto instance = layer.open();
    const auto get = layer.negotiated().get;
    PFN_xrVoidFunction function = nullptr;
    CHECK(get(XR_NULL_HANDLE, "xrPollEvent", &function) == XR_ERROR_HANDLE_INVALID);
    CHECK(get(instance->handle, nullptr, &function) == XR_ERROR_VALIDATION_FAILURE);
    CHECK(get(instance->handle, "xrPollEvent", nullptr) == XR_ERROR_VALIDATION_FAILURE);
    CHECK(get(instance->handle, "xrNothing", &function) == XR_ERROR_FUNCTION_UNSUPPORTED);
    CHECK((function == nullptr));
    int nothing = 0;
    auto* const stranger = reinterpret_cast<XrInstance>(&nothing);
    auto* const session = reinterpret_cast<XrSession>(&nothing);
    XrEventDataBuffer event{};
    event.type = XR_TYPE_EVENT_DATA_BUFFER;
    CHECK(instance->call<PFN_xrPollEvent>("xrPollEvent", stranger, &event) ==
          XR_ERROR_HANDLE_INVALID);
    CHECK(instance->call<PFN_xrDestroySession>("xrDestroySession", session) ==
          XR_ERROR_HANDLE_INVALID);
    XrSessionCreateInfo create{};
    create.type = XR_TYPE_SESSION_CREATE_INFO;
    XrSession made = XR_NULL_HANDLE;
    CHECK(instance->call<PFN_xrCreateSession>("xrCreateSession", stranger, &create, &made) ==
          XR_ERROR_HANDLE_INVALID);
    XrSystemProperties properties{};
    properties.type = XR_TYPE_SYSTEM_PROPERTIES;
    CHECK(instance->call<PFN_xrGetSystemProperties>("xrGetSystemProperties", stranger,
                                                    XrSystemId{1},
                                                    &properties) == XR_ERROR_HANDLE_INVALID);
    CHECK(instance->call<PFN_xrDestroyInstance>("xrDestroyInstance", stranger) ==
          XR_ERROR_HANDLE_INVALID);
  }

  TEST_CASE("threads locate hands while segments come and go") {
    fresh_runtime();
    LoadedLayer layer;
    const std::string name = WrittenSegment::unique_name("threads");
    const Variable variable("NENDO_XR", name);
    const auto instance = layer.open();
    OpenSession session(*instance);
    const auto tracker = session.track(XR_HAND_LEFT_EXT);
    const auto locate = instance->function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT");
    std::atomic<bool> ends{false};
    std::atomic<int> wrong{0};
    std::atomic<int> active{0};
    const auto reader = [&] {
      while (!ends) {
        const LocatedHand hand = OpenSession::locate_by(locate, tracker, session.spaces[1],
                                                        monotonic_ns(), nullptr, nullptr);
        active += hand.is_active ? 1 : 0;
        // A hand is of one segment: its joints are 3 mm apart.
        const float apart = hand.joints[1].pose.position.x - hand.joints[0].pose.position.x;
        if (hand.result != XR_SUCCESS || (hand.is_active && std::abs(apart - 0.003F) > 1e-5F))
          ++wrong;
      }
    };
    std::thread one(reader);
    std::thread two(reader);
    for (int turn = 0; turn < 200; ++turn) {
      WrittenSegment segment(name);
      const WrittenHand hand = sample_hand(0.1F * static_cast<float>(turn % 10));
      segment->write({hand, hand}, monotonic_ns());
      // A new tracker looks at once.
      const auto other = session.track(XR_HAND_RIGHT_EXT);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      instance->call<PFN_xrDestroyHandTrackerEXT>("xrDestroyHandTrackerEXT", other);
    }
    ends = true;
    one.join();
    two.join();
    CHECK(wrong == 0);
    CHECK(active > 0);
    session.poll();
  }

  TEST_CASE("nothing is left when the layer is unloaded") {
    fresh_runtime();
    const std::string name = WrittenSegment::unique_name("unload");
    const Variable variable("NENDO_XR", name);
    const WrittenSegment segment(name);
    const int of_writer = mappings_of(name);
    for (int turn = 0; turn < 3; ++turn) {
      LoadedLayer layer;
      CHECK(is_mapped("libXrApiLayer_nendo.so"));
      const auto instance = layer.open();
      OpenSession session(*instance);
      session.track(XR_HAND_LEFT_EXT);
      CHECK(mappings_of(name) == of_writer + 1);
      session.destroy();
    }
    CHECK(mappings_of(name) == of_writer);
    CHECK_FALSE(is_mapped("libXrApiLayer_nendo.so"));
  }

  TEST_CASE("the layer exports one function, and needs the C library alone") {
    const std::string layer = NENDO_OPENXR_LAYER;
    const Spoken names = shell("nm --dynamic --defined-only '" + layer + "'");
    REQUIRE(names.exit_code == 0);
    const bool is_watched = NENDO_WATCHES_MEMORY || NENDO_WATCHES_THREADS;
    int exported = 0;
    for (const std::string& line : lines_of(names.out)) // the sanitizers export data of their own
      if (!line.empty() && (!is_watched || line.find(" T ") != std::string::npos)) ++exported;
    CHECK(exported == 1);
    CHECK(names.out.find(" T xrNegotiateLoaderApiLayerInterface") != std::string::npos);
    if (is_watched) return; // they bring the C++ library
    const Spoken needed = shell("readelf --dynamic '" + layer + "' | grep NEEDED");
    for (const std::string& line : lines_of(needed.out))
      CHECK_MESSAGE((line.find("[libc.so") != std::string::npos ||
                     line.find("[libm.so") != std::string::npos ||
                     line.find("[ld-linux") != std::string::npos),
                    line);
  }
}

} // namespace openxr_chain_test
