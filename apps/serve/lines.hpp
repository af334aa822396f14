#pragma once
// The lines that the server sends, as PROTOCOL.md describes them. All are objects without a line
// end. Invalid UTF-8 becomes U+FFFD, and numbers that are not finite become null.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <nendo/driver/pose_sample.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/frame.hpp>

#include "serve/devices.hpp"
#include "serve/request.hpp"

namespace nendo::serve {

inline constexpr int protocol_number = 1;

std::string version_line(std::string_view name);
std::string glove_line(const ServedGlove& glove, std::size_t index);
std::string tracker_line(const ServedTracker& tracker, std::size_t index);
std::string watch_line(const Watch& watch);
std::string error_line(std::string_view message);

/// Without the count of dropped ones, which with_count() adds.
std::string sample_line(const GloveSample& sample, std::size_t glove);
std::string pose_line(const PoseSample& pose, std::size_t tracker);

/// A frame of the loop without its model.
struct HandsFrame {
  std::uint64_t tick = 0;
  HostTime woke{};
  std::array<flow::HandFrame, 2> hands; ///< index: flow::Placement::index_of(side)
};
/// Without the count of skipped frames.
std::string hands_line(const HandsFrame& frame);

/// Returns the object with one more member, which is its last, and the line end.
std::string with_count(std::string_view object, std::string_view key, std::uint64_t count);

} // namespace nendo::serve
