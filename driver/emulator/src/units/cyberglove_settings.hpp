#pragma once
// The settings of a CyberGlove's interface unit, the lengths of the commands that change them, and
// the parameter flags that show most of them at once.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <nendo/driver/sample.hpp>

#include "units/unit_message.hpp"

namespace nendo::emulator::unit {

inline constexpr std::uint64_t tick_hz = 115200; // of the period T and of the time stamp

// Control commands, a single byte each.
inline constexpr Byte stop_byte = 0x03;    ///< ends a stream, or a command that is incomplete
inline constexpr Byte reread_byte = 0x09;  ///< reads the glove, after a swap
inline constexpr Byte restart_byte = 0x12; ///< restarts the firmware

/// The glove itself, which the unit reads when it starts and at 0x09.
struct PluggedGlove {
  Side side = Side::right;
  std::uint32_t mask = 0; ///< the sensors that it has

  std::size_t sensors() const noexcept;
};

struct Settings {
  bool time_stamp = false;
  bool filter = true;
  bool switch_drives_light = true;
  bool light = false;
  bool switch_on = false;
  bool quantised = false;
  bool status_byte = false;
  bool binary_sync = false;
  bool text_sync = false;
  std::uint32_t mask = 0xFFFFFF;
  Byte values = 22;
  Byte baud = 0;
  std::uint16_t period_ticks = 0; ///< the period is their product, in 1/115200 s
  std::uint16_t period_repeats = 1;
  std::array<Byte, 6> vibration{};          ///< CyberTouch: thumb to little finger, palm
  std::array<Byte, sensor_slots> offsets{}; ///< offsets of the hardware calibration
  std::array<Byte, sensor_slots> gains{};   ///< the same, in 1/64

  /// Returns a converter's count after the hardware calibration, 1..255.
  Byte quantise(std::size_t slot, Byte count) const noexcept;
};

/// Returns the settings after switching on.
Settings power_up_settings(double rate_hz, const PluggedGlove& glove) noexcept;

/// The byte order of the period's words in the binary command and in its query. The sources
/// disagree on it.
enum class WordOrder : std::uint8_t { high_first, low_first };

/// Returns how many bytes the argument of a binary command has, as far as its first bytes show.
/// Returns 0 if there is no such command, and nothing if the argument is wrong. `letter` is a
/// capital letter.
std::optional<std::size_t> argument_bytes(Byte letter, const Message& argument,
                                          std::size_t sensors);
/// Returns how many bytes each number of a command or a query stands for.
std::size_t number_width(Byte letter) noexcept;

/// Handles a set command whose argument is complete. Returns false, and sets nothing, if a number
/// is out of range.
bool apply(Settings& settings, Byte letter, const Message& argument, WordOrder order,
           const PluggedGlove& glove);

/// Returns the value of an on-off setting by its letter; nothing if the letter is no such setting.
std::optional<bool> switch_state(const Settings& settings, Byte letter) noexcept;
/// Returns the part of the parameter flags that a host can write.
std::uint32_t writable_parameters(const Settings& settings) noexcept;

// The commands that only a CyberGlove III has. All begin with the digit 1. Only their forms are
// known, from programs that drive the glove. Comments in the .cpp file say what was chosen beyond
// that.

inline constexpr Byte three_prefix = '1'; ///< and the header of a stream of 12-bit records

/// How 12-bit streams begin, end, and count.
enum class HiResForm : std::uint8_t {
  hardware,  ///< 1S is echoed without NUL, 0x03 is answered by itself, sub-frames count from 0
  terminated ///< both answers end in NUL as all others, and sub-frames count from 1
};

struct ThreeSettings {
  unsigned frames = 3;  ///< the base rate in units of 30 Hz
  unsigned divider = 1; ///< divides the base rate, for the USB sink
  bool usb = true;      ///< the USB sink is on

  /// Returns the time between two 12-bit records, in 1/115200 s.
  std::uint64_t period_ticks() const noexcept;
};

/// Returns how many bytes the command has after its 1, as far as its first bytes (at least one)
/// show; nothing if there is no such command.
std::optional<std::size_t> three_bytes(const Message& command);

/// Handles a complete command. S, which starts the stream, is left to the caller. Returns false,
/// and sets nothing, if a number is out of range.
bool apply(ThreeSettings& settings, const Message& command);

} // namespace nendo::emulator::unit
