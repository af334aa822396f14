#pragma once
// A LucidGlove from the device's side. It shares no code with the driver's parser, so that each can
// test the other. The facts are those of the LucidGloves firmware (commit 76472c7), and, for what
// only that has (information replies, starting and stopping), of SenseShift's library.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nendo/driver/sample.hpp>

#include "simulated/hand_motion.hpp"
#include "units/emulated_unit.hpp"

namespace nendo::emulator {

enum class LucidGlovesFirmware : std::uint8_t {
  senseshift,       ///< knows Z, (ZA) and (ZZ), and takes brakes
  streaming,        ///< LucidGloves without force feedback: hears nothing
  waiting,          ///< LucidGloves with force feedback: after each of its lines it waits for one
  legacy,           ///< 13 numbers joined by &; whatever line it hears sets its brakes
  legacy_waiting,   ///< the same, with force feedback
  unclamped,        ///< as streaming, but built with CLAMP_ANALOG_MAP false
  legacy_unclamped, ///< as legacy, but so built
};

struct LucidGlovesUnitOptions {
  Side side = Side::right;
  driver::Motion motion = driver::Motion::sculpt;
  double rate_hz = 100.0; ///< 1..max_rate_hz; a waiting one is as fast as it is answered
  std::uint32_t seed = 1;
  LucidGlovesFirmware firmware = LucidGlovesFirmware::senseshift;
};

class LucidGlovesUnit final : public EmulatedUnit {
public:
  static constexpr double max_rate_hz = 140.0; ///< lines of up to 82 bytes, at 115200 baud
  /// What a waiting firmware does between hearing a line and sending its next one.
  static constexpr Time loop_time = std::chrono::milliseconds(1);
  /// Arduino's time limit for a line, from its beginning and from each of its bytes on.
  static constexpr Time max_line_wait = std::chrono::seconds(1);
  /// Old versions set a longer one, up to 1000 s; chosen here.
  static constexpr Time max_legacy_wait = std::chrono::seconds(5);

  explicit LucidGlovesUnit(const LucidGlovesUnitOptions& options);

  void receive(std::span<const std::byte> bytes, Time now) override;
  void advance(Time now) override; ///< the lines that are due
  std::optional<Time> next_due() const noexcept override;

  /// Returns the resistances that the host asked for, thumb to little finger, 0 free to 1000
  /// locked.
  const std::array<int, 5>& brakes() const noexcept { return brakes_; }

private:
  struct Heard {
    std::string line;
    Time at; ///< when the wait for it ended
  };

  bool waits() const noexcept {
    return options_.firmware == LucidGlovesFirmware::waiting ||
           options_.firmware == LucidGlovesFirmware::legacy_waiting;
  }
  bool is_legacy() const noexcept;
  bool is_unclamped() const noexcept;
  bool is_deaf() const noexcept;
  Time max_wait() const noexcept { return is_legacy() ? max_legacy_wait : max_line_wait; }
  int number(double part) const;
  void advance_loop(Time now);
  std::optional<Heard> take_line(Time now);
  void handle(std::string_view command);
  void set_legacy_brakes(std::string_view command);
  std::string line(Time now) const;
  std::string legacy_line(const std::array<int, 5>& curls) const;

  const LucidGlovesUnitOptions options_;
  const Time period_;
  driver::HandMotion motion_;
  bool streaming_ = true;
  std::optional<Time> motion_origin_; ///< empty until time was seen to pass
  Time next_line_{};
  std::optional<Time>
      waits_since_;   ///< waits for a line since it sent its own; empty: its own is due
  Time last_heard_{}; ///< when the last byte arrived
  std::string heard_; ///< and not handled
  std::array<int, 5> brakes_{};
};

} // namespace nendo::emulator
