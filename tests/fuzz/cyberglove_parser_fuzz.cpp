// Plain records, with and without a check of their stamps. The first byte chooses the expected
// shape and how the rest is cut into chunks; the rest is the stream.

#include "cyberglove/cyberglove_parser.hpp"

#include <algorithm>
#include <cstdlib>

#include "cyberglove/record_check.hpp"

using namespace nendo::driver::cyberglove;

namespace {

void require(bool law) {
  if (!law) std::abort();
}

void check_record(const Record& record, const RecordShape& shape) {
  const auto values = std::span(record.values).first(shape.values);
  require(std::none_of(values.begin(), values.end(), [](auto value) { return value == 0; }));
  require(std::all_of(values.begin(), values.end(), [](auto value) { return value <= 255; }));
  require(shape.time_stamp || (record.ticks == 0 && record.stamp == Stamp::none));
  require(shape.status == ((record.status & status_always) != 0));
  require(!record.no_glove);
}

void check_conservation(const Parser& parser, std::uint64_t pushed) {
  const nendo::driver::StreamCounters& counters = parser.counters();
  require(counters.bytes == pushed);
  require(counters.bytes == counters.record_bytes + counters.discarded_bytes + parser.pending());
  require(parser.pending() < most_record_bytes);
  require(counters.implausible <= counters.bad_records);
  require(counters.too_fast <= counters.records);
}

/// Pushes everything in chunks of `longest_chunk`; returns the counters.
template <class Judge>
nendo::driver::StreamCounters run(std::span<const std::byte> rest, const RecordShape& shape,
                                  std::size_t longest_chunk, Judge judge) {
  Parser parser(shape);
  std::uint64_t records = 0;
  for (std::uint64_t pushed = 0; !rest.empty();) {
    const auto chunk = rest.first(std::min(longest_chunk, rest.size()));
    rest = rest.subspan(chunk.size());
    parser.push(chunk, judge, [&](const Record& record) {
      check_record(record, shape);
      ++records;
    });
    check_conservation(parser, pushed += chunk.size());
  }
  require(records == parser.counters().records);
  return parser.counters();
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const unsigned choice = *data;
  const RecordShape shape{1 + choice % most_values, (choice & 0x40U) != 0, (choice & 0x80U) != 0};
  const auto stream = std::as_bytes(std::span(data, size)).subspan(1);
  const std::size_t longest_chunk = 1 + choice % 7;

  const auto all = run(stream, shape, longest_chunk, [](Record&) { return Verdict{}; });
  require(all.implausible == 0 && all.missed == 0);
  const auto checked = run(stream, shape, longest_chunk, RecordCheck(choice * 100));
  require(checked.records + checked.implausible == all.records);
  require(checked.unplugged == all.unplugged);
  return 0;
}
