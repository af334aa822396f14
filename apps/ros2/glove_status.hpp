#pragma once
// The contents of /diagnostics: whether a run continues, and whether gloves and trackers deliver.

#include <array>
#include <cstdint>
#include <string>

#include "ros/messages.hpp"
#include "ros2/segment_reader.hpp"

namespace nendo::ros2 {

/// Makes messages with three statuses: of the run, of the left glove, and of the right one. One
/// thread at a time.
class GloveStatus {
public:
  /// segment: the NAME of shm:NAME.
  explicit GloveStatus(std::string segment) : segment_(std::move(segment)) {}

  /// Of a run whose newest record this is. The times are of CLOCK_MONOTONIC and in UTC.
  void of_run(const HandsRecord& newest, std::int64_t now_ns, std::int64_t utc_ns,
              ros::DiagnosticArray& out);
  /// Of no run.
  void of_no_run(std::int64_t utc_ns, ros::DiagnosticArray& out);

private:
  /// Numbers that grow, for rates between two messages.
  struct Counts {
    std::int64_t now_ns = 0;
    std::uint64_t ticks = 0;
    std::array<std::uint64_t, 2> samples{};
  };

  void begin(std::int64_t utc_ns, ros::DiagnosticArray& out) const;

  std::string segment_;
  Counts before_;
};

} // namespace nendo::ros2
