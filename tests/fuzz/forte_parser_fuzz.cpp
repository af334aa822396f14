// The first byte chooses how the rest, which is the stream, is cut into chunks.

#include "forte/forte_parser.hpp"

#include <algorithm>
#include <cstdlib>

using namespace nendo::driver::forte;

namespace {

void require(bool law) {
  if (!law) std::abort();
}

void check_conservation(const Parser& parser, std::uint64_t pushed) {
  const nendo::driver::StreamCounters& counters = parser.counters();
  require(counters.bytes == pushed);
  require(counters.bytes == counters.record_bytes + counters.discarded_bytes + parser.pending());
  require(counters.record_bytes == counters.records * record_bytes);
  require(parser.pending() < record_bytes);
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto stream = std::as_bytes(std::span(data, size)).subspan(1);
  const std::size_t longest_chunk = 1 + *data % 7;
  Parser parser;
  std::uint64_t records = 0;
  const auto sink = [&](const Record& record) {
    ++records;
    require(std::all_of(record.flexion.begin(), record.flexion.end(),
                        [](std::uint8_t count) { return count <= most_count; }));
  };
  std::uint64_t pushed = 0;
  for (auto rest = stream; !rest.empty();) {
    const auto chunk = rest.first(std::min(longest_chunk, rest.size()));
    rest = rest.subspan(chunk.size());
    parser.push(chunk, sink);
    check_conservation(parser, pushed += chunk.size());
  }
  require(records == parser.counters().records);

  Parser uncut;
  uncut.push(stream, [](const Record&) {});
  require(uncut.counters().records == records);
  require(uncut.counters().bad_records == parser.counters().bad_records);
  return 0;
}
