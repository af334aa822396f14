#pragma once
// The serial protocol of the BeBop Forte Data Glove. Each fact names who states it:
//   [S]  github.com/sofwerx/dataglove: scripts that bear the maker's name and ran over Bluetooth,
//        and test_scripts/readme.md
//   [?]  stated by no source, chosen here
//
// Both directions look like MIDI. The host sends control changes of three bytes. The glove sends
// frames that begin with F0 and end with F7 and hold neither between [S]: F0, the kind, the number
// of bytes that follow, these bytes, F7. No command is known that ends the stream or asks for the
// hand.

#include <array>
#include <cstddef>
#include <cstdint>

#include <nendo/driver/sample.hpp>

namespace nendo::driver::forte {

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

} // namespace nendo::driver::forte
