// The first byte chooses how the rest is cut into chunks; the rest is the stream, and the answer to
// a question.

#include "fivedt/fivedt_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::fivedt;

namespace {

void check_information(const InformationFinder& finder) {
  const auto information = decode_information(finder.answer());
  require(information.has_value());
  require(std::all_of(information->name.begin(), information->name.end(),
                      [](char c) { return c >= 0x20 && c < 0x7F; }));
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  Parser parser;
  InformationFinder finder;
  std::uint64_t records = 0;
  push_stream(parser, {rest_of({data, size}), 1 + *data % 7U, sample_bytes}, [&](auto chunk) {
    parser.push(chunk, [&](const Record&) { ++records; });
    require(parser.counters().records == records);
    require(parser.counters().record_bytes == records * sample_bytes);
    if (finder.push(chunk)) check_information(finder);
  });
  return 0;
}
