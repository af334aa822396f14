// The first byte chooses how the rest, which is the stream, is cut into chunks.

#include "isotrak/isotrak_parser.hpp"

#include <cmath>

#include "parser_fuzz.hpp"

using namespace nendo::driver::isotrak;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto stream = rest_of({data, size});
  Parser parser;
  std::uint64_t records = 0;
  const auto sink = [&](const Record& record) {
    ++records;
    require(record.station == 1 || record.station == 2);
    double squares = 0.0;
    for (const double component : record.turn_xyzw)
      squares += component * component;
    require(std::abs(std::sqrt(squares) - 1.0) < 1e-12);
    for (const double coordinate_m : record.position_m)
      require(std::abs(coordinate_m) < 1.67);
  };
  push_stream(parser, {stream, 1 + *data % 23U, record_bytes}, [&](auto chunk) {
    parser.push(chunk, sink);
    require(parser.counters().records == records);
    require(parser.counters().record_bytes == records * record_bytes);
    require(parser.counters().bad_records <= parser.counters().records);
  });

  Parser uncut;
  uncut.push(stream, [](const Record&) {});
  require(uncut.counters().records == records);
  require(uncut.counters().bad_records == parser.counters().bad_records);
  return 0;
}
