#pragma once
// A CyberGlove's interface unit, from the device's side and without any I/O or clock: bytes from
// the host and the time go in, bytes to the host come out. It shares no code with the driver's
// parser, so that each can test the other. The facts are those of the vendor library (VirtualHand
// 2, 1993) and of drivers that cite the manual; where sources disagree, cyberglove_unit.cpp says
// what was chosen.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <nendo/driver/sample.hpp>

#include "emulator/unit_message.hpp"
#include "simulated/hand_motion.hpp"
#include "simulated/typical_wearer.hpp"

namespace nendo::driver {

struct UnitOptions {
  Side side = Side::right;
  unsigned sensors = 22; ///< 18 or 22
  Motion motion = Motion::sculpt;
  double rate_hz = 90.0; ///< until the host sets a period: 1..most_rate_hz
  std::uint32_t seed = 1;
};

struct UnitCounters {
  std::uint64_t records = 0;       ///< put into the output
  std::uint64_t bytes_refused = 0; ///< of records and replies for which the output had no room
};

class CyberGloveUnit {
public:
  using Time = std::chrono::nanoseconds; ///< since the unit was switched on; never goes back

  static constexpr std::size_t output_capacity = 1024;
  static constexpr double most_rate_hz = 480.0; ///< records of 24 bytes that 115200 baud can carry

  explicit CyberGloveUnit(const UnitOptions& options);

  /// Obeys the bytes that arrive at `now`, one after another. Any bytes are allowed.
  void receive(std::span<const std::byte> bytes, Time now);
  /// Does what is due at `now`: records of a stream, the end of a restart.
  void advance(Time now);
  /// When advance() will have something to do; empty if only the host can cause it.
  std::optional<Time> next_due() const noexcept;

  /// What waits for the host, at most output_capacity bytes. A message that does not fit is refused
  /// whole.
  std::span<const std::byte> output() const noexcept { return {output_.data(), output_size_}; }
  /// The host has taken the first `count` bytes of output().
  void take(std::size_t count) noexcept;

  UnitCounters counters() const noexcept { return counters_; }

private:
  using Byte = unit::Byte;
  using Message = unit::Message;

  struct Settings {
    bool time_stamp = false;
    bool filter = true;
    bool switch_drives_light = true;
    bool light = false;
    bool switch_on = false;
    bool quantised = false;
    bool status_byte = false;
    std::uint32_t mask = 0xFFFFFF;
    Byte values = 22;
    Byte baud = 0;
    std::uint16_t period_ticks = 0; ///< the period is their product, in 1/115200 s
    std::uint16_t period_repeats = 1;
  };
  struct Flag;
  static const std::array<Flag, 7> flags;

  Settings power_up_settings() const noexcept;

  void obey(Byte byte, Time now);
  void begin(Byte letter, Time now);
  void collect_binary(Byte byte);
  void collect_text(Byte byte);
  void set(Byte letter, const Message& argument);
  void answer(Byte letter);
  std::optional<Message> lookup(Byte letter) const;

  void start_stream(Byte header, Time now);
  void send_record(Byte header, Time now, bool too_fast);
  Message fields(Time now);
  bool send(const Message& message); ///< false: refused

  std::uint32_t parameters() const noexcept;
  std::uint64_t requested_ticks() const noexcept;
  std::uint64_t least_ticks() const noexcept;

  UnitOptions options_;
  std::uint32_t hardware_mask_;
  HandMotion motion_;
  TypicalWearer wearer_;
  Settings settings_;

  Byte command_ = 0; ///< the letter whose argument is incomplete; 0: none
  Message argument_;
  Time command_since_{};

  Byte stream_header_ = 0; ///< 0: not streaming
  Time next_record_{};
  Time period_{};
  std::optional<Time> restart_ends_;
  Time clock_origin_{};
  std::optional<Time> motion_origin_;

  std::array<std::byte, output_capacity> output_{};
  std::size_t output_size_ = 0;
  UnitCounters counters_;
};

} // namespace nendo::driver
