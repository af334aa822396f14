#pragma once
// A LucidGlove from the device's side. It shares no code with the driver's parser, so that each can
// test the other. The facts are those of the LucidGloves firmware, and, for what only that has
// (information replies, starting and stopping), of SenseShift's library.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nendo/driver/sample.hpp>

#include "simulated/hand_motion.hpp"
#include "units/emulated_unit.hpp"

namespace nendo::emulator {

struct LucidGlovesUnitOptions {
  Side side = Side::right;
  driver::Motion motion = driver::Motion::sculpt;
  double rate_hz = 100.0; ///< 1..most_rate_hz
  std::uint32_t seed = 1;
  bool answers = true; ///< knows Z, (ZA) and (ZZ); the LucidGloves firmware itself does not
};

class LucidGlovesUnit final : public EmulatedUnit {
public:
  static constexpr double most_rate_hz = 140.0; ///< lines of up to 82 bytes, at 115200 baud

  explicit LucidGlovesUnit(const LucidGlovesUnitOptions& options);

  void receive(std::span<const std::byte> bytes, Time now) override;
  void advance(Time now) override; ///< the lines that are due
  std::optional<Time> next_due() const noexcept override;

  /// Returns the resistances that the host asked for, thumb to pinky, 0 free to 1000 locked.
  const std::array<int, 5>& brakes() const noexcept { return brakes_; }

private:
  void handle(std::string_view command);
  std::string line(Time now) const;

  const LucidGlovesUnitOptions options_;
  const Time period_;
  driver::HandMotion motion_;
  bool streaming_ = true;
  std::optional<Time> motion_origin_; ///< empty until time was seen to pass
  Time next_line_{};
  std::string command_; ///< so far
  std::array<int, 5> brakes_{};
};

/// Makes the unit. Never returns null.
std::unique_ptr<EmulatedUnit> make_lucidgloves_unit(const LucidGlovesUnitOptions& options);

} // namespace nendo::emulator
