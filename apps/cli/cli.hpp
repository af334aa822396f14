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

/// Makes the C library request huge pages if the kernel gives them only on request
/// (transparent_hugepage/enabled is "madvise"). For commands that fill large memory once, where
/// faults of 4 KiB pages can take more time than the model (../../deform/CUTTING.md has
/// measurements). The library reads the option at program start (GLIBC_TUNABLES,
/// glibc.malloc.hugetlb=1, glibc 2.35 and newer), so this executes the program again, in the same
/// process. Keeps an existing value of glibc.malloc.hugetlb, such as 0. On failure it returns,
/// without effect. Call it first in main().
void use_huge_pages(char** argv) noexcept;

struct TwoProcessors {
  int first = 0;
  int second = 0;
};

/// Returns the first two processors that this process may use. Error: failed (only one).
Result<TwoProcessors> two_processors();

} // namespace nendo::cli
