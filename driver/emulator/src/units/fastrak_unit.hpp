#pragma once
// A Polhemus FASTRAK from the device's side. It shares no code with the driver's parser, so that
// each can test the other. The facts are those of the FASTRAK manual (OPM00PI002 Rev. G, June 2012)
// and of drivers that cite it. Where these say nothing, a comment in the .cpp files gives the
// choice.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>

#include "simulated/wrist_motion.hpp"
#include "units/emulated_unit.hpp"
#include "units/fastrak_settings.hpp"
#include "units/unit_line.hpp"

namespace nendo::emulator::fastrak {

struct FastrakUnitOptions {
  std::array<bool, max_stations> plugged{true, true, false, false}; ///< the receivers
  driver::WristMotion motion = driver::WristMotion::orbit;
  std::uint32_t seed = 1;
  bool noise = false; ///< 0.8 mm and 0.15 degrees RMS for each axis
  unsigned baud = 115200;
  double restart_s = 10.0; ///< until it hears again after ^Y: 0 to 60
};

class FastrakUnit final : public EmulatedUnit {
public:
  static constexpr std::uint64_t cycles_hz = 120; ///< measurements of all stations together
  /// From the middle of a measurement until its solution is ready.
  static constexpr Time solution_delay{3'750'000};

  explicit FastrakUnit(const FastrakUnitOptions& options);

  void receive(std::span<const std::byte> bytes, Time now) override;
  void advance(Time now) override;
  std::optional<Time> next_due() const noexcept override;
  /// Glove in, out: all receivers. Switch: the button of a stylus, the receiver of station 1.
  void inject(const Incident& incident, Time now) override;
  unsigned baud() const noexcept override { return line_.baud(); }

private:
  using Byte = unit::Byte;

  void hear(Byte byte, Time now);
  void hear_parameter(Byte byte, Time now);
  bool act_at_once(Byte letter, Time now);
  void reply(std::string_view text, Time now);
  void send_status(Time now);
  void test(Time now);
  void poll(Time now);
  void start_stream(Time now);
  void press(bool pressed, Time now);

  Settings factory_settings() const;
  void power_up();
  void begin_restart(Time now);

  Time ready(std::uint64_t cycle) const noexcept;
  std::uint64_t last_cycle(Time now) const noexcept;
  void do_due(Time now);
  void run_cycle(Time now);
  void send_solution(std::size_t station, Time now);

  StationPose measured(std::size_t station, Time ready);
  StationPose nonsense();
  Receivers receivers(Time now);
  unit::Message record(std::size_t station, const StationPose& reported) const;

  const FastrakUnitOptions options_;
  Settings saved_; ///< in the EEPROM
  Settings settings_;
  unit::UnitLine line_;
  std::mt19937_64 random_;

  std::string command_; ///< whose CR has not come yet
  bool streaming_ = false;
  std::uint64_t next_cycle_ = 0;
  std::size_t turn_ = 0;              ///< the place of the next station among those that are on
  std::optional<std::size_t> waited_; ///< the station whose solution was dropped
  std::array<std::optional<Vector3>, max_stations> last_sent_cm_; ///< in this stream

  std::array<char, max_stations> errors_{' ', ' ', ' ', ' '}; ///< the last ones found
  bool receivers_out_ = false;
  bool button_ = false;
  std::optional<Time> restart_ends_;
  std::optional<Time> origin_; ///< the zero of motion and cycles; empty until time was seen to pass
};

} // namespace nendo::emulator::fastrak
