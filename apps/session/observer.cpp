#include "session/observer.hpp"

namespace nendo::session {

GloveStatuses status_of(const std::vector<gloves::OpenHand>& hands) {
  GloveStatuses statuses;
  for (const gloves::OpenHand& hand : hands) {
    statuses[flow::Placement::index_of(hand.side)] = {
        hand.glove->info().source, driver::counts_of(hand.glove->stats()), hand.uncalibrated};
  }
  return statuses;
}

} // namespace nendo::session
