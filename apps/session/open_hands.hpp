#pragma once
// Opens the gloves of a run: the named ones, or the machine's.

#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "gloves/open_hand.hpp"
#include "session/run_options.hpp"

namespace nendo::session {

struct RunHands {
  std::vector<gloves::OpenHand> hands;
  std::vector<flow::Grant> grants; ///< the result of requesting the readers' priority
};

/// Opens and starts the gloves and waits for the first sample of each. If none is named, opens the
/// detected gloves or, without any, simulated hands, and notes it. Simulated hands may have motions
/// for `model` (motions::planned_motions()). The readers get flow::reader_priority(). With
/// OverrunPolicy::sample, `event_count` wakes the loop; it must outlive the loop and the gloves.
/// Errors: usage (a switch action without a wrist switch), and those of gloves::open_glove() and
/// gloves::calibrate().
Result<RunHands> open_hands(RunOptions& options, const deform::Mesh& model,
                            EventCount& event_count);

/// Checks that there are one or two. Error: usage.
Result<void> check_count(const std::vector<std::string>& specs);
/// Opens one or two gloves. Errors: those of gloves::open_hand(), and usage (two gloves for the
/// same hand).
Result<std::vector<gloves::OpenHand>> open_each(const std::vector<std::string>& specs,
                                                EventCount* event_count = nullptr);

} // namespace nendo::session
