// The first byte chooses the range and how the rest is cut into chunks; the rest is the stream.

#include "lucidgloves/lucidgloves_parser.hpp"

#include <algorithm>
#include <cstdlib>

#include "lucidgloves/lucidgloves_slots.hpp"

using namespace nendo::driver::lucidgloves;

namespace {

void require(bool law) {
  if (!law) std::abort();
}

void check_line(const Line& line, std::uint16_t range) {
  require(line.measures() || line.informs());
  nendo::GloveSample sample;
  fill_slots(line, range, sample);
  for (std::size_t slot = 0; slot < nendo::sensor_slots; ++slot) {
    require(sample.raw[slot].value <= range);
    require(sample.raw[slot].value == 0 || (sample.present.bits >> slot & 1U) != 0);
  }
}

void check_conservation(const Parser& parser, std::uint64_t pushed) {
  const nendo::driver::StreamCounters& counters = parser.counters();
  require(counters.bytes == pushed);
  require(counters.bytes == counters.record_bytes + counters.discarded_bytes + parser.pending());
  require(parser.pending() < most_line_bytes);
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const unsigned choice = *data;
  const std::uint16_t range = (choice & 0x80U) != 0 ? avr_range : esp32_range;
  Parser parser(range);
  std::uint64_t records = 0;
  auto rest = std::as_bytes(std::span(data, size)).subspan(1);
  const std::size_t longest_chunk = 1 + choice % 7;
  for (std::uint64_t pushed = 0; !rest.empty();) {
    const auto chunk = rest.first(std::min(longest_chunk, rest.size()));
    rest = rest.subspan(chunk.size());
    parser.push(chunk, [&](const Line& line) {
      check_line(line, range);
      if (line.measures()) ++records;
    });
    check_conservation(parser, pushed += chunk.size());
  }
  require(records == parser.counters().records);
  return 0;
}
