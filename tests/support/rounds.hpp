#pragma once
// How often a test repeats what it does at random.

#include <algorithm>

#include "support/restraint.hpp"
#include "support/sanitizers.hpp"

namespace nendo::test {

/// Returns a quarter of the rounds under a sanitizer, which makes each of them ten times as long,
/// and an eighth under that of threads, which makes them thirty times as long.
/// Each looks for faults that any round would show; the laws are tested with all rounds without it.
constexpr int rounds(int all) noexcept {
  const int share = NENDO_WATCHES_THREADS != 0 ? 8 : restraint_is_counted ? 1 : 4;
  return std::max(1, all / share);
}

} // namespace nendo::test
