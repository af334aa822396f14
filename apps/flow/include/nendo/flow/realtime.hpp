#pragma once
// Requests real-time rights from the system, and reports which were granted. A refusal is not
// fatal, and is always reported.

#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::flow {

struct RealtimeOptions {
  /// The priority under SCHED_FIFO, 1 to 97, or 0 for the ordinary scheduler. The glove readers'
  /// priority is higher by two, so that an arrived sample is in the ring before the loop drains it.
  unsigned priority = 0;
  std::vector<unsigned> affinity; ///< the CPUs that the thread may use; empty: all
  bool lock_memory = false;       ///< locks all pages of the process in memory
};
inline constexpr unsigned usual_priority = 80;
inline constexpr unsigned max_priority = 97;
constexpr unsigned reader_priority(unsigned of_loop) noexcept {
  return of_loop == 0 ? 0 : of_loop + 2;
}

/// Parses CPUs of this machine, such as "2", "0,2" or "0-3". Error: usage, naming `option`.
NENDO_API Result<std::vector<unsigned>> parse_cpus(const std::string& text,
                                                   const std::string& option);

/// The result of requesting a right.
struct Grant {
  std::string name;   ///< stable: "policy", "affinity", "memory_lock", "dma_latency", "timer_slack"
  std::string wanted; ///< "SCHED_FIFO 80"
  bool granted = false;
  std::string why;    ///< the system's message; empty if granted
  std::string remedy; ///< a command or action that helps; empty if granted
};
/// Returns a line for each refused right: what was refused, why, and the remedy.
NENDO_API std::vector<std::string> refusals(const std::vector<Grant>& grants);

/// Holds process-wide rights during its lifetime. Locks memory, which malloc then does not return,
/// until the process ends. With a priority, disables deep processor sleep states
/// (/dev/cpu_dma_latency). The constructor blocks while pages are loaded.
class NENDO_API RealtimeProcess {
public:
  explicit RealtimeProcess(const RealtimeOptions& options);
  ~RealtimeProcess();
  RealtimeProcess(const RealtimeProcess&) = delete;
  RealtimeProcess& operator=(const RealtimeProcess&) = delete;

  const std::vector<Grant>& grants() const noexcept { return grants_; }

private:
  int latency_file_ = -1;
  std::vector<Grant> grants_;
};

/// Sets the calling thread's affinity, scheduler and timer slack, and prefaults 256 KiB of its
/// stack. With the default slack, the ordinary scheduler may delay a wake-up by 50 microseconds.
NENDO_API std::vector<Grant> make_thread_realtime(const RealtimeOptions& options);

/// During its lifetime, the calling thread and threads that it starts have this priority under
/// SCHED_FIFO. 0: no change.
class NENDO_API InheritedPriority {
public:
  explicit InheritedPriority(unsigned priority);
  ~InheritedPriority();
  InheritedPriority(const InheritedPriority&) = delete;
  InheritedPriority& operator=(const InheritedPriority&) = delete;

  /// Returns nothing if nothing was requested.
  const std::optional<Grant>& grant() const noexcept { return grant_; }

private:
  int policy_before_ = 0;
  int priority_before_ = 0;
  std::optional<Grant> grant_;
};

} // namespace nendo::flow
