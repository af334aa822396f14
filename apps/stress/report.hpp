#pragma once
// The report of a stress test: the verdict in one line, a table for people, an object for programs,
// and files for plotters.

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

struct Verdict {
  /// The loop is on a grid, so that a tick can be late. A loop that samples pace has no rate to
  /// keep.
  bool judged = true;
  bool punctual = false;  ///< every tick that was due began before the next one was
  std::uint64_t due = 0;  ///< ticks that were due
  std::uint64_t late = 0; ///< those that began after the next one was due, or never
  double max_late_us = 0.0;
  std::string reason; ///< why some were late; empty if none was
  std::string remedy; ///< what to try; empty if none was
};

/// Judges a test. Pure.
Verdict judge(const StressOptions& options, const StressOutcome& outcome);

/// Returns the verdict as one line: "1 kHz: yes, with ..." or "1 kHz: no: 38 of 5,000
/// ticks were late, by up to ..., because ...; try ...".
std::string in_words(const Verdict& verdict, const StressOptions& options,
                     const StressOutcome& outcome);

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

/// Returns all measurements, with the environment. Times are in microseconds unless a
/// key says otherwise. Keys are stable, because --compare reads earlier reports.
nlohmann::ordered_json stress_json(const StressOptions& options, const StressOutcome& outcome);

/// Returns the differences between the work of two reports, in one line: stages, load, rate, mode
/// or model. Empty if nothing does.
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
