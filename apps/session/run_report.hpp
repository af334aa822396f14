#pragma once
// Reports a run: a line of progress while it lasts and a summary at its end, for people or as JSON
// lines.

#include "session/run_session.hpp"

namespace nendo::session {

/// Returns the function that reports the progress of a run with these hands. In a terminal it
/// rewrites one line of standard error, and elsewhere it prints a line every two seconds. With
/// `options.json` it prints an object a second on standard output.
Progress progress_for(const RunOptions& options, const std::vector<gloves::OpenHand>& hands);

/// Prints the summary on standard output: a table, or with `options.json` one object.
void print_summary(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                   const RunOutcome& outcome);

/// The JSON forms of both. Each prints one line on standard output.
void print_progress_json(const flow::Frame& frame, double elapsed_s);
void print_summary_json(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                        const RunOutcome& outcome);

} // namespace nendo::session
