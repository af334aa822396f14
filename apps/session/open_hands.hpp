#pragma once
// The gloves of a run: those that were named, or what the machine has.

#include <vector>

#include <nendo/deform/mesh.hpp>

#include "gloves/open_hand.hpp"
#include "session/run_options.hpp"

namespace nendo::session {

struct RunHands {
  std::vector<gloves::OpenHand> hands;
  std::vector<flow::Grant> grants; ///< what the system said to the readers' priority
};

/// Opens and starts the gloves and waits for the first sample of each. With none named it uses what
/// is identified, and simulated hands, saying so, if there is nothing. `model` is what hands of
/// sim:touch touch. The readers get the priority that goes with the loop's. With
/// OverrunPolicy::sample, `event_count` is what wakes the loop; it must outlive both. Errors as
/// open_glove(), known_hands() and touching_context(); no_device if no sample comes.
Result<RunHands> open_hands(RunOptions& options, const deform::Mesh& model,
                            EventCount& event_count);

} // namespace nendo::session
