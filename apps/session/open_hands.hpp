#pragma once
// Opens the gloves of a run: those that were named, or those that the machine has.

#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "gloves/open_hand.hpp"
#include "session/run_options.hpp"

namespace nendo::session {

struct RunHands {
  std::vector<gloves::OpenHand> hands;
  std::vector<flow::Grant> grants; ///< whether the readers got their priority
};

/// Opens and starts the gloves and waits for the first sample of each. If none is named, it uses
/// the gloves that are identified or, if there are none, simulated hands, and says so. Simulated
/// hands may do something to `model` (motions::planned_motions()). The readers get the priority
/// that belongs to the loop's. With OverrunPolicy::sample, `event_count` wakes the loop; it must
/// outlive the loop and the gloves. Errors: usage (a switch action without a wrist switch), and
/// those of gloves::open_glove() and gloves::calibrate().
Result<RunHands> open_hands(RunOptions& options, const deform::Mesh& model,
                            EventCount& event_count);

/// Checks that these are one or two. Error: usage.
Result<void> check_count(const std::vector<std::string>& specs);
/// Opens each of these gloves, one or two. Errors: those of gloves::open_hand(), and usage (two
/// gloves of one hand).
Result<std::vector<gloves::OpenHand>> open_each(const std::vector<std::string>& specs);

} // namespace nendo::session
