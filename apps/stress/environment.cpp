#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>
#include <thread>

#include <sys/utsname.h>
#include <unistd.h>

#include "stress/stress_session.hpp"

namespace nendo::stress {
namespace {

using namespace std::chrono_literals;

std::string first_line(const char* path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

void read_processor(Environment& environment) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    const std::string value = line.substr(colon + 2);
    if (line.starts_with("model name") && environment.processor.empty())
      environment.processor = value;
    if (line.starts_with("flags"))
      environment.hypervisor = (" " + value + " ").find(" hypervisor ") != std::string::npos;
  }
}

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

Environment describe_environment() {
  Environment environment;
  utsname names{};
  if (::uname(&names) == 0) {
    environment.kernel = names.release;
    const std::string_view version = names.version;
    for (const char* kind : {"PREEMPT_RT", "PREEMPT_DYNAMIC", "PREEMPT"}) {
      if (environment.preemption.empty() && version.find(kind) != std::string_view::npos)
        environment.preemption = kind;
    }
  }
  read_processor(environment);
  environment.cpus = static_cast<unsigned>(std::max(1L, ::sysconf(_SC_NPROCESSORS_ONLN)));
  environment.governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  environment.clock_source =
      first_line("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  long runtime_us = 0;
  if (std::ifstream("/proc/sys/kernel/sched_rt_runtime_us") >> runtime_us)
    environment.rt_runtime_us = runtime_us;
  return environment;
}

std::optional<double> stolen_s() {
  // "cpu  user nice system idle iowait irq softirq steal ..."
  std::istringstream line(first_line("/proc/stat"));
  std::string name;
  line >> name;
  double value = 0.0;
  for (int column = 0; column < 8; ++column)
    line >> value;
  if (!line) return std::nullopt;
  return value / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

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
