// Plain records, with and without a check of their stamps. The first byte chooses the expected
// shape and how the rest is cut into chunks; the rest is the stream.

#include "cyberglove/cyberglove_parser.hpp"

#include "cyberglove/record_check.hpp"
#include "parser_fuzz.hpp"

using namespace nendo::driver::cyberglove;

namespace {

void check_record(const Record& record, const RecordShape& shape) {
  const auto values = std::span(record.values).first(shape.values);
  require(std::none_of(values.begin(), values.end(), [](auto value) { return value == 0; }));
  require(std::all_of(values.begin(), values.end(), [](auto value) { return value <= 255; }));
  require(shape.time_stamp || (record.ticks == 0 && record.stamp == Stamp::none));
  require(shape.status == ((record.status & status_always) != 0));
  require(!record.no_glove);
}

/// Pushes everything; returns the counters.
template <class Judge>
nendo::driver::StreamCounters run(const Stream& stream, const RecordShape& shape, Judge judge) {
  Parser parser(shape);
  std::uint64_t records = 0;
  push_stream(parser, stream, [&](auto chunk) {
    parser.push(chunk, judge, [&](const Record& record) {
      check_record(record, shape);
      ++records;
    });
    const auto& counters = parser.counters();
    require(counters.implausible <= counters.bad_records);
    require(counters.too_fast <= counters.records);
  });
  require(records == parser.counters().records);
  return parser.counters();
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const unsigned choice = *data;
  const RecordShape shape{1 + choice % max_values, (choice & 0x40U) != 0, (choice & 0x80U) != 0};
  const Stream stream{rest_of({data, size}), 1 + choice % 7, max_record_bytes};

  const auto all = run(stream, shape, [](Record&) { return Verdict{}; });
  require(all.implausible == 0 && all.missed == 0);
  const auto checked = run(stream, shape, RecordCheck(choice * 100));
  require(checked.records + checked.implausible == all.records);
  require(checked.unplugged == all.unplugged);
  return 0;
}
