#pragma once
// A CyberGlove's interface unit, from the device's side. It shares no code with the driver's
// parser, so that each can test the other. The facts are those of the vendor library (VirtualHand
// 2, 1993) and of drivers that cite the manual. Where these disagree or say nothing, a comment in
// the .cpp files tells what was chosen.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/emulator/emulator.hpp>

#include "units/cyberglove_options.hpp"
#include "units/cyberglove_records.hpp"
#include "units/cyberglove_settings.hpp"
#include "units/cyberglove_three.hpp"
#include "units/emulated_unit.hpp"
#include "units/unit_message.hpp"

namespace nendo::emulator {

/// Makes the unit. Error: usage or bad_input, naming the option.
Result<std::unique_ptr<EmulatedUnit>> make_cyberglove_unit(const EmulatorOptions& options);

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
