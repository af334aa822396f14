#pragma once
// Chooses processors for two threads that work at once.

#include <nendo/base/result.hpp>

namespace nendo::cli {

struct TwoProcessors {
  int first = 0;
  int second = 0;
};

/// Returns the first two processors that this process may use. Fails if there is only one.
Result<TwoProcessors> two_processors();

} // namespace nendo::cli
