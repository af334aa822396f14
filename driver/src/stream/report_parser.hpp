#pragma once
// A parser for devices that send whole reports. The bus separates reports, so there is no framing
// and nothing is held back. A report is a record, or it is dropped and counted.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stream/stream_counters.hpp"

namespace nendo::driver {

/// `decode` is pure, takes one report of any length, and returns nothing if it is no record.
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
  /// Returns whether the report is a record.
  static bool decodes(std::span<const std::byte> report) noexcept {
    return decode(report).has_value();
  }
  /// Counts bytes that were read before the stream.
  void count_discarded(std::uint64_t bytes) noexcept { counters_.count_discarded(bytes); }
  /// Counts values of the last record outside their range.
  void count_clamped(int values) noexcept {
    counters_.clamped += static_cast<std::uint64_t>(values);
  }
  const StreamCounters& counters() const noexcept { return counters_; }

private:
  StreamCounters counters_;
};

} // namespace nendo::driver
