#pragma once
// A run's report in its two forms.

#include "session/run_report.hpp"

namespace nendo::session {

/// Objects, a line each, on standard output.
void print_progress_json(const flow::Frame& frame, double elapsed_s);
void print_summary_json(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                        const RunOutcome& outcome);

/// A table on standard output.
void print_summary_text(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                        const RunOutcome& outcome);

} // namespace nendo::session
