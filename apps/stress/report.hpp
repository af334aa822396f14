#pragma once
// The report of a stress test: a table for people, an object for programs, files for plotters.

#include <cstdio>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "stress/stress_session.hpp"

namespace nendo::stress {

/// Returns everything that was measured, with the environment. Times are in microseconds unless a
/// key says otherwise. Keys are stable, because --compare reads earlier reports.
nlohmann::ordered_json stress_json(const StressOptions& options, const StressOutcome& outcome);

/// Prints the same figures as a table. `earlier` is the JSON report of another test, which is
/// printed beside this one, or null.
void print_stress(std::FILE* out, const StressOptions& options, const StressOutcome& outcome,
                  const nlohmann::ordered_json& earlier);

/// Prints the lateness as cyclictest does: a line for each microsecond up to `most_us`, and what is
/// beyond.
void print_histogram(const flow::Histogram& lateness, unsigned most_us);

/// Returns the lateness of each scheduled tick as an HdrHistogram percentile file, in microseconds,
/// with a line for each class of values.
std::string hgrm(const flow::Histogram& lateness);

/// Returns the histogram and the course of the lateness as SVG.
std::string stress_picture(const StressOptions& options, const StressOutcome& outcome);

} // namespace nendo::stress
