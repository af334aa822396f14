#pragma once
// Validates untrusted TOML before toml++ parses it. Debian's toml++ (3.3 in Debian 12, 3.4 in
// Debian 13) has failed assertions or undefined behaviour on some malformed input: `a = #`, `[ ,]`,
// blanks beyond ASCII. Keys with thousands of dots overflow its stack.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo {

struct TomlFault {
  std::size_t line = 1; ///< counted from 1
  std::string what;     ///< the fault and its remedy; printable
};

/// The maximum number of parts of a dotted key (a.b.c has three), and of nested arrays and inline
/// tables. Files of this project need four.
inline constexpr int max_toml_depth = 16;

/// Returns the first fault, or nullopt if toml++ may parse the text. Accepted are tables, keys, and
/// as values decimal numbers, booleans, dates with a time, single-line strings, strings in three
/// single quotes, arrays and inline tables, nested at most `max_toml_depth` deep. Ranges of
/// numbers, unknown escapes and repeated keys are left to toml++. Takes linear time.
NENDO_API std::optional<TomlFault> find_toml_fault(std::string_view text);

} // namespace nendo
