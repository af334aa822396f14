#pragma once
// A run's report in its two forms.

#include "run_report.hpp"

namespace nendo::app {

constexpr double milliseconds_of(std::chrono::nanoseconds time) noexcept {
  return static_cast<double>(time.count()) / 1e6;
}

/// Objects, a line each, on standard output.
void print_progress_json(const flow::Frame& frame, double elapsed_s);
void print_summary_json(const RunOptions& options, const std::vector<OpenHand>& hands,
                        const RunOutcome& outcome);

/// A table on standard output.
void print_summary_text(const RunOptions& options, const std::vector<OpenHand>& hands,
                        const RunOutcome& outcome);

} // namespace nendo::app
