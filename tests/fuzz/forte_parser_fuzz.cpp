// The first byte chooses how the rest, which is the stream, is cut into chunks.

#include "forte/forte_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::forte;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto stream = rest_of({data, size});
  Parser parser;
  std::uint64_t records = 0;
  const auto sink = [&](const Record& record) {
    ++records;
    require(std::all_of(record.flexion.begin(), record.flexion.end(),
                        [](std::uint8_t count) { return count <= max_count; }));
  };
  push_stream(parser, {stream, 1 + *data % 7U, record_bytes}, [&](auto chunk) {
    parser.push(chunk, sink);
    require(parser.counters().records == records);
    require(parser.counters().record_bytes == records * record_bytes);
  });

  Parser uncut;
  uncut.push(stream, [](const Record&) {});
  require(uncut.counters().records == records);
  require(uncut.counters().bad_records == parser.counters().bad_records);
  return 0;
}
