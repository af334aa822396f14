// The first byte chooses how the rest is cut into packets, and how far apart they arrive.

#include "osc/osc_parser.hpp"

#include <chrono>
#include <cmath>

#include "parser_fuzz.hpp"

using namespace nendo::driver::osc;

namespace {

void check_pose(const Pose& pose) {
  const auto& [x, y, z] = pose.position_m;
  const auto& q = pose.turn_xyzw;
  require(std::hypot(x, y, z) <= max_distance_m);
  require(std::abs(std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) - 1.0) < 0.0021);
  require(pose.station == left_station || pose.station == right_station);
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const unsigned choice = *data;
  // A quarter of the inputs are one packet each.
  const std::size_t packet_bytes = choice % 4 == 0 ? 2 * max_packet_bytes : 4 * (8 + choice / 4);
  Parser parser({"/p", "/r", right_station});
  std::uint64_t poses = 0;
  std::chrono::milliseconds now{1};
  push_stream(parser, {rest_of({data, size}), packet_bytes, longest_record}, [&](auto packet) {
    parser.push(packet, nendo::HostTime(now), [&](const Pose& pose) {
      ++poses;
      check_pose(pose);
    });
    now += std::chrono::milliseconds(choice % 8);
  });
  require(poses == parser.counters().records);
  parser.push({}, nendo::HostTime(now + std::chrono::seconds(1)), [](const Pose&) {});
  require(parser.pending() == 0);
  return 0;
}
