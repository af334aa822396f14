#pragma once
// The protocol of VRPN 7 over TCP, as far as a client of trackers and a server of hands need it.
// Each fact names who states it:
//   [C]  vrpn_Connection.C of github.com/vrpn/vrpn
//   [B]  vrpn_BaseClass.C
//   [T]  vrpn_Tracker.C
//   [A]  vrpn_Analog.C, vrpn_Button.C
//   [?]  stated by no source, chosen here
//
// A client connects to the server's port. Both ends send a cookie at once, and then messages. The
// server names its senders (devices) and types of messages as soon as it has the cookie, and later
// whenever there is a new one [C]. Each end has numbers of its own for both.
//
// A server registers each name that a client describes and does not know yet, and then describes it
// to all clients as one of its own [C]. So a client must look for its tracker among the server's
// names before it sends the name, and the name alone does not say that such a tracker is there:
// only the server's own devices answer a ping [B].
//
// VRPN's own client does not begin with a connection. It sends a datagram to the server's port,
// which has its address and a port of TCP as text ("192.0.2.7 40123" and a NUL), and the server
// connects to that port [C].

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <nendo/base/api.hpp>

namespace nendo::driver::vrpn {

inline constexpr std::uint16_t default_port = 3883; ///< [C]

// The cookie: the version, two blanks, the log mode (0: none), zeros [C]. Versions must agree up to
// the last point; other minor versions understand each other.
inline constexpr std::size_t cookie_bytes = 24;
inline constexpr std::string_view cookie = "vrpn: ver. 07.35  0";
inline constexpr std::string_view cookie_agreed = "vrpn: ver. 07.";
inline constexpr std::size_t cookie_version_bytes = 16;

// A message: a header of six big-endian numbers of 32 bits, which are the length of header and
// payload, seconds and microseconds of the sender's clock, sender, type, sequence number; then the
// payload, and zeros up to a multiple of 8 bytes, which the length does not include [C].
inline constexpr std::size_t header_bytes = 24;
inline constexpr std::size_t alignment = 8;
inline constexpr std::size_t max_message_bytes = 65'536; ///< [?]

// Types with a meaning of their own [C]. A description has the number that it describes as its
// sender; its payload is a length with the NUL, the name, a NUL. Others: -3 a port for UDP, -4 the
// names of log files.
inline constexpr std::int32_t describes_sender = -1;
inline constexpr std::int32_t describes_type = -2;
inline constexpr std::size_t max_numbers = 2000;   ///< senders, and also types [C]
inline constexpr std::size_t max_name_bytes = 100; ///< with the NUL [C]

/// The sender that each server has for itself [C].
inline constexpr std::string_view control_name = "VRPN Control";

// Names of types.
/// i32 sensor, 4 unused bytes, 3 f64 position in metres, 4 f64 turn x y z w [T].
inline constexpr std::string_view pose_name = "vrpn_Tracker Pos_Quat";
inline constexpr std::size_t pose_payload_bytes = 64;
/// u32 severity, u32 level, text with a NUL; servers send the whole buffer of 1032 bytes [B].
inline constexpr std::string_view text_name = "vrpn_Base text_message";
inline constexpr std::size_t max_text_bytes = 1024;
inline constexpr std::uint32_t text_warning = 1; ///< severity; 0 is normal, 2 an error [B]
// Both have no payload [B].
inline constexpr std::string_view ping_name = "vrpn_Base ping_message";
inline constexpr std::string_view pong_name = "vrpn_Base pong_message";
/// f64 number of channels, f64 each [A].
inline constexpr std::string_view analog_name = "vrpn_Analog Channel";
/// i32 button, i32 state: 1 pressed [A].
inline constexpr std::string_view button_name = "vrpn_Button Change";

/// Returns the length of a payload with its zeros.
constexpr std::size_t padded(std::size_t payload_bytes) noexcept {
  return (payload_bytes + alignment - 1) / alignment * alignment;
}

/// Returns true for a number that a sender or a type can have.
constexpr bool is_number(std::int32_t number) noexcept {
  return number >= 0 && static_cast<std::size_t>(number) < max_numbers;
}

/// Returns the text up to its NUL, or all without one. It lives as long as the bytes.
inline std::string_view text_of(std::span<const std::byte> bytes) noexcept {
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return all.substr(0, all.find('\0'));
}

/// Returns the bytes with which each end begins: the cookie.
NENDO_API std::vector<std::byte> greeting();
/// Appends a message of sequence number 0, which no receiver uses [C]. time_us: since 1970 in UTC,
/// up to 2106; 0 for messages that need no time.
NENDO_API void append_message(std::vector<std::byte>& out, std::int64_t time_us,
                              std::int32_t sender, std::int32_t type,
                              std::span<const std::byte> payload);
/// Appends a description of `number`. what: describes_sender or describes_type.
NENDO_API void append_name(std::vector<std::byte>& out, std::int32_t what, std::int32_t number,
                           std::string_view name);

} // namespace nendo::driver::vrpn
