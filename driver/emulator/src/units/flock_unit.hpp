#pragma once
// An Ascension Flock of Birds from the device's side: up to 14 units on their bus, behind one
// serial line. It shares no code with the driver's parser, so that each can test the other. The
// facts are those of IGSTK's command interpreter, VRPN's driver and Ascension's own programs. Where
// these say nothing, a comment in the .cpp files gives the choice.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "simulated/wrist_motion.hpp"
#include "units/emulated_unit.hpp"
#include "units/flock_records.hpp"
#include "units/unit_line.hpp"
#include "units/unit_message.hpp"

namespace nendo::emulator::flock {

inline constexpr std::size_t max_units = 14;

struct FlockUnitOptions {
  std::vector<unsigned> birds{1, 2}; ///< addresses of units with a receiver, 1 to max_units
  bool has_controller = false;       ///< unit 1 is an extended range controller
  driver::WristMotion motion = driver::WristMotion::orbit;
  std::uint32_t seed = 1;
  bool noise = false; ///< 1.8 mm and 0.5 degrees RMS in all
  unsigned baud = 115200;
};

class FlockUnit final : public EmulatedUnit {
public:
  explicit FlockUnit(const FlockUnitOptions& options);

  void receive(std::span<const std::byte> bytes, Time now) override;
  void advance(Time now) override;
  std::optional<Time> next_due() const noexcept override;
  void inject(const Incident& incident, Time now) override; ///< power_cycle
  unsigned baud() const noexcept override { return line_.baud(); }

private:
  using Byte = unit::Byte;

  struct Bird {
    bool has_receiver = false;
    Byte format = 'Y';
    std::array<Byte, 2> hemisphere{0, 0};
    bool sends_buttons = false;
  };

  void power_up();
  void hear(Byte byte, Time now);
  void carry_out(Time now);
  void carry_out_for(Bird& bird, Time now);
  void examine(Byte parameter, Time now);
  void change(Time now);
  void configure(Byte units, Time now);
  void note_spoiled_quiet(Time now);
  unit::Message unit_states() const;
  void reply(unit::Message message, Time now);
  void start_stream(unsigned every, Time now);
  void send_records(Time now);
  unit::Message record(std::size_t address, Time now);
  ReceiverInches measured(const Bird& bird, std::size_t address, Time now);
  double range_in() const noexcept;
  Time period() const noexcept;
  bool runs() const noexcept { return configured_ && !asleep_; }

  const FlockUnitOptions options_;
  unit::UnitLine line_;
  std::mt19937_64 random_;
  std::size_t units_ = 0;                   ///< on the bus
  std::array<Bird, max_units + 1> birds_{}; ///< index: the address; the first is not used

  unit::Message command_;     ///< its bytes so far
  std::size_t addressed_ = 1; ///< the unit that the next command is for
  std::optional<Time> last_heard_;
  Time quiet_before_{};               ///< silence before the first byte of the command
  std::optional<Time> configured_at_; ///< since when the bus must be quiet
  std::optional<Time> deaf_until_;    ///< during a reset

  bool configured_ = false;
  bool asleep_ = false;
  bool group_ = false;
  unit::Message scale_, filters_, rate_;
  Byte error_ = 0;
  Byte error_address_ = 0;
  std::size_t streams_ = 0; ///< the unit of a stream, or 1 in group mode; 0: no stream
  unsigned every_ = 1;      ///< cycles per record of a stream
  Time next_cycle_{};
  std::optional<Time> origin_; ///< begin of the motion; empty until time was seen to pass
};

} // namespace nendo::emulator::flock
