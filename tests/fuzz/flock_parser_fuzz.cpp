// The first byte chooses how the rest, which is the stream, is cut into chunks.

#include "flock/flock_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::flock;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto counters = push_records<Record>(
      {rest_of({data, size}), 1 + *data % 23U, record_bytes}, [] { return Parser(); },
      [](const Record& record) {
        require(record.station >= 1 && record.station <= 14);
        double square = 0.0;
        for (const std::int16_t part : record.quaternion)
          square += part / 32768.0 * (part / 32768.0);
        require(std::abs(std::sqrt(square) - 1.0) < 0.003);
      });
  require(counters.bad_records <= counters.records);
  return 0;
}
