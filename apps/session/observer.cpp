#include "session/observer.hpp"

namespace nendo::session {

GloveStatuses status_of(const std::vector<gloves::OpenHand>& hands) {
  GloveStatuses statuses;
  for (const gloves::OpenHand& hand : hands) {
    const auto stats = hand.glove->stats();
    statuses[flow::Placement::index_of(hand.side)] = {hand.glove->info().source, stats.bad_records,
                                                      stats.ring_refused};
  }
  return statuses;
}

} // namespace nendo::session
