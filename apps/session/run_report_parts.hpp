#pragma once
// The two forms of a run's report.

#include "session/run_report.hpp"

namespace nendo::session {

/// Print objects on standard output, a line each.
void print_progress_json(const flow::Frame& frame, double elapsed_s);
void print_summary_json(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                        const RunOutcome& outcome);

/// Prints a table on standard output.
void print_summary_text(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                        const RunOutcome& outcome);

} // namespace nendo::session
