#pragma once
// A CyberGlove's interface unit, from the device's side. It shares no code with the driver's
// parser, so that each can test the other. The facts are those of the vendor library (VirtualHand
// 2, 1993) and of drivers that cite the manual. Where these disagree or say nothing, a comment in
// the .cpp files gives the choice.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/emulator/emulator.hpp>

#include "simulated/hand_motion.hpp"
#include "units/cyberglove_records.hpp"
#include "units/cyberglove_settings.hpp"
#include "units/emulated_unit.hpp"
#include "units/unit_message.hpp"

namespace nendo::emulator {

struct UnitOptions {
  Side side = Side::right;
  unsigned sensors = 22;  ///< 18 or 22; counts only if there is no mask
  std::uint32_t mask = 0; ///< the sensors that the glove has; 0: the usual ones
  unsigned model = 1;     ///< CyberGlove I, II or III
  bool touch = false;     ///< it has CyberTouch's vibrators
  driver::Motion motion = driver::Motion::sculpt;
  double rate_hz = 90.0; ///< until the host sets a period: 1..max_rate_hz
  std::uint32_t seed = 1;
  unsigned reply_bytes =
      2; ///< reply to a set command: the letter and NUL, or 3 with a byte between
  unit::WordOrder period_order = unit::WordOrder::high_first;
  bool stamp_bit7 = true;
  unit::HiResForm hires_form = unit::HiResForm::hardware;
  std::chrono::nanoseconds restart_time = std::chrono::milliseconds(200);
  bool overrun = false;               ///< EmulatedCyberGlove::overrun
  bool streaming = false;             ///< it streams from the start, as after a host that died
  bool pattern = false;               ///< EmulatedCyberGlove::pattern
  driver::SensorMotion played;        ///< EmulatedCyberGlove::played
  std::vector<unit::Message> capture; ///< records to send instead of a motion
};

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
