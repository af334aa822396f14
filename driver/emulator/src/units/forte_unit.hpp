#pragma once
// A BeBop Forte Data Glove from the device's side. It shares no code with the driver's parser, so
// that each can test the other. The facts are those of github.com/sofwerx/dataglove.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/driver/sample.hpp>

#include "simulated/hand_motion.hpp"
#include "units/emulated_unit.hpp"

namespace nendo::emulator {

struct ForteUnitOptions {
  Side side = Side::right; ///< the motion's hand; the glove does not report it
  driver::Motion motion = driver::Motion::sculpt;
  double rate_hz = 90.0; ///< 1..max_rate_hz
  std::uint32_t seed = 1;
  bool bluetooth = false; ///< the host is at its Bluetooth port
};

class ForteUnit final : public EmulatedUnit {
public:
  /// The rate of records that 115200 baud can carry, with a frame of motion after each.
  static constexpr double max_rate_hz = 370.0;

  explicit ForteUnit(const ForteUnitOptions& options);

  void receive(std::span<const std::byte> bytes, Time now) override;
  void advance(Time now) override; ///< the frames that are due
  std::optional<Time> next_due() const noexcept override;

private:
  using Byte = std::uint8_t;

  void handle(Time now);
  bool streams() const noexcept { return data_on_ && linked_; }
  std::vector<Byte> record(Time now) const;

  const ForteUnitOptions options_;
  const Time period_;
  driver::HandMotion motion_;
  std::array<Byte, 3> last_{}; ///< bytes from the host: a command, if it is one
  bool data_on_ = false;
  bool linked_ = false;               ///< set to send to the host's port
  std::optional<Time> motion_origin_; ///< empty until time was seen to pass
  Time next_record_{};
};

} // namespace nendo::emulator
