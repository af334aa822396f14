#pragma once
// A CyberGlove's interface unit, from the device's side. It shares no code with the driver's
// parser, so that each can test the other. The facts are those of the vendor library (VirtualHand
// 2, 1993) and of drivers that cite the manual. Where these disagree or say nothing, a comment in
// the .cpp files gives the choice.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/emulator/emulator.hpp>

#include "simulated/hand_motion.hpp"
#include "simulated/typical_wearer.hpp"
#include "units/emulated_unit.hpp"
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

/// Returns how many bytes the argument of a binary command has, as far as its first bytes show.
/// Returns 0 if there is no such command, and nothing if the argument is wrong. `letter` is a
/// capital letter.
std::optional<std::size_t> argument_bytes(Byte letter, const Message& argument,
                                          std::size_t sensors);
/// Returns how many bytes each number of a command or a query stands for.
std::size_t number_width(Byte letter) noexcept;

/// Handles a set command whose argument is complete. Returns false, and sets nothing, if a number
/// is out of range. The sources disagree on the byte order of the period's words.
bool apply(Settings& settings, Byte letter, const Message& argument, bool period_low_first,
           const PluggedGlove& glove);

/// Returns the value of an on-off setting by its letter; nothing if the letter is no such setting.
std::optional<bool> switch_state(const Settings& settings, Byte letter) noexcept;
/// Returns the part of the parameter flags that a host can write.
std::uint32_t writable_parameters(const Settings& settings) noexcept;

// The commands that only a CyberGlove III has. All begin with the digit 1. Only their forms are
// known, from programs that drive the glove. Comments in the .cpp file say what was chosen beyond
// that.

inline constexpr Byte three_prefix = '1'; ///< and the header of a stream of 12-bit records

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

// Records, in the 8-bit, the text and the 12-bit form.

/// The parts of a record besides the sensors.
struct RecordFrame {
  Byte header = 'S'; ///< a small letter makes it a text
  EmulatedUnit::Time now{};
  std::uint64_t ticks = 0; ///< the unit's clock
  Byte status = 0;
  bool too_fast = false;       ///< the period is too short: `es`
  unsigned subframes = 1;      ///< 12-bit records: how many there are in a frame of 1/30 s
  unsigned first_subframe = 0; ///< the number of the first of them
};

class RecordMaker {
public:
  /// If there is a `capture`, its records are sent as the 8-bit records, again and again.
  RecordMaker(driver::Motion motion, Side side, std::uint32_t seed, bool stamp_bit7, bool pattern,
              std::vector<Message> capture);

  /// Sets the hand that is in the glove from now on.
  void wear(Side side);
  /// Lets it move like this, if it is something, and not by its own motion.
  void play(driver::SensorMotion motion) { played_ = std::move(motion); }
  /// Stops a sensor at a count of at most 255, or at its own count.
  void stick(Sensor sensor, std::optional<std::uint16_t> count) noexcept;
  void release(Sensor sensor) noexcept;

  /// Returns a record: header, values, time stamp, status, error pairs, NUL. `known` is the glove
  /// that the unit has read, and `plugged` the one in its socket.
  Message record(const RecordFrame& frame, const Settings& settings, const PluggedGlove& known,
                 const std::optional<PluggedGlove>& plugged);
  /// Returns a 12-bit record of a CyberGlove III, which has 61 bytes.
  Message fine_record(const RecordFrame& frame, const std::optional<PluggedGlove>& plugged);

private:
  unsigned patterned(std::size_t slot) const noexcept; ///< 1 to 255
  driver::JointAngles angles(EmulatedUnit::Time now);
  unsigned held(std::size_t slot, unsigned sixteenths) noexcept;
  Message fields(const RecordFrame& frame, const Settings& settings, const PluggedGlove& known,
                 const std::optional<PluggedGlove>& plugged);
  Message time_stamp(std::uint64_t ticks) const;

