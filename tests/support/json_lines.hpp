#pragma once
// Reads the JSON lines that a program printed.

#include <nlohmann/json.hpp>

#include "support/program.hpp"

namespace nendo::test {

/// Returns the last line of standard output, which is mostly a summary; null if there is none.
inline nlohmann::json last_object(const Finished& done) {
  const auto lines = lines_of(done.out);
  return lines.empty() ? nlohmann::json() : nlohmann::json::parse(lines.back());
}

} // namespace nendo::test
