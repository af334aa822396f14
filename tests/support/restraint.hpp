#pragma once
// Counts operations that a real-time thread must not do. While a Restraint lives, the calling
// thread's allocations, frees and mutex operations are counted, but not those of other threads.

#include <cstdint>

#include "support/sanitizers.hpp"

// Sanitizers replace malloc and the mutexes themselves.
#define NENDO_COUNTS_RESTRAINT (!NENDO_WATCHES_MEMORY && !NENDO_WATCHES_THREADS)

namespace nendo::test {

/// It is false in sanitizer builds, where all counts stay 0.
inline constexpr bool restraint_is_counted = NENDO_COUNTS_RESTRAINT;

struct RestraintCounts {
  std::uint64_t allocations = 0; ///< malloc and its family, which operator new ends in
  std::uint64_t frees = 0;
  std::uint64_t locks = 0; ///< mutexes locked or tried, conditions waited for or signalled
};

class Restraint {
public:
  Restraint() noexcept;
  ~Restraint() noexcept;
  Restraint(const Restraint&) = delete;
  Restraint& operator=(const Restraint&) = delete;

  RestraintCounts counts() const noexcept;
};

} // namespace nendo::test
