#pragma once
// Looks at a TOML text of unknown origin before toml++ reads it. Debian's toml++ (3.3 in Debian 12,
// 3.4 in Debian 13) assumes that some malformed input cannot occur: `a = #` or `[ ,]` are failed
// assertions or undefined behaviour in it, as are blanks beyond ASCII, and keys with thousands of
// points overflow its stack.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo {

struct TomlFault {
  std::size_t line = 1; ///< counted from 1
  std::string what;     ///< what is wrong there, and what to do about it; printable
};

/// The most parts that a key may have (a.b.c has three), and the most lists and tables in braces
/// that may be nested. Files of this project need four.
inline constexpr int max_toml_depth = 16;

/// Returns the first place where the text is not plain TOML, or nothing if toml++ may read it.
/// Plain is what the files of this project have: tables, keys, and as values decimal numbers,
/// booleans, dates with a time, strings on one line or in three single quotes, lists, and tables in
/// braces, nested at most `max_toml_depth` deep. It does not check what only toml++ can:
/// whether a number has too many digits, an escape is known, or a key is repeated. Takes a time
/// proportional to the size of the text.
NENDO_API std::optional<TomlFault> find_toml_fault(std::string_view text);

} // namespace nendo
