#pragma once
// Reads what a client of the VRPN server sends: its cookie, its names, and pings. Pure, and the
// bytes are not trusted.

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/driver/vrpn_protocol.hpp>

namespace nendo::publish::vrpn {

class Requests {
public:
  Requests() { sender_of_.fill(none); }

  /// Takes the next bytes, cut anywhere. Appends the senders that are pinged, as indices of
  /// sender_names. Returns false if the stream cannot be read: it is no VRPN 7, or a length is
  /// wrong.
  bool push(std::span<const std::byte> bytes, std::vector<std::size_t>& pinged);
  /// Returns whether the cookie has come.
  bool has_greeted() const noexcept { return has_greeted_; }
  /// Returns how many bytes wait for the rest of their message.
  std::size_t held_bytes() const noexcept { return held_.size(); }

  /// The longest message that is read; longer ones are skipped as they come.
  static constexpr std::size_t max_held_bytes = 256;

private:
  static constexpr std::uint8_t none = 0xFF;

  void take_held(std::vector<std::size_t>& pinged);
  void take_message(std::span<const std::byte> message, std::vector<std::size_t>& pinged);
  void take_name(std::int32_t number, bool is_sender, std::span<const std::byte> payload);

  std::vector<std::byte> held_;
  std::size_t expected_ = driver::vrpn::cookie_bytes; ///< held bytes with which something is whole
  std::size_t to_skip_ = 0;
  bool has_greeted_ = false;
  bool is_broken_ = false;
  /// The client's numbers of senders, as indices of sender_names.
  std::array<std::uint8_t, driver::vrpn::max_numbers> sender_of_{};
  std::bitset<driver::vrpn::max_numbers> is_ping_; ///< the client's numbers of types
};

} // namespace nendo::publish::vrpn
