#pragma once
// Splits the byte stream of a Forte glove into records. It is pure (no I/O, clock, log or
// allocation), and bytes are not trusted. A frame's first byte occurs nowhere else, so the next
// frame is found after any damage.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <nendo/driver/sample.hpp>

#include "stream/stream_parser.hpp"

namespace nendo::driver::forte {

// The serial protocol of the BeBop Forte Data Glove. Each fact names who states it:
//   [S]  github.com/sofwerx/dataglove: scripts that bear the maker's name and ran over Bluetooth,
//        and test_scripts/readme.md
//   [?]  stated by no source, chosen here
//
// Both directions look like MIDI. The host sends control changes of three bytes. The glove sends
// frames that begin with F0 and end with F7 and hold neither between [S]: F0, the kind, the number
// of bytes that follow, these bytes, F7. No command is known that ends the stream or asks for the
// hand.

/// The rate that [S] sets, though only at Bluetooth ports, which have no rate.
inline constexpr int baud = 460'800;
inline constexpr int other_baud = 115'200; ///< the most common one [?]

// Commands [S]. Frames come after the first and one of the others.
using Command = std::array<std::uint8_t, 3>;
inline constexpr Command data_on{0xB0, 0x73, 0x01};
inline constexpr Command to_usb{0xB0, 0x76, 0x01};
inline constexpr Command to_bluetooth{0xB0, 0x76, 0x02};

// Frames [S].
inline constexpr std::byte frame_begin{0xF0};
inline constexpr std::byte frame_end{0xF7};
inline constexpr std::byte motion_id{0x02}; ///< 12 bytes of an inertial sensor; layout unknown

// The frame that is a record [S]: begin, id, length, ten sensors, battery, end.
inline constexpr std::uint8_t record_id = 0x01;
inline constexpr std::uint8_t record_length = 11; ///< ten sensors and the battery
inline constexpr std::size_t sensor_count = 10;
inline constexpr std::uint8_t max_count = 127; ///< 0 is extended, 127 closed
inline constexpr std::size_t record_bytes = 15;
// The battery's byte has no known unit.

/// Each finger has two sensors, thumb first [S]. [S] does not say which of the two is nearer to the
/// palm. The maker's Unity and Unreal kits list the knuckle first, so that order is likely, but not
/// certain.
inline constexpr std::array<Sensor, sensor_count> slots{
    Sensor::thumb_mcp,  Sensor::thumb_ip,   Sensor::index_mcp, Sensor::index_pip,
    Sensor::middle_mcp, Sensor::middle_pip, Sensor::ring_mcp,  Sensor::ring_pip,
    Sensor::little_mcp, Sensor::little_pip};

struct Record {
  std::array<std::uint8_t, sensor_count> flexion{}; ///< in the order of `slots`, 0 to max_count
  std::uint8_t battery = 0;                         ///< in an unknown unit
  unsigned clamped = 0;                             ///< counts above max_count, which are set to it
};

/// Decodes a whole frame with its first and last byte. Returns nothing if it is no record: it has
/// another kind or length.
std::optional<Record> decode_record(std::span<const std::byte> frame) noexcept;

/// Frames of motion, and bytes between frames, are discarded and are not bad.
class Parser : public StreamParser<Parser> {
public:
  /// Drops the unfinished frame. The next byte may come from anywhere in a frame.
  void reset() noexcept;

private:
  friend StreamParser;

  enum class State : std::uint8_t {
    between,  ///< between two frames
    in_frame, ///< in a frame that may be a record
    skipping, ///< in the rest of a frame that is no record, or whose beginning was not seen
  };

  std::optional<Record> push_byte(std::byte byte) noexcept;
  std::optional<Record> end_frame() noexcept;
  void skip_byte(std::byte byte) noexcept;

  State state_ = State::skipping;
  std::array<std::byte, record_bytes> frame_{};
};

} // namespace nendo::driver::forte
