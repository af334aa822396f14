// The first byte chooses how the rest, which is the stream, is cut into chunks.

#include "isotrak/isotrak_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::isotrak;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto counters = push_records<Record>(
      {rest_of({data, size}), 1 + *data % 23U, record_bytes}, [] { return Parser(); },
      [](const Record& record) {
        require(record.station == 1 || record.station == 2);
        require_pose(record, 1.67, 1e-12);
      });
  require(counters.bad_records <= counters.records);
  return 0;
}
