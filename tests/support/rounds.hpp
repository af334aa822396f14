#pragma once
// How often a test repeats what it does at random.

#include <algorithm>

#include "support/restraint.hpp"

namespace nendo::test {

/// Returns a quarter of the rounds under a sanitizer, which makes each of them ten times as long.
/// It looks for faults that any round would show; the laws are tested with all rounds without it.
constexpr int rounds(int all) noexcept {
  return restraint_is_counted ? all : std::max(1, all / 4);
}

} // namespace nendo::test
