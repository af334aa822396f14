#pragma once
// Parses times as people type them.

#include <string>

#include <nendo/base/result.hpp>

namespace nendo::cli {

/// Returns the seconds of "90", "90s", "10m", "2h" or "1d", which must be more than 0. Error:
/// usage, naming the option.
Result<double> parse_duration(const std::string& text, const std::string& option = "--duration");

} // namespace nendo::cli
