#pragma once
// The serial protocol of Ascension's Flock of Birds and miniBIRD. Each fact names who states it:
//   [A]  Ascension's own programs and manual, as IGSTK's command interpreter cites them
//   [V]  VRPN's driver    [S]  VESS' and xvs' drivers, which read the model
// A flock is up to 14 boxes (units) on a bus of their own. The host talks to the first one. A box
// with a receiver is a bird. Commands are single bytes and act at once, without an answer.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nendo::driver::flock {

/// 8N1; switches at the back choose the rate. [V] uses 115200.
inline constexpr std::array bauds{115'200, 38'400, 57'600, 19'200, 9'600};

// Commands [A, V].
inline constexpr std::uint8_t point_command = 'B'; ///< one record of each bird; ends a stream
inline constexpr std::uint8_t stream_command = '@';
inline constexpr std::uint8_t run_command = 'F';
inline constexpr std::uint8_t sleep_command = 'G'; ///< switches the transmitter off
inline constexpr std::uint8_t position_quaternion_command = ']';
inline constexpr std::uint8_t hemisphere_command = 'L'; ///< and two bytes
inline constexpr std::uint8_t examine_command = 'O';    ///< and a parameter
inline constexpr std::uint8_t change_command = 'P';     ///< and a parameter and its bytes
/// Plus the unit's address, before a command that is for that unit. Addresses of 16 and more have
/// other prefixes.
inline constexpr std::uint8_t to_unit_command = 0xF0;
inline constexpr unsigned max_address = 14;

// Parameters [A].
inline constexpr std::uint8_t revision_parameter = 1; ///< two bytes, of the firmware
inline constexpr std::uint8_t scale_parameter = 3;    ///< a word: 0 is 36 inches, 1 is 72
inline constexpr std::uint8_t rate_parameter = 7;     ///< a word: Hz * 256
inline constexpr std::uint8_t error_parameter = 10;   ///< one byte, which reading clears
inline constexpr std::uint8_t model_parameter = 15;   ///< ten characters
inline constexpr std::uint8_t group_parameter = 35;   ///< 1: a record ends with the bird's address
inline constexpr std::uint8_t units_parameter = 36;   ///< one byte for each address
inline constexpr std::uint8_t configure_parameter = 50; ///< the number of units

// Sizes of the answer to units_parameter, in the three modes of addressing [A].
inline constexpr std::array<std::size_t, 3> units_bytes{14, 30, 126};
inline constexpr std::uint8_t accessible_bit = 0x80;
inline constexpr std::uint8_t running_bit = 0x40;
inline constexpr std::uint8_t receiver_bit = 0x20;

/// Begins the model of an extended range controller [S], which is then the first unit.
inline constexpr std::string_view controller_model = "6DERC";

// A record: position and quaternion, each value two bytes of seven bits, low one first, then the
// address. Bit 7 is set in the first byte alone [A, V].
inline constexpr std::size_t record_values = 7;
inline constexpr std::size_t record_bytes = 2 * record_values + 1;
inline constexpr double full_scale = 32768.0;
inline constexpr double inch_m = 0.0254;
// The position's full scale, in inches [A].
inline constexpr double usual_range_in = 36.0;
inline constexpr double wide_range_in = 72.0;
inline constexpr double controller_range_in = 144.0;

/// The half of space in which all receivers are; a transmitter's field is the same in both.
struct Hemisphere {
  std::string_view name;
  std::uint8_t axis = 0;
  std::uint8_t sign = 0;
};
inline constexpr std::array hemispheres{Hemisphere{"forward", 0, 0}, Hemisphere{"aft", 0, 1},
                                        Hemisphere{"right", 6, 0},   Hemisphere{"left", 6, 1},
                                        Hemisphere{"lower", 12, 0},  Hemisphere{"upper", 12, 1}};

// Errors of units that were asked for records before they ran [V].
inline constexpr unsigned not_initialised = 9;
inline constexpr unsigned transmitter_off = 29;

/// Returns what an error of error_parameter means [V].
constexpr std::string_view meaning_of_error(unsigned error) noexcept {
  if (error == 0) return "none";
  if (error <= 5) return "memory or stored configuration";
  if (error == 6) return "invalid command";
  if (error == not_initialised) return "not configured";
  if (error >= 10 && error <= 12) return "bus between the units, or serial line";
  if (error == 13) return "no answer from a unit; check the bus cable and the addresses";
  if (error >= 20 && error <= 27) return "defect; call the maker";
  if (error == transmitter_off) return "transmitter off";
  if (error == 30) return "no transmitter at the extended range controller";
  if (error == 32) return "receiver saturated; move it away from the transmitter";
  return "see the maker's manual";
}

} // namespace nendo::driver::flock
