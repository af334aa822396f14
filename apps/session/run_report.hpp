#pragma once
// Reports a run: a line of progress while it lasts and a summary at its end, for people or as JSON
// lines.

#include "session/run_session.hpp"

namespace nendo::session {

/// Returns what reports progress. In a terminal it rewrites one line of standard error, and
/// elsewhere it prints a line every two seconds. With `json` it prints an object a second on
/// standard output.
Progress progress_for(const RunOptions& options);

void print_summary(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                   const RunOutcome& outcome);

} // namespace nendo::session
