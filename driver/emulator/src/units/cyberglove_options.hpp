#pragma once
// What an emulated CyberGlove's interface unit and its glove are like.

#include <chrono>
#include <cstdint>
#include <vector>

#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/sample.hpp>

#include "simulated/hand_motion.hpp"
#include "units/cyberglove_settings.hpp"
#include "units/cyberglove_three.hpp"
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
  unsigned reply_bytes = 2; ///< of a set command: the letter and NUL, or 3 with a byte between
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

} // namespace nendo::emulator
