#pragma once
// Reads packets of Open Sound Control 1.0 (M. Wright, "The Open Sound Control 1.0 Specification",
// 2002): a message, or a bundle of messages and bundles. It is pure (no I/O, clock, log or
// allocation), and bytes are not trusted.

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace nendo::driver::osc {

// All numbers are big-endian. A string ends with NUL, and is padded to a multiple of 4 bytes.
//   message: address, a string that begins with '/'; types, a string that begins with ',';
//   arguments bundle:  "#bundle" NUL, time tag (8 bytes, NTP; 1 is "immediately"), elements: i32
//   size, packet
inline constexpr std::string_view bundle_mark{"#bundle\0", 8};

/// Longer packets are refused. It is the longest datagram in one Ethernet frame.
inline constexpr std::size_t max_packet_bytes = 1472;
/// More bundles within one another are refused. Known programs send one. Chosen.
inline constexpr std::size_t max_nesting = 4;

struct Message {
  std::string_view address;
  std::string_view types; ///< one letter per argument
  std::span<const std::byte> arguments;
  /// The time tag of its bundle, since 2020-01-01 UTC: a zero that is near, so that nanoseconds of
  /// each NTP era fit. Empty if it has none, or "immediately".
  std::optional<std::chrono::nanoseconds> time;
};

/// Iterates over the messages of a packet, whose bytes must outlive it.
class MessageReader {
public:
  explicit MessageReader(std::span<const std::byte> packet) noexcept : packet_(packet) {}

  /// Returns the next message, or nothing at the end, and at bytes that violate the format.
  std::optional<Message> next() noexcept;
  bool is_malformed() const noexcept { return is_malformed_; }

private:
  using Bytes = std::span<const std::byte>;
  struct Bundle {
    Bytes rest; ///< the elements that were not read
    std::optional<std::chrono::nanoseconds> time;
  };

  std::optional<Bytes> next_element() noexcept;
  bool enter_bundle(Bytes bytes) noexcept;

  std::optional<Bytes> packet_; ///< the whole packet, until it is read
  std::array<Bundle, max_nesting> bundles_{};
  std::size_t depth_ = 0;
  bool is_malformed_ = false;
};

/// Returns whether all of the packet is as the format says. Does not check arguments.
bool is_well_formed(std::span<const std::byte> packet) noexcept;

/// Reads all arguments of the message into `numbers`. Returns false unless they are this number of
/// arguments of the types f, d and i, and nothing else.
bool read_numbers(const Message& message, std::span<double> numbers) noexcept;

} // namespace nendo::driver::osc
