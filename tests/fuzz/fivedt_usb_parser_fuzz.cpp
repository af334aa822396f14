// The first byte says how long the reports are that the rest is cut into.

#include "fivedt_usb/fivedt_usb_parser.hpp"

#include <algorithm>
#include <cstdlib>

using namespace nendo::driver::fivedt_usb;

namespace {

void require(bool law) {
  if (!law) std::abort();
}

void check_report(const Report& report) {
  for (const unsigned value : report.values)
    require(value <= most_count);
}

void check_conservation(const Parser& parser, std::uint64_t pushed) {
  const nendo::driver::StreamCounters& counters = parser.counters();
  require(counters.bytes == pushed);
  require(counters.bytes == counters.record_bytes + counters.discarded_bytes);
  require(counters.record_bytes == counters.records * report_bytes);
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t length = 1 + *data % 80;
  Parser parser;
  auto rest = std::as_bytes(std::span(data, size)).subspan(1);
  for (std::uint64_t pushed = 0; !rest.empty();) {
    const auto report = rest.first(std::min(length, rest.size()));
    rest = rest.subspan(report.size());
    if (const auto record = parser.push(report)) check_report(*record);
    check_conservation(parser, pushed += report.size());
  }
  return 0;
}
