#pragma once
// The gloves of a run: those that were named, or what the machine has.

#include <vector>

#include <nendo/deform/mesh.hpp>

#include "gloves/open_hand.hpp"
#include "session/run_options.hpp"

namespace nendo::session {

/// Opens and starts the gloves and waits for the first sample of each. With none named it uses what
/// is identified, and simulated hands, saying so, if there is nothing. Errors as open_glove();
/// no_device if no sample comes; as known_hands(); as open_touching_glove(), whose hands touch
/// `model`. The readers get the priority that goes with the loop's; what the system says to that is
/// added to options.grants. With OverrunPolicy::sample, `event_count` is what wakes the loop; it
/// must outlive both.
Result<std::vector<gloves::OpenHand>> open_hands(RunOptions& options, const deform::Mesh& model,
                                                 EventCount& event_count);

} // namespace nendo::session
