// The first byte chooses how the rest, which is the stream, is cut into chunks, and whether records
// have their distortion.

#include "liberty/liberty_parser.hpp"

#include "polhemus/pose_floats.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver;
using namespace nendo::driver::liberty;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t record_bytes = *data % 2U == 0 ? full_bytes : short_bytes;
  const auto make = [&] {
    Parser parser;
    parser.reset(record_bytes);
    return parser;
  };
  const auto check = [](const Record& record) {
    require(record.station >= 1 && record.station <= max_stations);
    require_pose(record, polhemus::max_coordinate_cm / 100.0, polhemus::max_norm_error);
  };
  push_records<Record>({rest_of({data, size}), 1 + *data % 7U, record_bytes}, make, check);
  return 0;
}
