// The first byte chooses the expected shape and how the rest is cut into chunks; the rest is the
// stream.

#include "cyberglove/cyberglove_parser.hpp"

#include <algorithm>
#include <cstdlib>

using namespace nendo::driver::cyberglove;

namespace {

void require(bool law) {
  if (!law) std::abort();
}

void check_record(const Record& record, const RecordShape& shape) {
  const auto values = std::span(record.values).first(shape.values);
  require(std::none_of(values.begin(), values.end(), [](auto value) { return value == 0; }));
  require(shape.time_stamp || record.ticks == 0);
}

void check_conservation(const Parser& parser, std::uint64_t pushed) {
  const nendo::driver::StreamCounters& counters = parser.counters();
  require(counters.bytes == pushed);
  require(counters.bytes == counters.record_bytes + counters.discarded_bytes + parser.pending());
  require(parser.pending() < most_record_bytes);
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const unsigned choice = *data;
  const RecordShape shape{1 + choice % most_values, (choice & 0x40U) != 0, (choice & 0x80U) != 0};
  Parser parser(shape);
  std::uint64_t records = 0;
  auto rest = std::as_bytes(std::span(data, size)).subspan(1);
  const std::size_t longest_chunk = 1 + choice % 7;
  for (std::uint64_t pushed = 0; !rest.empty();) {
    const auto chunk = rest.first(std::min(longest_chunk, rest.size()));
    rest = rest.subspan(chunk.size());
    parser.push(chunk, [&](const Record& record) {
      check_record(record, shape);
      ++records;
    });
    check_conservation(parser, pushed += chunk.size());
  }
  require(records == parser.counters().records);
  return 0;
}