  driver::Motion motion_;
  std::uint32_t seed_;
  driver::HandMotion hand_;
  driver::TypicalWearer wearer_;
  bool stamp_bit7_;
  bool pattern_;
  std::size_t record_number_ = 0; ///< the record's number in the pattern
  std::vector<Message> capture_;
  std::size_t next_captured_ = 0;
  std::optional<EmulatedUnit::Time> motion_origin_;
  driver::SensorMotion played_;
  SensorMask stuck_;
  /// Of stuck sensors, in 16ths of a count; nothing: the next one that it shows.
  std::array<std::optional<unsigned>, sensor_slots> stuck_at_{};
};

} // namespace nendo::emulator::unit

namespace nendo::emulator {

/// EmulatedCyberGlove::replay is not used: its records are in `capture`.
struct UnitOptions : EmulatedCyberGlove {
  Side side = Side::right;
  unsigned sensors = 22; ///< 18 or 22; counts only if there is no mask
  driver::Motion motion = driver::Motion::sculpt;
  double rate_hz = 90.0; ///< until the host sets a period: 1..max_rate_hz
  std::uint32_t seed = 1;
  std::vector<unit::Message> capture; ///< records to send instead of a motion
};

class CyberGloveUnit final : public EmulatedUnit {
public:
  static constexpr double max_rate_hz = 480.0; ///< records of 24 bytes that 115200 baud can carry

  explicit CyberGloveUnit(const UnitOptions& options);

  void receive(std::span<const std::byte> bytes, Time now) override;
  void advance(Time now) override; ///< records, the end of a restart
  std::optional<Time> next_due() const noexcept override;
  void inject(const Incident& incident, Time now) override;

private:
  using Byte = unit::Byte;
  using Message = unit::Message;

  // Record n is due n periods after the start. Time is counted in ticks, so that the time stamps
  // are exact.
  struct Stream {
    Byte header = 0; ///< 0: none; '1': 12-bit records
    Time start{};
    std::uint64_t period_ticks = 0;
    std::uint64_t next = 1;
    bool too_fast = false;
  };

  /// A single record that is asked for sooner than the unit can take it. What the host says
  /// meanwhile waits.
  struct Poll {
    Byte header = 0;
    Time due{};
  };

  void hear(Byte byte, Time now);
  void handle(Byte byte, Time now);
  void stop();
  void begin(Byte letter, Time now);
  void collect_binary(Byte byte, Time now);
  void collect_text(Byte byte, Time now);
  void collect_three(Byte byte, Time now);
  void set(Byte letter, const Message& argument, Time now);
  void confirm(Byte letter, const Message& argument);
  void answer(Byte letter);
  std::optional<std::string> text(Byte letter) const;
  std::optional<std::vector<unsigned>> numbers(Byte letter) const;
  void read_glove() noexcept;
  void begin_restart(bool answers, Time now);
  void end_restart();
  unit::Settings power_up() const noexcept;

  void start_stream(Byte header, Time now);
  void start_three(Time now);
  bool start_sync(Time now);
  Time due(std::uint64_t record) const noexcept;
  bool send_next();
  void advance_stream(Time now);
  void poll(Byte header, Time now);
  void answer_polls(Time now);
  void send_single(Byte header, Time now);
  void reply(const Message& message);

  std::uint32_t parameters() const noexcept;
  std::uint64_t min_ticks() const noexcept; ///< the shortest period that the unit manages
  std::uint64_t own_ticks() const noexcept;

  UnitOptions options_;
  std::optional<unit::PluggedGlove> plugged_;
  unit::PluggedGlove known_; ///< as the unit last read it
  unit::PluggedGlove next_;  ///< what will be plugged in next
  unit::RecordMaker records_;
  unit::Settings settings_;
  unit::ThreeSettings three_;

  Byte command_ = 0; ///< the letter whose argument is incomplete; 0: none
  Message argument_;
  Time command_since_{};

  std::optional<Poll> poll_;
  std::optional<Time> last_single_;
  std::deque<Byte> waiting_;

  Stream stream_;
  std::optional<Time> restart_ends_;
  bool restart_answers_ = false; ///< a power cycle says nothing when it is over
  Time clock_origin_{};
};

} // namespace nendo::emulator
