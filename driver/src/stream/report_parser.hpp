#pragma once
// For devices that send whole reports: the bus keeps them apart, so that nothing is framed and
// nothing is held back; a report is a record, or it is dropped and counted.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stream/stream_counters.hpp"

namespace nendo::driver {

/// `decode` is pure and judges one report of any length; nothing if it is no record.
template <class Report, std::optional<Report> (*decode)(std::span<const std::byte>) noexcept>
class ReportParser {
public:
  std::optional<Report> push(std::span<const std::byte> report) noexcept {
    counters_.bytes += report.size();
    const auto record = decode(report);
    ++(record ? counters_.records : counters_.bad_records);
    (record ? counters_.record_bytes : counters_.discarded_bytes) += report.size();
    return record;
  }
  /// Counts bytes that were read while nobody wanted records.
  void count_discarded(std::uint64_t bytes) noexcept { counters_.count_discarded(bytes); }
  const StreamCounters& counters() const noexcept { return counters_; }

private:
  StreamCounters counters_;
};

} // namespace nendo::driver
