#pragma once
// Runs cyclictest of Debian's rt-tests, the usual measure of wake-ups, if it is installed, and
// reads its histogram.

#include <string>

#include <sys/types.h>

#include <nendo/base/result.hpp>
#include <nendo/flow/histogram.hpp>

namespace nendo::bench {

/// A running cyclictest with one thread, SCHED_FIFO 80 and locked memory. The destructor ends it.
class Cyclictest {
public:
  /// Starts it on that CPU, for this number of seconds, with a wake-up every `interval_us`. Error:
  /// failed, with the package's name, if it is not installed.
  static Result<Cyclictest> start(unsigned cpu, unsigned seconds, unsigned interval_us);
  ~Cyclictest();
  Cyclictest(Cyclictest&& other) noexcept;
  Cyclictest& operator=(Cyclictest&&) = delete;

  /// Waits for its end. Returns its latencies, in whole microseconds as it counts them. Error:
  /// failed.
  Result<flow::Histogram> finish();

private:
  Cyclictest(pid_t child, int file) : child_(child), file_(file) {}

  pid_t child_;
  int file_; ///< where it writes its report: a nameless file
};

/// Returns the histogram in a report that cyclictest wrote with --json. Error: failed.
Result<flow::Histogram> parse_cyclictest(const std::string& json);

} // namespace nendo::bench
