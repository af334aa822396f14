#include "gloves/open_hand.hpp"

#include <chrono>
#include <thread>
#include <utility>

#include "cli/cli.hpp"

namespace nendo::gloves {

using std::chrono::milliseconds;

Result<OpenHand> open_hand(const std::string& spec, std::optional<Side> side,
                           EventCount* event_count, const driver::GloveContext& context) {
  auto glove = driver::open_glove(spec, side, context);
  if (!glove) return glove.error();
  return hand_of(*std::move(glove), side, event_count);
}

OpenHand hand_of(std::unique_ptr<driver::Glove> glove, std::optional<Side> side,
                 EventCount* event_count) {
  const Side own_side = glove->info().side;
  if (side && own_side != *side) {
    cli::note(glove->info().source + " says that it is a " + std::string(name_of(own_side)) +
              "-hand glove; it shapes as the " + std::string(name_of(*side)) +
              " hand, as you asked");
  }
  OpenHand hand;
  hand.side = side.value_or(own_side);
  hand.ring = std::make_unique<SampleRing>(1024, event_count);
  hand.glove = std::move(glove);
  return hand;
}

Result<void> wait_for_first_sample(OpenHand& hand) {
  constexpr auto patience = milliseconds(2000);
  const HostTime end = HostClock::now() + patience;
  while (HostClock::now() < end && !cli::stop_requested()) {
    if (hand.ring->try_pop(hand.first)) return {};
    std::this_thread::sleep_for(milliseconds(5));
  }
  if (cli::stop_requested()) return Error{Errc::failed, "stopped before the first sample came"};
  return Error{Errc::no_device,
               hand.glove->info().source +
                   ": opened, but no sample came within 2 s; is the glove plugged into "
                   "its interface unit?"};
}

// A sample tells the side of the glove that sent it, which need not be the one that was identified.
Result<void> calibrate(OpenHand& hand, const CalibrationOptions& options,
                       const HandLength& length) {
  auto wearer = find_wearer(hand.glove->info(), hand.first.side, options);
  if (!wearer) return wearer.error();
  hand.wearer = *std::move(wearer);
  for (hand::HandSize* size : {&hand.wearer.left.size, &hand.wearer.right.size})
    *size = length.size(*size);
  return {};
}

} // namespace nendo::gloves
