#pragma once
// What a thread needs of the system to be on time, asked for, and what the system said. Nothing
// that is refused is fatal, and nothing is refused in silence.

#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::flow {

struct RealtimeOptions {
  /// SCHED_FIFO, 1 to 97; 0: the ordinary scheduler. The readers of gloves run two above, so that a
  /// sample that has arrived is in the ring before the loop drains it.
  unsigned priority = 0;
  std::vector<unsigned> affinity; ///< the CPUs that the thread may use; empty: all
  bool lock_memory = false;       ///< no page of the process is ever fetched again
};
inline constexpr unsigned usual_priority = 80;
inline constexpr unsigned most_priority = 97;
constexpr unsigned reader_priority(unsigned of_loop) noexcept {
  return of_loop == 0 ? 0 : of_loop + 2;
}

/// "2", "0,2", "0-3": CPUs of this machine. Error: usage, naming `option`.
Result<std::vector<unsigned>> parse_cpus(const std::string& text, const std::string& option);

/// One right that was asked for.
struct Grant {
  std::string name;   ///< stable: "policy", "affinity", "memory_lock", "dma_latency", "timer_slack"
  std::string wanted; ///< "SCHED_FIFO 80"
  bool granted = false;
  std::string why;    ///< the system's words; empty if granted
  std::string remedy; ///< the command or deed that mends it; empty if granted
};
/// The refused ones, a line each: what, why, and the remedy.
std::vector<std::string> refusals(const std::vector<Grant>& grants);

/// What holds for the process while this lives: memory locked and kept by malloc, and the processor
/// kept from sleep states that take long to leave (/dev/cpu_dma_latency, if a priority is asked
/// for). Locked memory stays locked until the process ends. Blocks while pages come in.
class RealtimeProcess {
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

/// For the calling thread: affinity, scheduler, timer slack (the ordinary scheduler may else delay
/// a wake-up by 50 microseconds), and 256 KiB of its stack touched.
std::vector<Grant> make_thread_realtime(const RealtimeOptions& options);

/// While it lives, threads that the calling one starts run at this priority (SCHED_FIFO; 0: nothing
/// changes), as does the calling one.
class InheritedPriority {
public:
  explicit InheritedPriority(unsigned priority);
  ~InheritedPriority();
  InheritedPriority(const InheritedPriority&) = delete;
  InheritedPriority& operator=(const InheritedPriority&) = delete;

  /// Nothing, if nothing was asked for.
  const std::optional<Grant>& grant() const noexcept { return grant_; }

private:
  int policy_before_ = 0;
  int priority_before_ = 0;
  std::optional<Grant> grant_;
};

} // namespace nendo::flow
