#pragma once
// A CyberGlove's interface unit, from the device's side. It shares no code with the driver's
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

#include "emulator/emulated_unit.hpp"
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

class CyberGloveUnit final : public EmulatedUnit {
public:
  static constexpr double most_rate_hz = 480.0; ///< records of 24 bytes that 115200 baud can carry

  explicit CyberGloveUnit(const UnitOptions& options);

  void receive(std::span<const std::byte> bytes, Time now) override;
  void advance(Time now) override; ///< records of a stream, the end of a restart
  std::optional<Time> next_due() const noexcept override;

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
};

} // namespace nendo::driver
