// The first byte chooses how the rest, which is the stream, is cut into chunks, and the stations
// that are taken.

#include "fastrak/fastrak_parser.hpp"

#include <array>

#include "polhemus/pose_floats.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver;
using namespace nendo::driver::fastrak;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool takes_all = *data % 2U == 0;
  const auto make = [&] {
    constexpr std::array<std::uint16_t, 2> stations{1, 2};
    Parser parser;
    if (!takes_all) parser.expect(stations);
    return parser;
  };
  const auto check = [&](const Record& record) {
    require(record.station >= 1 && record.station <= (takes_all ? max_stations : 2));
    require_pose(record, polhemus::max_coordinate_cm / 100.0, polhemus::max_norm_error);
  };
  push_records<Record>({rest_of({data, size}), 1 + *data % 7U, record_bytes}, make, check);
  return 0;
}
