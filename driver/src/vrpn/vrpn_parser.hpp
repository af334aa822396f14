#pragma once
// Splits the byte stream of a VRPN server into messages, and decodes those of one tracker. It is
// pure (no I/O, clock, log or allocation after its construction), and bytes are not trusted. The
// stream has no marks to find a message by: after a wrong length nothing can be read any more.

#include <array>
#include <bitset>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nendo/driver/vrpn_protocol.hpp>

#include "stream/stream_parser.hpp"

namespace nendo::driver::vrpn {

/// A record: the pose of a wanted sensor, as it was sent. Its numbers may be infinite or NaN.
struct Pose {
  std::uint16_t sensor = 0;
  std::array<double, 3> position_m{};
  std::array<double, 4> turn_xyzw{};
  /// The server's wall clock; nothing if the message has none (0), or no valid one.
  std::optional<std::chrono::nanoseconds> stamp;
};

// Findings besides poses. Their views are valid during the call only.

struct Greeting {
  std::string_view text; ///< 16 bytes, which may be anything
  bool is_vrpn_7 = false;
};
/// The server has a sender of this name.
struct SenderName {
  std::string_view name;
};
/// The tracker sent a pose of a sensor that is not wanted, or while poses are not.
struct OtherPose {
  std::int32_t sensor = 0;
};
/// The tracker answered a ping.
struct Pong {};
/// The tracker says something for people to read.
struct Text {
  std::uint32_t severity = 0;
  std::string_view text;
};

/// The longest message that is decoded, and so held; all others are skipped as they come.
inline constexpr std::size_t max_held_bytes = header_bytes + 8 + max_text_bytes;

/// Messages of other senders and types are skipped: they are discarded, and not bad.
class Parser : public StreamParser<Parser> {
public:
  /// `tracker` is the sender's name.
  Parser(std::string tracker, std::vector<std::uint16_t> sensors);

  /// Takes the next bytes of the stream, cut anywhere, and passes each Pose, and the findings that
  /// the sink takes, to `sink(finding)` in the order of the stream.
  template <class Sink>
  void push(std::span<const std::byte> chunk, Sink&& sink) {
    for (const std::byte byte : chunk) {
      ++counters_.bytes;
      const Finding finding = push_byte(byte);
      report_bad(sink);
      std::visit([&](const auto& found) { report(sink, found); }, finding);
    }
  }

  /// Chooses whether poses of wanted sensors are records, or findings as those of others. At first
  /// they are not.
  void deliver_poses(bool deliver) noexcept { delivers_ = deliver; }
  /// Drops all, for a new connection, which begins with a cookie.
  void reset() noexcept;
  /// Returns true once the server has described the tracker.
  bool knows_tracker() const noexcept { return is_tracker_.any(); }
  /// Returns true if the stream cannot be read any more: it is no VRPN 7, or a length was wrong.
  bool is_broken() const noexcept { return state_ == State::broken; }

private:
  friend StreamParser;

  enum class State : std::uint8_t { in_cookie, in_header, in_payload, skipping, broken };
  enum class Kind : std::uint8_t { other, sender_name, type_name, pose, text, pong };
  using Finding = std::variant<std::monostate, Pose, Greeting, SenderName, OtherPose, Pong, Text>;

  struct Header {
    std::uint32_t seconds = 0;
    std::uint32_t microseconds = 0;
    std::int32_t sender = 0;
    Kind kind = Kind::other;
    std::size_t payload_bytes = 0;
  };

  Finding push_byte(std::byte byte) noexcept;
  Finding end_cookie() noexcept;
  Finding end_header() noexcept;
  Finding end_message() noexcept;
  Finding take_name(std::span<const std::byte> payload) noexcept;
  Finding take_pose(std::span<const std::byte> payload) noexcept;
  Finding take_text(std::span<const std::byte> payload) noexcept;
  Kind kind_of(std::int32_t sender, std::int32_t type) const noexcept;
  void expect(State state, std::size_t bytes) noexcept;
  void break_off() noexcept;
  Finding refuse() noexcept;

  const std::string tracker_;
  const std::vector<std::uint16_t> sensors_;
  bool delivers_ = false;
  State state_ = State::in_cookie;
  std::size_t expected_ = cookie_bytes; ///< held bytes that end the state
  std::size_t to_skip_ = 0;
  Header header_;
  std::array<std::byte, max_held_bytes> message_{};
  std::bitset<max_numbers> is_tracker_;       ///< the numbers of senders with the tracker's name
  std::array<Kind, max_numbers> type_kind_{}; ///< indexed by the type's number
};

/// Returns the messages that describe the tracker as sender 0 and the ping as type 0.
std::vector<std::byte> describe_ping(std::string_view tracker);
/// Returns a ping of sender 0.
std::vector<std::byte> ping();

} // namespace nendo::driver::vrpn
