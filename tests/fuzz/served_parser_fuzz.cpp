// The first byte chooses how the rest, which is the stream, is cut into chunks, which device is
// wanted, and whether a new connection begins after half of it.

#include "served/served_parser.hpp"

#include <cmath>

#include "parser_fuzz.hpp"

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::driver::served;

namespace {

/// What a parser finds, counted.
struct Findings {
  std::uint64_t records = 0;
  std::uint64_t devices = 0;
  std::uint64_t others = 0;
  std::uint64_t bad = 0;
  bool operator==(const Findings&) const = default;
};

void require_printable(const std::string& text) {
  for (const char c : text)
    require(c >= ' ' && c <= '~');
}

void push_counted(Parser& parser, std::span<const std::byte> chunk, Findings& found) {
  parser.push(chunk, FindingSink{[&](const GloveSample& sample) {
                                   ++found.records;
                                   require((sample.present.bits >> sensor_slots) == 0);
                                   require(sample.measured - sample.arrival <= max_age);
                                 },
                                 [&](const PoseSample& pose) {
                                   ++found.records;
                                   for (const double number : pose.position_m)
                                     require(std::isfinite(number));
                                 },
                                 [&](const GloveLine& line) {
                                   ++found.devices;
                                   require_printable(line.info.model);
                                   require(line.info.rate_hz >= 0.0);
                                   for (const DeviceFact& fact : line.info.facts)
                                     require_printable(fact.name + fact.value);
                                 },
                                 [&](const TrackerLine& line) {
                                   ++found.devices;
                                   require_printable(line.info.source);
                                   require(!line.info.stations.empty());
                                 },
                                 [&](const ErrorLine& line) {
                                   ++found.others;
                                   require_printable(line.message);
                                 },
                                 [&](const VersionLine&) { ++found.others; },
                                 [&](const WatchLine&) { ++found.others; },
                                 [&](BadRecord) { ++found.bad; }});
}

Parser new_parser(bool wants_glove) {
  Parser parser;
  parser.want({wants_glove ? WantedDevice::Kind::glove : WantedDevice::Kind::tracker, 0});
  return parser;
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto stream = rest_of({data, size});
  const std::size_t longest_chunk = 1 + *data % 97U;
  const bool wants_glove = (*data & 1U) == 0;
  const bool connects_again = *data >= 0xC0U;
  Parser parser = new_parser(wants_glove);
  Findings found;
  std::size_t pushed = 0;
  push_stream(parser, {stream, longest_chunk, max_line_bytes}, [&](auto chunk) {
    if (connects_again && pushed <= stream.size() / 2 && pushed + chunk.size() > stream.size() / 2)
      parser.reset();
    pushed += chunk.size();
    push_counted(parser, chunk, found);
    require(parser.counters().records == found.records);
    require(parser.counters().bad_records == found.bad);
  });
  if (connects_again) return 0;

  Parser uncut = new_parser(wants_glove);
  Findings found_uncut;
  push_counted(uncut, stream, found_uncut);
  require(found == found_uncut);
  return 0;
}
