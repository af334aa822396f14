#pragma once
// Every command and query of the interface unit as a typed function; cyberglove_protocol.hpp has
// the bytes. None may be called while the glove streams. Each call waits for its reply, at most as
// long as the constructor says unless stated otherwise. Answer tells the unit's errors apart.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nendo/driver/sample.hpp>

#include "cyberglove/cyberglove_dialogue.hpp"
#include "cyberglove/cyberglove_parameters.hpp"
#include "cyberglove/cyberglove_period.hpp"

namespace nendo::driver::cyberglove {

/// A reply. `value` is valid only if the answer is good.
template <class T>
struct Reply {
  Answer answer = Answer::silent;
  T value{};
  explicit operator bool() const noexcept { return answer == Answer::good; }
};

struct GloveState {
  bool initialised = false;
  bool connected = false; ///< a glove is plugged into the unit
};

/// The offsets and gains by which the unit quantises values. The first `sensors` of each are valid.
struct HardwareCalibration {
  std::size_t sensors = 0;
  std::array<std::uint8_t, sensor_slots> offset{};
  std::array<std::uint8_t, sensor_slots> gain{};
  friend bool operator==(const HardwareCalibration&, const HardwareCalibration&) = default;
};

using Vibration = std::array<std::uint8_t, 6>; ///< thumb to pinky, palm
struct Vibrator {
  std::uint8_t index = 0; ///< into Vibration
  std::uint8_t strength = 0;
};

struct RecordBytes {
  std::array<std::byte, max_plain_bytes> bytes{};
  std::size_t size = 0; ///< with header and NUL
};

/// The places to which a CyberGlove III can send its records.
enum class Sink : char { usb = 'u', wifi = 'w', card = 's' };

class Commands {
public:
  explicit Commands(Dialogue& dialogue, std::chrono::milliseconds timeout) noexcept
      : dialogue_(dialogue), timeout_(timeout) {}

  // Queries about the glove and its unit.
  Reply<std::string> information(); ///< several lines; up to 1 s
  Reply<std::string> help();        ///< the unit's own list of commands and errors; up to 1 s
  Reply<std::string> firmware_text();
  Reply<std::array<std::uint8_t, 4>> firmware() noexcept;
  Reply<GloveState> state() noexcept;
  Reply<std::uint8_t> sensor_count() noexcept;
  Reply<SensorMask> hardware_mask() noexcept;
  Reply<Side> side() noexcept;

  // Settings, which the unit forgets them when it is switched off.
  Reply<bool> get(Setting setting) noexcept;
  Answer set(Setting setting, bool on) noexcept;
  Reply<SensorMask> software_mask() noexcept;
  Answer set_software_mask(SensorMask mask) noexcept;
  Reply<std::uint8_t> value_count() noexcept;
  Answer set_value_count(std::uint8_t count) noexcept;
  Reply<Parameters> parameters() noexcept;
  Answer set_parameters(const Parameters& parameters) noexcept;
  /// Makes records begin with Y and come at the pulses of the sync input. Pulses that are too fast
  /// give bad_sync_rate.
  Answer set_sync(bool on) noexcept;
  Answer set_text_sync(bool on) noexcept; ///< the same for records in text, which begin with y
  Reply<std::array<std::byte, 4>> period_bytes() noexcept; ///< see decode_period()
  /// Sets the period in text, which has no byte order, and then asks for it in bytes. The value is
  /// the byte order that the reply shows, if the unit knows the query. bad_rate and bad_number mean
  /// that the unit refuses, and other_value that it set another period.
  Reply<std::optional<WordOrder>> set_period(Period period) noexcept;
  Reply<HardwareCalibration> hardware_calibration(std::size_t sensors) noexcept;
  Answer set_hardware_calibration(const HardwareCalibration& calibration) noexcept;
  Answer set_offset(std::uint8_t sensor, std::uint8_t offset) noexcept;
  Answer set_gain(std::uint8_t sensor, std::uint8_t gain) noexcept;
  Reply<std::uint8_t> baud_register() noexcept; ///< see baud_of_register()
  /// Sets the line rate. No source says at which of the two rates the reply comes, so any answer
  /// but an error may mean success. Set the transport's rate afterwards and ask for the state.
  Answer set_baud_register(std::uint8_t byte) noexcept;
  Reply<Vibration> vibration() noexcept;
  Answer set_vibration(const Vibration& strength) noexcept;
  Answer set_vibrators(std::span<const Vibrator> some) noexcept; ///< at most 6

  // Control.
  Answer stop() noexcept;         ///< ends a stream, or a command that waits for its argument
  Answer restart() noexcept;      ///< up to 2.5 s; settings are then as after power-up
  Answer reread_glove() noexcept; ///< reads the memory of a glove that was swapped
  Reply<RecordBytes> record(std::size_t min_bytes) noexcept;

  // CyberGlove III only.
  Answer set_sink(Sink sink, bool on) noexcept;
  Answer set_frame_rate(std::uint8_t thirties) noexcept; ///< in steps of 30 Hz
  Answer set_divider(Sink sink, std::uint8_t divider) noexcept;

private:
  template <std::size_t size>
  Reply<std::array<std::byte, size>> ask(const Query& query) noexcept;
  Reply<std::string> ask_text(char letter, std::chrono::milliseconds timeout);
  Answer set(std::string_view head, std::span<const std::uint8_t> arguments) noexcept;
  Answer set(std::string_view head, std::uint8_t argument) noexcept;

  Dialogue& dialogue_;
  const std::chrono::milliseconds timeout_;
};

} // namespace nendo::driver::cyberglove
