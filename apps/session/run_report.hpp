#pragma once
// Reports a run: a line of progress while it lasts and a summary at its end, for people or as JSON
// lines.

#include "session/run_session.hpp"

namespace nendo::session {

/// Rewrites one line of standard error in a terminal; elsewhere a line every two seconds. With
/// `json`, an object a second on standard output.
Progress progress_for(const RunOptions& options);

void print_summary(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                   const RunOutcome& outcome);

} // namespace nendo::session
