#pragma once
// The report of a stress test: the verdict in one line, a table for people, an object for programs,
// and files for plotters.

#include <cstdint>
#include <cstdio>
#include <string>

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

/// Returns a time of the run as ISO 8601 in UTC, with microseconds.
std::string wall_time(const StressOutcome& outcome, HostTime time);

/// Returns all measurements, with the environment. Times are in microseconds unless a
/// key says otherwise. Keys are stable, because --compare reads earlier reports.
nlohmann::ordered_json stress_json(const StressOptions& options, const StressOutcome& outcome);

/// Returns the differences between the work of two reports, in one line: stages, load, rate, mode
/// or model. Empty if nothing does.
std::string different_work(const nlohmann::ordered_json& earlier,
                           const nlohmann::ordered_json& report);

/// Prints `report`, which is the stress_json() of this test, as a table. `earlier` is the report of
/// another test, which is printed beside it, or null.
void print_stress(std::FILE* out, const StressOptions& options, const StressOutcome& outcome,
                  const nlohmann::ordered_json& report, const nlohmann::ordered_json& earlier);

/// Prints the lateness on standard output as cyclictest does: a line for each microsecond up to
/// `max_us`, and the number of ticks beyond.
void print_histogram(const flow::Histogram& lateness, unsigned max_us);

/// Returns the lateness of each scheduled tick as an HdrHistogram percentile file, in microseconds,
/// with a line for each class of values.
std::string hgrm(const flow::Histogram& lateness);

/// Returns the histogram and the course of the lateness as SVG.
std::string stress_picture(const StressOptions& options, const StressOutcome& outcome);

} // namespace nendo::stress
