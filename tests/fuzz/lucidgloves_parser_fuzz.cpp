// The first byte chooses the range and how the rest is cut into chunks; the rest is the stream.

#include "lucidgloves/lucidgloves_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::lucidgloves;

namespace {

void check_line(const Line& line, std::uint16_t range) {
  require(line.measures() || line.informs());
  nendo::GloveSample sample;
  fill_slots(line, range, sample);
  for (std::size_t slot = 0; slot < nendo::sensor_slots; ++slot) {
    require(sample.raw[slot].value <= range);
    require(sample.raw[slot].value == 0 || (sample.present.bits >> slot & 1U) != 0);
  }
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const unsigned choice = *data;
  const std::uint16_t range = (choice & 0x80U) != 0 ? avr_range : esp32_range;
  const bool takes_first = (choice & 0x40U) != 0;
  Parser parser(range, takes_first ? FirstPiece::take_if_whole : FirstPiece::skip);
  std::uint64_t records = 0;
  push_stream(parser, {rest_of({data, size}), 1 + choice % 7, max_line_bytes}, [&](auto chunk) {
    parser.push(chunk, [&](const Line& line) {
      check_line(line, range);
      if (line.measures()) ++records;
    });
  });
  require(records == parser.counters().records);
  return 0;
}
