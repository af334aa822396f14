// The first byte chooses how the rest, which is the stream, is cut into chunks, and whether records
// have their distortion.

#include "liberty/liberty_parser.hpp"

#include <cmath>

#include "polhemus/pose_floats.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver;
using namespace nendo::driver::liberty;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto stream = rest_of({data, size});
  const std::size_t record_bytes = *data % 2U == 0 ? full_bytes : short_bytes;
  Parser parser;
  parser.reset(record_bytes);
  std::uint64_t records = 0;
  const auto sink = [&](const Record& record) {
    ++records;
    require(record.station >= 1 && record.station <= max_stations);
    double squares = 0.0;
    for (const double component : record.turn_xyzw)
      squares += component * component;
    require(std::abs(std::sqrt(squares) - 1.0) <= polhemus::max_norm_error);
    for (const double coordinate_m : record.position_m)
      require(std::abs(coordinate_m) <= polhemus::max_coordinate_cm / 100.0);
  };
  push_stream(parser, {stream, 1 + *data % 7U, record_bytes}, [&](auto chunk) {
    parser.push(chunk, sink);
    require(parser.counters().records == records);
    require(parser.counters().record_bytes == records * record_bytes);
  });

  Parser uncut;
  uncut.reset(record_bytes);
  uncut.push(stream, [](const Record&) {});
  require(uncut.counters().records == records);
  require(uncut.counters().bad_records == parser.counters().bad_records);
  return 0;
}
