#pragma once
// What a program said as JSON lines.

#include <nlohmann/json.hpp>

#include "support/program.hpp"

namespace nendo::test {

/// The last line of standard output, a summary mostly; null if there is none.
inline nlohmann::json last_object(const Finished& done) {
  const auto lines = lines_of(done.out);
  return lines.empty() ? nlohmann::json() : nlohmann::json::parse(lines.back());
}

} // namespace nendo::test
