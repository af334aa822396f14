#pragma once
// Reports about a recording, as text and as JSON, on standard output.

#include <string>

#include <nendo/recording/take_tools.hpp>

namespace nendo::takes {

/// Prints the program, time and duration, the gloves with rates, losses and pauses, the loop, gaps
/// and damage.
void print_take(const std::string& file, const recording::TakeSummary& summary);
/// Prints the same as one JSON object.
void print_take_json(const std::string& file, const recording::TakeSummary& summary);

/// Prints one line for each damaged place.
void print_damages(const recording::TakeSummary& summary);

} // namespace nendo::takes
