#include "stress/platform_floor.hpp"

#include <thread>

namespace nendo::stress {

using namespace std::chrono_literals;

namespace {

void spin(HostTime end, PlatformFloor& floor) {
  const HostTime begin = HostClock::now();
  HostTime before = begin;
  while (before < end) {
    const HostTime now = HostClock::now();
    if (now - before > 1us) {
      floor.gaps.record(now - before);
      floor.stalled_s += to_seconds(now - before);
    }
    before = now;
  }
  floor.spun_s += to_seconds(before - begin);
}

} // namespace

PlatformFloor measure_floor(double seconds, const flow::RealtimeOptions& realtime,
                            const std::atomic<bool>& stop) {
  PlatformFloor floor;
  std::thread([&] {
    flow::make_thread_realtime(realtime);
    while (floor.spun_s < seconds && !stop) {
      spin(HostClock::now() + 20ms, floor);
      std::this_thread::sleep_for(3ms);
    }
  }).join();
  return floor;
}

} // namespace nendo::stress
