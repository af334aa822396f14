#pragma once
// Litmus programs, small enough that all their outcomes can be counted, run in two ways that share
// no code: by the explorer, and by the axioms of the memory model.

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "explorer/explorer.hpp"

namespace nendo::explorer {

struct Instruction {
  enum class Kind { load, store, add, fence };
  Kind kind = Kind::load;
  std::size_t location = 0;
  Value value = 0;
  std::memory_order order = std::memory_order_relaxed;
};
/// The instructions of each thread. All locations start at 0.
using Litmus = std::vector<std::vector<Instruction>>;

/// What loads and additions read, thread by thread, then each location's last value.
using Outcome = std::vector<Value>;
struct Outcomes {
  std::set<Outcome> all;
  std::uint64_t executions = 0;
};

/// By the explorer.
Outcomes explored(const Litmus& litmus, bool reduced = true);
/// By going through all ways in which reads can take their values from writes, and writes to one
/// location be ordered, and keeping those that RC11's axioms allow (Lahav et al., PLDI 2017, figure
/// 1, without the part for seq_cst; release sequences as C++20 has them).
Outcomes by_axioms(const Litmus& litmus);

} // namespace nendo::explorer
