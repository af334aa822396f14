// Judges the options of an emulated CyberGlove.

#include <bit>
#include <string>
#include <utility>

#include <nendo/base/units.hpp>

#include "units/capture.hpp"
#include "units/cyberglove_unit.hpp"

namespace nendo::emulator {
namespace {

Error usage(const std::string& what) {
  return {Errc::usage, what};
}

Result<void> check(const EmulatorOptions& options) {
  const EmulatedCyberGlove& special = options.cyberglove;
  if (options.sensors != 0 && options.sensors != 18 && options.sensors != 22) {
    return usage("sensors " + std::to_string(options.sensors) +
                 ": a CyberGlove has 18 or 22; give older ones by their mask");
  }
  if (special.hardware_mask > 0xFFFFFF) {
    return usage("mask: it has 24 bits, e.g. 7fff7f for 22 sensors");
  }
  if (options.sensors != 0 && special.hardware_mask != 0 &&
      std::popcount(special.hardware_mask) != static_cast<int>(options.sensors)) {
    return usage("sensors " + std::to_string(options.sensors) + ": the mask has " +
                 std::to_string(std::popcount(special.hardware_mask)) + "; leave one of them out");
  }
  if (special.model < 1 || special.model > 3) {
    return usage("model " + std::to_string(special.model) + ": use 1, 2 or 3");
  }
  if (special.reply_bytes != 2 && special.reply_bytes != 3) {
    return usage("reply-bytes " + std::to_string(special.reply_bytes) + ": use 2 or 3");
  }
  if (!(special.restart_s >= 0.0 && special.restart_s <= 60.0)) {
    return usage("restart-time: use 0s to 60s");
  }
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= CyberGloveUnit::max_rate_hz)) {
    return usage("rate: use 1 to 480 records per second (what 115200 baud can carry)");
  }
  return {};
}

} // namespace

Result<std::unique_ptr<EmulatedUnit>> make_cyberglove_unit(const EmulatorOptions& options) {
  if (auto checked = check(options); !checked) return checked.error();
  const auto motion = driver::find_motion(options.motion);
  if (!motion) return motion.error();
  const EmulatedCyberGlove& special = options.cyberglove;
  UnitOptions unit;
  if (!special.replay.empty()) {
    auto capture = read_capture(special.replay);
    if (!capture) return capture.error();
    unit.capture = *std::move(capture);
  }
  unit.side = options.side;
  unit.sensors = options.sensors == 18 ? 18 : 22;
  unit.mask = special.hardware_mask;
  unit.model = special.model;
  unit.touch = special.touch;
  unit.motion = *motion;
  unit.rate_hz = options.rate_hz;
  unit.seed = options.seed;
  unit.reply_bytes = special.reply_bytes;
  unit.period_order =
      special.period_low_first ? unit::WordOrder::low_first : unit::WordOrder::high_first;
  unit.stamp_bit7 = special.stamp_bit7;
  unit.hires_form =
      special.hires_terminated ? unit::HiResForm::terminated : unit::HiResForm::hardware;
  unit.restart_time = from_seconds(special.restart_s);
  unit.overrun = special.overrun;
  unit.streaming = special.streaming;
  unit.pattern = special.pattern;
  unit.played = special.played;
  return std::unique_ptr<EmulatedUnit>(std::make_unique<CyberGloveUnit>(unit));
}

} // namespace nendo::emulator
