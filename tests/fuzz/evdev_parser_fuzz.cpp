// The first byte chooses the kind of device and how the rest, which are its events, is cut into
// chunks.

#include "evdev/evdev_motion.hpp"
#include "evdev/evdev_parser.hpp"

#include "parser_fuzz.hpp"

using namespace nendo::driver::evdev;

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  Parser parser;
  EvdevMotion motion{MotionScale{}};
  motion.set_device(static_cast<InputKind>(*data % 4U), BTN_0);
  nendo::HostTime now{std::chrono::seconds(1)};
  push_stream(parser, {rest_of({data, size}), 1 + *data % 61U, event_bytes}, [&](auto chunk) {
    now += std::chrono::milliseconds(7);
    parser.push(chunk, [&](const Event& event) {
      // Also the ranges that a device reports may be any.
      if (event.type == EV_KEY && event.code < axes)
        motion.set_range(event.code, {event.value, ~event.value, event.value});
      motion.take(event, now);
      require_pose(motion.pose(), box_half_m, 5e-7);
    });
    motion.advance(now);
    require_pose(motion.pose(), box_half_m, 5e-7);
  });
  return 0;
}
