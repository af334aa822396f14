#pragma once
// A 5DT Data Glove 5 from the device's side. It shares no code with the driver's parser, so that
// each can test the other. The facts are those of VRPN's and VR Juggler's drivers. The reversed
// order of a left glove's fingers is what another driver expects.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/driver/sample.hpp>

#include "simulated/hand_motion.hpp"
#include "units/emulated_unit.hpp"

namespace nendo::emulator {

struct FiveDtUnitOptions {
  Side side = Side::right;
  driver::Motion motion = driver::Motion::sculpt;
  double rate_hz = 100.0; ///< 1..max_rate_hz
  std::uint32_t seed = 1;
  bool wireless = false;          ///< streams by itself and hears nothing; ten bytes per sample
  bool ten_bytes = false;         ///< a wired unit of those that send 0x55 after each sample
  bool left_little_first = false; ///< a left glove's samples begin with the little finger
};

class FiveDtUnit final : public EmulatedUnit {
public:
  /// The rate of ten-byte samples that 19200 baud can carry. A wireless glove sends half as many.
  static constexpr double max_rate_hz = 190.0;
  static constexpr double max_wireless_rate_hz = 95.0;

  explicit FiveDtUnit(const FiveDtUnitOptions& options);

  void receive(std::span<const std::byte> bytes, Time now) override;
  void advance(Time now) override; ///< the samples that are due
  std::optional<Time> next_due() const noexcept override;

private:
  using Byte = std::uint8_t;

  void handle(Byte command, Time now);
  std::vector<Byte> information() const;
  std::vector<Byte> sample(Time now) const;
  void send_bytes(const std::vector<Byte>& bytes);

  const FiveDtUnitOptions options_;
  const Time period_;
  driver::HandMotion motion_;
  bool streaming_;
  std::optional<Time> motion_origin_; ///< empty until time was seen to pass
  Time next_sample_{};
};

} // namespace nendo::emulator
