// The first byte says how long the reports are that the rest is cut into.

#include "p5/p5_parser.hpp"

#include <algorithm>
#include <cstdlib>

using namespace nendo::driver::p5;

namespace {

void require(bool law) {
  if (!law) std::abort();
}

void check_report(const Report& report) {
  for (const unsigned bend : report.bends)
    require(bend <= most_bend);
  require(report.light_count <= most_lights);
  for (const SeenLight& light : report.lights) {
    require(light.number < 8);
    for (const int view : {light.v1, light.v2, light.h})
      require(view >= -512 && view <= 511);
  }
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
