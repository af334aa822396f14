// An application that locates both hands in all spaces, at the rate of a head set or as fast as it
// can, while another thread publishes: openxr_frames CALLS [HZ [wrong]]. Prints what it measured as
// JSON. tools/check-openxr runs it between Debian's layers. With `wrong`, it ends with a call that
// a layer which validates must complain about.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#define DOCTEST_CONFIG_IMPLEMENT
#include "openxr/application.hpp"

namespace {

using namespace nendo::test;

struct Measured {
  int active = 0;
  int failed = 0;
  int stale = 0; ///< joints, of an inactive hand, with a valid bit
  std::vector<double> us;
};

Measured measure(OpenInstance& instance, OpenSession& session, int calls, double rate_hz) {
  const std::array trackers{session.track(XR_HAND_LEFT_EXT), session.track(XR_HAND_RIGHT_EXT)};
  const auto locate = instance.function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT");
  session.spaces.push_back(session.action_space());
  Measured measured;
  measured.us.reserve(static_cast<std::size_t>(calls));
  auto next = std::chrono::steady_clock::now();
  for (int call = 0; call < calls; ++call) {
    const auto n = static_cast<std::size_t>(call);
    if (call % 8 == 0) { // both hands in four spaces are one frame
      session.poll();
      if (call % 800 == 400) session.set_state(XR_SESSION_STATE_VISIBLE);
      if (call % 800 == 480) session.set_state(XR_SESSION_STATE_FOCUSED);
      if (rate_hz > 0.0)
        std::this_thread::sleep_until(next += std::chrono::duration_cast<std::chrono::nanoseconds>(
                                          std::chrono::duration<double>(1.0 / rate_hz)));
    }
    const XrTime time = monotonic_ns() + 20'000'000;
    const auto begin = std::chrono::steady_clock::now();
    const LocatedHand hand = OpenSession::locate_by(locate, trackers[n % 2],
                                                    session.spaces[n / 2 % session.spaces.size()],
                                                    time, nullptr, nullptr);
    measured.us.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
            .count());
    measured.active += hand.is_active ? 1 : 0;
    measured.failed += hand.result == XR_SUCCESS ? 0 : 1;
    measured.stale += !hand.is_active && !hand.all_have(0, 0) ? 1 : 0;
  }
  std::sort(measured.us.begin(), measured.us.end());
  return measured;
}

int run(int calls, double rate_hz, bool is_wrong) {
  MockRuntime& runtime = fresh_runtime();
  const std::string name = WrittenSegment::unique_name("frames");
  const LoaderEnvironment environment(name);
  WrittenSegment segment(name);
  segment->write({sample_hand(), sample_hand()}, monotonic_ns());
  std::atomic<bool> ends{false};
  std::thread writer([&] {
    for (int tick = 0; !ends; ++tick) {
      const float x = 0.001F * static_cast<float>(tick % 100);
      segment->write({sample_hand(-x), sample_hand(x)}, monotonic_ns());
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  Measured measured;
  const InstanceInfo info(usual_extensions());
  OpenInstance instance(XR_NULL_HANDLE, xrGetInstanceProcAddr);
  XrResult result = xrCreateInstance(info.get(), &instance.handle);
  if (result == XR_SUCCESS) {
    OpenSession session(instance);
    measured = measure(instance, session, calls, rate_hz);
    if (is_wrong) {
      const XrReferenceSpaceCreateInfo untyped{}; // whose type is another one
      XrSpace space = XR_NULL_HANDLE;
      instance.call<PFN_xrCreateReferenceSpace>("xrCreateReferenceSpace", session.handle, &untyped,
                                                &space);
    }
    session.destroy();
    instance.destroy();
  }
  ends = true;
  writer.join();
  if (result != XR_SUCCESS) {
    std::fprintf(stderr, "openxr_frames: xrCreateInstance: %d\n", result);
    return 1;
  }
  const auto percentile = [&](double part) {
    return measured
        .us[static_cast<std::size_t>(part * static_cast<double>(measured.us.size() - 1))];
  };
  std::printf("{\"calls\":%d,\"active\":%d,\"failed\":%d,\"stale\":%d,\"left\":%d,"
              "\"p50_us\":%.2f,\"p99_us\":%.2f,\"max_us\":%.2f}\n",
              calls, measured.active, measured.failed, measured.stale,
              runtime.spaces + runtime.sessions + runtime.trackers + runtime.instances,
              percentile(0.5), percentile(0.99), percentile(1.0));
  return 0;
}

} // namespace

int main(int argc, char** argv) {
  const int calls = argc > 1 ? std::atoi(argv[1]) : 0;
  if (argc < 2 || argc > 4 || calls < 1) {
    std::fprintf(stderr, "openxr_frames: usage: openxr_frames CALLS [HZ [wrong]]\n");
    return 2;
  }
  doctest::Context context; // for what the shared code requires
  context.setAsDefaultForAssertsOutOfTestCases();
  context.setAssertHandler([](const doctest::AssertData& failed) {
    std::fprintf(stderr, "%s:%d: %s\n", failed.m_file, failed.m_line, failed.m_expr);
    if (failed.m_failed) std::exit(1);
  });
  return run(calls, argc > 2 ? std::atof(argv[2]) : 0.0, argc > 3);
}
