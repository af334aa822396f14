#pragma once
// What a recording is, told to people or as JSON.

#include <string>

#include <nendo/recording/take_tools.hpp>

namespace nendo::takes {

/// Who, when, how long, gloves with rates, losses and pauses, the loop, gaps and damage.
void print_take(const std::string& file, const recording::TakeSummary& summary);
/// The same as one object on standard output.
void print_take_json(const std::string& file, const recording::TakeSummary& summary);

/// One line a damage; nothing if there is none.
void print_damages(const recording::TakeSummary& summary);

} // namespace nendo::takes
