#include <nendo/flow/realtime.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>

namespace nendo::flow {
namespace {

Grant judged(std::string name, std::string wanted, int error, std::string remedy) {
  if (error == 0) return {std::move(name), std::move(wanted), true, {}, {}};
  return {std::move(name), std::move(wanted), false, std::strerror(error), std::move(remedy)};
}

Grant fifo(std::string name, unsigned priority, pthread_t thread) {
  sched_param parameter{};
  parameter.sched_priority = static_cast<int>(priority);
  const int error = ::pthread_setschedparam(thread, SCHED_FIFO, &parameter);
  const std::string rank = std::to_string(priority);
  return judged(std::move(name), "SCHED_FIFO " + rank, error,
                "let `ulimit -r` be " + rank +
                    " or more: put `@audio - rtprio 99` into "
                    "/etc/security/limits.d/nendo.conf, join the group audio, and log in again");
}

Grant pinned(const std::vector<unsigned>& cpus) {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::string names;
  for (const unsigned cpu : cpus) {
    CPU_SET(cpu, &set);
    names += (names.empty() ? "" : ",") + std::to_string(cpu);
  }
  const int error = ::pthread_setaffinity_np(::pthread_self(), sizeof set, &set);
  return judged("affinity", "CPU " + names, error,
                "name CPUs that this process may use: `taskset -p $$` shows them");
}

// Where locked memory has a limit, every allocation beyond it would fail from then on: worse than a
// page fault.
int lock_memory() noexcept {
  rlimit limit{};
  ::getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur != RLIM_INFINITY && ::geteuid() != 0) return ENOMEM;
  // Freed memory is kept, and large blocks come from the heap: what was touched stays.
  ::mallopt(M_TRIM_THRESHOLD, -1);
  ::mallopt(M_MMAP_MAX, 0);
  return ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
}

// The maximum that the loop was seen to need is a tenth of it.
void touch_stack() noexcept {
  constexpr std::size_t bytes = std::size_t{256} * 1024;
  constexpr std::size_t page = 4096;
  std::array<char, bytes>
      stack; // NOLINT(cppcoreguidelines-pro-type-member-init): that is the point
  for (std::size_t at = 0; at < bytes; at += page)
    static_cast<volatile char&>(stack[at]) = 0;
}

} // namespace

Result<std::vector<unsigned>> parse_cpus(const std::string& text, const std::string& option) {
  const auto configured = static_cast<unsigned>(std::max(1L, ::sysconf(_SC_NPROCESSORS_CONF)));
  const unsigned count = std::min<unsigned>(configured, CPU_SETSIZE);
  const Error bad{Errc::usage, option + " " + text + ": use CPUs from 0 to " +
                                   std::to_string(count - 1) + ", like 0 or 0,1 or 0-1"};
  std::vector<unsigned> cpus;
  for (ItemReader items(text, ','); !items.has_ended();) {
    std::string_view item = items.next();
    const bool is_one = item.find('-') == std::string_view::npos;
    const auto first = number_in<unsigned>(cut(item, '-'));
    const auto last = is_one ? first : number_in<unsigned>(item);
    if (!first || !last || *last < *first || *last >= count) return bad;
    for (unsigned cpu = *first; cpu <= *last; ++cpu)
      cpus.push_back(cpu);
  }
  std::sort(cpus.begin(), cpus.end());
  cpus.erase(std::unique(cpus.begin(), cpus.end()), cpus.end());
  return cpus;
}

std::vector<std::string> refusals(const std::vector<Grant>& grants) {
  std::vector<std::string> lines;
  for (const Grant& grant : grants) {
    if (!grant.granted)
      lines.push_back(grant.wanted + " refused (" + grant.why + "); to get it, " + grant.remedy);
  }
  return lines;
}

RealtimeProcess::RealtimeProcess(const RealtimeOptions& options) {
  if (options.lock_memory) {
    grants_.push_back(judged("memory_lock", "locked memory", lock_memory(),
                             "let `ulimit -l` be unlimited: put `@audio - memlock unlimited` into "
                             "/etc/security/limits.d/nendo.conf, join the group audio, and log in "
                             "again"));
  }
  if (options.priority > 0) {
    constexpr const char* path = "/dev/cpu_dma_latency";
    constexpr std::int32_t latency_us = 0;
    latency_file_ = ::open(path, O_WRONLY | O_CLOEXEC);
    const bool written =
        latency_file_ >= 0 && ::write(latency_file_, &latency_us, sizeof latency_us) ==
                                  static_cast<ssize_t>(sizeof latency_us);
    grants_.push_back(judged("dma_latency", "no deep sleep of the processor", written ? 0 : errno,
                             "allow writing to /dev/cpu_dma_latency: `sudo chgrp audio "
                             "/dev/cpu_dma_latency && sudo chmod g+w /dev/cpu_dma_latency`"));
  }
}

RealtimeProcess::~RealtimeProcess() {
  if (latency_file_ >= 0) ::close(latency_file_); // the demand ends with the file
}

std::vector<Grant> make_thread_realtime(const RealtimeOptions& options) {
  std::vector<Grant> grants;
  if (!options.affinity.empty()) grants.push_back(pinned(options.affinity));
  if (options.priority > 0) grants.push_back(fifo("policy", options.priority, ::pthread_self()));
  const int error = ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL) == 0 ? 0 : errno;
  grants.push_back(judged("timer_slack", "timer slack of 1 ns", error,
                          "run it where prctl(PR_SET_TIMERSLACK) is not filtered"));
  touch_stack();
  return grants;
}

InheritedPriority::InheritedPriority(unsigned priority) {
  if (priority == 0) return;
  sched_param before{};
  ::pthread_getschedparam(::pthread_self(), &policy_before_, &before);
  priority_before_ = before.sched_priority;
  grant_ = fifo("reader_policy", priority, ::pthread_self());
}

InheritedPriority::~InheritedPriority() {
  if (!grant_ || !grant_->granted) return;
  sched_param before{};
  before.sched_priority = priority_before_;
  ::pthread_setschedparam(::pthread_self(), policy_before_, &before);
}

} // namespace nendo::flow
