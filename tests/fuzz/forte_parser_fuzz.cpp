// The first byte chooses how the rest, which is the stream, is cut into chunks.

#include "forte/forte_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::forte;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  push_records<Record>(
      {rest_of({data, size}), 1 + *data % 7U, record_bytes}, [] { return Parser(); },
      [](const Record& record) {
        require(std::all_of(record.flexion.begin(), record.flexion.end(),
                            [](std::uint8_t count) { return count <= max_count; }));
      });
  return 0;
}
