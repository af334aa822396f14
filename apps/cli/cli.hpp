#pragma once
// What all commands share: errors on standard error, the stop signal, and the shipped models.

#include <atomic>
#include <filesystem>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::cli {

/// Prints the error in one line and returns its exit code.
int report(const Error& error);
/// One line on standard error that is not an error.
void note(std::string_view text);

/// True after SIGINT, SIGTERM or SIGHUP; a second one ends the program at once.
const std::atomic<bool>& stop_requested() noexcept;
void install_stop_signals() noexcept;

/// A model that ships with the program, looked for beside the executable (../share/nendo/models).
std::filesystem::path shipped_model(std::string_view file_name);

} // namespace nendo::cli
