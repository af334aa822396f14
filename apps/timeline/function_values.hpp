#pragma once
// The values of a puppet's functions over time. They follow from hands and events alone, so that
// nobody needs the model.

#include <functional>
#include <span>

#include "timeline/puppet_hands.hpp"

namespace nendo::timeline {

/// The hands and the functions at one moment.
struct PuppetMoment {
  const PuppetHands& hands;
  bool is_held = false; ///< the hands hold the model
};

/// Calls `see` with the number of each time and the functions as they are then. At the time of a
/// frame they are those of Player, unless the hands cannot grab the model there. Times must
/// not fall. The timeline must have a puppet and be playable (complaint_about()).
void play_functions(const Timeline& timeline, std::span<const double> times_s,
                    const std::function<void(std::size_t, const PuppetMoment&)>& see);

} // namespace nendo::timeline
