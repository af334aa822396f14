#pragma once
// The processors that this process may use.

#include <nendo/base/result.hpp>

namespace nendo::cli {

struct TwoProcessors {
  int first = 0;
  int second = 0;
};

/// Returns the first two processors that this process may use. Error: failed (only one).
Result<TwoProcessors> two_processors();

} // namespace nendo::cli
