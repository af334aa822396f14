#pragma once
// The report of a stress test: a table for people, an object for programs, files for plotters, and
// the figures of which they are made.

#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "stress/stress_session.hpp"

namespace nendo::stress {

/// How a histogram is reported. Times are in microseconds.
struct Figures {
  static constexpr std::array<std::string_view, 7> names{"min",   "p50",    "p90", "p99",
                                                         "p99_9", "p99_99", "max"};
  std::uint64_t count = 0;
  std::array<double, names.size()> us{}; ///< in the order of `names`
};

/// Returns nothing if nothing was recorded.
std::optional<Figures> figures_of(const flow::Histogram& histogram);

/// Returns the names of the stages that a tick runs, with "sleep" first.
std::vector<std::string> stage_names(const flow::TickStages& stages);

/// Returns a time of the run as ISO 8601 in UTC, with microseconds.
std::string wall_time(const StressOutcome& outcome, HostTime time);

/// Returns everything that was measured, with the environment. Times are in microseconds unless a
/// key says otherwise. Keys are stable, because --compare reads earlier reports.
nlohmann::ordered_json stress_json(const StressOptions& options, const StressOutcome& outcome);

/// Returns what makes the figures of two reports those of different work, in one line: stages,
/// load, rate, mode or model. Empty if nothing does.
std::string different_work(const nlohmann::ordered_json& earlier,
                           const nlohmann::ordered_json& report);

/// Prints the same figures as a table. `earlier` is the JSON report of another test, which is
/// printed beside this one, or null.
void print_stress(std::FILE* out, const StressOptions& options, const StressOutcome& outcome,
                  const nlohmann::ordered_json& earlier);

/// Prints the lateness on standard output as cyclictest does: a line for each microsecond up to
/// `max_us`, and the number of ticks beyond.
void print_histogram(const flow::Histogram& lateness, unsigned max_us);

/// Returns the lateness of each scheduled tick as an HdrHistogram percentile file, in microseconds,
/// with a line for each class of values.
std::string hgrm(const flow::Histogram& lateness);

/// Returns the histogram and the course of the lateness as SVG.
std::string stress_picture(const StressOptions& options, const StressOutcome& outcome);

} // namespace nendo::stress
