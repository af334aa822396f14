// The first byte chooses how the rest, which is the stream, is cut into chunks, and whether a new
// connection begins after half of it.

#include "vrpn/vrpn_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver;
using namespace nendo::driver::vrpn;

namespace {

/// What a parser finds, counted.
struct Findings {
  std::uint64_t poses = 0;
  std::uint64_t others = 0;
  std::uint64_t names = 0;
  std::uint64_t strings = 0;
  std::uint64_t bad = 0;
  bool operator==(const Findings&) const = default;
};

void push_counted(Parser& parser, std::span<const std::byte> chunk, Findings& found) {
  parser.push(chunk, FindingSink{[&](const Pose& pose) {
                                   ++found.poses;
                                   require(pose.sensor == 0 || pose.sensor == 3);
                                   require(parser.knows_tracker());
                                 },
                                 [&](const OtherPose&) { ++found.others; },
                                 [&](const SenderName& sender) {
                                   ++found.names;
                                   require(sender.name.size() <= max_name_bytes);
                                   require(sender.name.find('\0') == std::string_view::npos);
                                 },
                                 [&](const Text& text) {
                                   ++found.strings;
                                   require(text.text.size() <= max_text_bytes);
                                 },
                                 [&](BadRecord) { ++found.bad; }});
}

Parser new_parser() {
  Parser parser("Tracker0", {0, 3});
  parser.deliver_poses(true);
  return parser;
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto stream = rest_of({data, size});
  const std::size_t longest_chunk = 1 + *data % 97U;
  const bool connects_again = *data >= 0xC0U;
  Parser parser = new_parser();
  Findings found;
  std::size_t pushed = 0;
  push_stream(parser, {stream, longest_chunk, max_held_bytes}, [&](auto chunk) {
    if (connects_again && pushed <= stream.size() / 2 && pushed + chunk.size() > stream.size() / 2)
      parser.reset();
    pushed += chunk.size();
    push_counted(parser, chunk, found);
    require(parser.counters().records == found.poses);
    require(parser.counters().record_bytes == found.poses * (header_bytes + pose_payload_bytes));
    require(parser.counters().bad_records == found.bad);
  });
  if (connects_again) return 0;

  Parser uncut = new_parser();
  Findings found_uncut;
  push_counted(uncut, stream, found_uncut);
  require(found == found_uncut);
  require(uncut.is_broken() == parser.is_broken());
  return 0;
}
