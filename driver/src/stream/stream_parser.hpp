#pragma once
// What parsers share: the findings besides records, and bases. push() passes each finding to its
// sink in the order of the stream, if the sink takes findings of this kind.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include <nendo/driver/glove.hpp>

namespace nendo::driver {

/// A frame that was no good record, or one that a check refused.
struct BadRecord {};

/// A whole record that says that no glove is plugged in.
struct Unplugged {};

/// Calls `sink(finding)` if the sink takes findings of this kind.
template <class Sink, class Finding>
void report(Sink& sink, const Finding& finding) {
  if constexpr (std::is_invocable_v<Sink&, const Finding&>) sink(finding);
}

/// Makes one sink of several functions, one per kind of finding.
template <class... Functions>
struct FindingSink : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
FindingSink(Functions...) -> FindingSink<Functions...>;

/// The base of a parser, which defines push_byte(std::byte). That takes the next byte of the stream
/// and returns the record that it completes, as an optional.
template <class Parser>
class StreamParser {
public:
  /// Takes the next bytes of the stream, cut anywhere, and passes each record to `sink(record)`.
  /// A damaged record counts as bad once.
  template <class Sink>
  void push(std::span<const std::byte> chunk, Sink&& sink) {
    for (const std::byte byte : chunk) {
      ++counters_.bytes;
      const auto record = static_cast<Parser&>(*this).push_byte(byte);
      report_bad(sink);
      if (record) sink(*record);
    }
  }
  /// See StreamCounters::count_discarded.
  void count_discarded(std::uint64_t bytes) noexcept { counters_.count_discarded(bytes); }

  const StreamCounters& counters() const noexcept { return counters_; }
  /// Returns the bytes of the unfinished record, always less than a longest record.
  std::size_t pending() const noexcept { return held_; }

protected:
  ~StreamParser() = default;

  void count_bad() noexcept { ++counters_.bad_records, ++bad_; }
  template <class Sink>
  void report_bad(Sink& sink) {
    for (; bad_ > 0; --bad_)
      report(sink, BadRecord{});
  }
  void accept_held() noexcept {
    ++counters_.records;
    counters_.record_bytes += std::exchange(held_, 0);
  }
  void discard_held() noexcept { counters_.discarded_bytes += std::exchange(held_, 0); }

  std::size_t held_ = 0; ///< bytes of the unfinished record
  StreamCounters counters_;

private:
  unsigned bad_ = 0; ///< bad records found by the last byte, not yet reported
};

/// A parser for devices that send whole reports, which the bus separates: a report is a record, or
/// it is dropped and counted. `decode` is pure, takes one report of any length, and returns nothing
/// if it is no record.
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
