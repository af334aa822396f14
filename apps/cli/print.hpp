#pragma once
// Prints by a format string, as fmt::print() does.

#include <cstdio>
#include <utility>

#include <spdlog/fmt/fmt.h>

namespace nendo::cli {

/// Unlike fmt::print(), does not throw on write errors: the command finishes its work, and
/// run_program() reports lost output.
template <class... Values>
void print(std::FILE* out, fmt::format_string<Values...> format, Values&&... values) {
  std::fputs(fmt::format(format, std::forward<Values>(values)...).c_str(), out);
}
/// Prints to standard output.
template <class... Values>
void print(fmt::format_string<Values...> format, Values&&... values) {
  cli::print(stdout, format, std::forward<Values>(values)...);
}

} // namespace nendo::cli
