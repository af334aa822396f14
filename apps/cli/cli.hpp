#pragma once
// Functions that all commands share: errors and notes on standard error, the stop signals, the
// shipped models, and durations as people type them.

#include <atomic>
#include <filesystem>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::cli {

/// Prints the error in one line and returns its exit code.
int report(const Error& error);
/// Prints a line on standard error that is not an error.
void note(std::string_view text);

/// Returns a flag that becomes true at SIGINT, SIGTERM or SIGHUP. A second such signal ends the
/// program at once.
const std::atomic<bool>& stop_requested() noexcept;
/// Lets these signals set the flag. SIGHUP stays ignored if it was, as under nohup.
void install_stop_signals() noexcept;

/// Returns the path of a model that ships with the program, which is beside the executable
/// (../share/nendo/models).
std::filesystem::path shipped_model(std::string_view file_name);

/// Returns the seconds of "90", "90s", "10m", "2h" or "1d", which must be more than 0. Error:
/// usage, naming the option.
Result<double> parse_duration(const std::string& text, const std::string& option = "--duration");

} // namespace nendo::cli
