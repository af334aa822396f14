#pragma once
// Functions for all commands: errors and notes on standard error, JSON lines on standard output,
// stop signals, shipped models.

#include <atomic>
#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include <nendo/base/result.hpp>

namespace nendo::cli {

/// Prints the error in one line and returns its exit code.
int report(const Error& error);
/// Prints a line on standard error that is not an error.
void note(std::string_view text);

/// Returns the object in one line. Invalid UTF-8, as in names of files and devices, becomes U+FFFD.
std::string json_text(const nlohmann::ordered_json& object);
/// Prints the json_text() of the object and flushes, for readers of a pipe.
void print_line(const nlohmann::ordered_json& object);

/// Returns a flag that becomes true at SIGINT, SIGTERM or SIGHUP. A second such signal ends the
/// program at once.
const std::atomic<bool>& stop_requested() noexcept;
/// Sets the flag, as such a signal does.
void request_stop() noexcept;
/// Installs the handlers of these signals. SIGHUP stays ignored if it was, as under nohup.
void install_stop_signals() noexcept;

/// Returns the path of a shipped model, relative to the executable (../share/nendo/models).
std::filesystem::path shipped_model(std::string_view file_name);

} // namespace nendo::cli
