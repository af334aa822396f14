#pragma once
// For what two threads do at once.

#include <nendo/base/result.hpp>

namespace nendo::cli {

struct TwoProcessors {
  int first = 0;
  int second = 0;
};

/// The first two that this process may use; an error if there is only one.
Result<TwoProcessors> two_processors();

} // namespace nendo::cli
