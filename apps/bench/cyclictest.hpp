#pragma once
// cyclictest of Debian's rt-tests as a neighbour: the measure of wake-ups that everybody knows. It
// is run, if it is installed, and its histogram read.

#include <string>

#include <sys/types.h>

#include <nendo/base/result.hpp>
#include <nendo/flow/histogram.hpp>

namespace nendo::bench {

/// A running cyclictest: one thread, SCHED_FIFO 80, memory locked. It is ended with this.
class Cyclictest {
public:
  /// On that CPU, for so many seconds, every `interval_us`. Error: failed, with the package's name,
  /// if there is none.
  static Result<Cyclictest> start(unsigned cpu, unsigned seconds, unsigned interval_us);
  ~Cyclictest();
  Cyclictest(Cyclictest&& other) noexcept;
  Cyclictest& operator=(Cyclictest&&) = delete;

  /// Waits for its end. Its latencies, in whole microseconds as it counts them. Error: failed.
  Result<flow::Histogram> finish();

private:
  Cyclictest(pid_t child, int file) : child_(child), file_(file) {}

  pid_t child_;
  int file_; ///< where it writes its report: a nameless file
};

/// The histogram in a report that cyclictest wrote with --json. Error: failed.
Result<flow::Histogram> parse_cyclictest(const std::string& json);

} // namespace nendo::bench
