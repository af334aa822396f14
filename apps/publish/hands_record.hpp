#pragma once
// One tick of a run, as far as outlets for hands need it, and how often they send it.

#include <cstdint>
#include <optional>

#include <nendo_publish.h>

namespace nendo::publish {

struct HandsRecord {
  nendo_publish_record record{};
  nendo_publish_states states{}; ///< zeros if the run is older than version 1.2
};

/// Lets at most one record per period pass.
class Pace {
public:
  /// max_rate_hz: nothing lets every record pass.
  explicit Pace(std::optional<double> max_rate_hz)
      : period_ns_(max_rate_hz ? static_cast<std::int64_t>(1e9 / *max_rate_hz) : 0) {}
  bool is_due(std::int64_t time_ns) noexcept {
    if (period_ns_ == 0) return true;
    if (time_ns < due_ns_) return false;
    due_ns_ += period_ns_; // keeps the rate, but catches up nothing
    if (due_ns_ <= time_ns) due_ns_ = time_ns + period_ns_;
    return true;
  }

private:
  std::int64_t period_ns_;
  std::int64_t due_ns_ = 0;
};

} // namespace nendo::publish
