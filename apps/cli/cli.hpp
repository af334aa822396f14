#pragma once
// Functions that all commands share: errors and notes on standard error, JSON lines on standard
// output, the stop signals, the shipped models.

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

/// Returns the object in one line. Bytes that are no UTF-8, as names of files and devices may have,
/// become U+FFFD.
std::string json_text(const nlohmann::ordered_json& object);
/// Prints that line and flushes it, so that a program at a pipe gets it at once.
void print_line(const nlohmann::ordered_json& object);

/// Returns a flag that becomes true at SIGINT, SIGTERM or SIGHUP. A second such signal ends the
/// program at once.
const std::atomic<bool>& stop_requested() noexcept;
/// Sets the flag, as such a signal does.
void request_stop() noexcept;
/// Lets these signals set the flag. SIGHUP stays ignored if it was, as under nohup.
void install_stop_signals() noexcept;

/// Returns the path of a model that ships with the program, which is beside the executable
/// (../share/nendo/models).
std::filesystem::path shipped_model(std::string_view file_name);

/// For what fills large memory once, and may spend more time on pages of 4 KiB than on the model
/// (../../deform/CUTTING.md has figures). Lets the C library ask the kernel for huge pages, if the
/// kernel gives them only on request (transparent_hugepage/enabled is "madvise"). The library reads
/// that option at a program's start (GLIBC_TUNABLES, glibc.malloc.hugetlb=1, glibc 2.35 and newer),
/// so this starts the program once more, in the same process. An existing value of
/// glibc.malloc.hugetlb, such as 0, is kept. If it cannot be done, it returns, and the program
/// continues as it is. Call it first in main().
void use_huge_pages(char** argv) noexcept;

struct TwoProcessors {
  int first = 0;
  int second = 0;
};

/// Returns the first two processors that this process may use. Fails if there is only one.
Result<TwoProcessors> two_processors();

} // namespace nendo::cli
