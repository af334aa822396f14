#pragma once
// Makes the records of an emulated CyberGlove in the 8-bit, the text and the 12-bit form.

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/sample.hpp>

#include "simulated/hand_motion.hpp"
#include "simulated/typical_wearer.hpp"
#include "units/cyberglove_settings.hpp"
#include "units/emulated_unit.hpp"
#include "units/unit_message.hpp"

namespace nendo::emulator::unit {

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
