#pragma once
// Decodes the lines of `nendo serve`, see served_protocol.hpp. Pure, but it allocates, in
// proportion to the line. Bytes are not trusted. It throws nothing but std::bad_alloc.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <nendo/base/side.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/pose_sample.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/driver/tracker.hpp>

namespace nendo::driver::served {

struct VersionLine {
  std::int64_t protocol = 0;
  std::string version; ///< Nendo's, printable
};

/// A glove as the server has it. Its `source` is the server's. It has no light, vibration and
/// resistance, because the socket carries no feedback.
struct GloveLine {
  std::uint32_t index = 0;
  Side side = Side::right; ///< the hand that it moves
  GloveInfo info;
};

/// The station of a tracker that moves a hand, as the server has it.
struct TrackerLine {
  std::uint32_t index = 0;
  Side side = Side::right;
  std::uint16_t station = 0;
  TrackerInfo info; ///< `stations` has all that the server uses
};

/// The server's answer to a request.
struct WatchLine {
  bool samples = false; ///< samples and poses follow
};

struct ErrorLine {
  std::string message; ///< printable
};

/// A sample as the server has it, with the server's times and number.
struct SampleLine {
  std::uint32_t glove = 0;
  GloveSample sample;
  std::uint64_t dropped = 0; ///< samples before this one that the server did not send
};

struct PoseLine {
  std::uint32_t tracker = 0;
  PoseSample pose;
  std::uint64_t dropped = 0;
};

/// A line of a class that is not needed.
struct OtherLine {};

using Line = std::variant<OtherLine, VersionLine, GloveLine, TrackerLine, WatchLine, ErrorLine,
                          SampleLine, PoseLine>;

/// Decodes a line without its end. Returns nothing if it is no JSON object with a class, lacks a
/// key, or has a value of a wrong type or out of range. Keys, classes and sensors that are not
/// known are ignored.
std::optional<Line> decode_line(std::string_view text);

} // namespace nendo::driver::served
