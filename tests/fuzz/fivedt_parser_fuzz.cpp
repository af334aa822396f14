// The first byte chooses how the rest is cut into chunks; the rest is the stream, and the answer to
// a question.

#include "fivedt/fivedt_parser.hpp"

#include <algorithm>
#include <cstdlib>

#include "fivedt/fivedt_information.hpp"

using namespace nendo::driver::fivedt;

namespace {

void require(bool law) {
  if (!law) std::abort();
}

void check_conservation(const Parser& parser, std::uint64_t pushed) {
  const nendo::driver::StreamCounters& counters = parser.counters();
  require(counters.bytes == pushed);
  require(counters.bytes == counters.record_bytes + counters.discarded_bytes + parser.pending());
  require(counters.record_bytes == counters.records * sample_bytes);
  require(parser.pending() < sample_bytes);
}

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
  auto rest = std::as_bytes(std::span(data, size)).subspan(1);
  const std::size_t longest_chunk = 1 + *data % 7;
  for (std::uint64_t pushed = 0; !rest.empty();) {
    const auto chunk = rest.first(std::min(longest_chunk, rest.size()));
    rest = rest.subspan(chunk.size());
    parser.push(chunk, [&](const Record&) { ++records; });
    check_conservation(parser, pushed += chunk.size());
    if (finder.push(chunk)) check_information(finder);
  }
  require(records == parser.counters().records);
  return 0;
}
