#pragma once
// explore() runs a small program through every execution that Memory allows: every order of its
// threads' operations, and every message that each of them may read. Depth first, by running the
// program again from its beginning with the next choices, so that the program must choose by
// nothing else; its loops must end whatever they read.
//
// Orders of execution that no thread can tell apart are run once (sleep sets; P. Godefroid,
// "Partial-Order Methods for the Verification of Concurrent Systems", 1996). As Memory keeps old
// messages, a load that runs after a store can read all that it could have read before it, so that
// only one of the two orders must be tried.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "explorer/memory.hpp"

namespace nendo::explorer {

/// Where in the source an operation stands, and what it is there.
struct Site {
  enum class Kind { load, store, update, fence };
  Kind kind = Kind::load;
  std::memory_order order = std::memory_order_relaxed;
  const char* file = "";
  const char* function = "";
  int line = 0;

  bool operator==(const Site& other) const;
};

/// A change to the program under test.
struct Mutation {
  enum class Kind {
    none,
    weaker,     ///< the order at `site` becomes `order`
    late_store, ///< the store at `site` comes after its thread's next release
    late_reads, ///< plain reads do
    late_writes ///< plain writes do
  };
  Kind kind = Kind::none;
  Site site;
  std::memory_order order = std::memory_order_relaxed;
};

struct Program {
  std::vector<std::function<void()>> threads; ///< at most max_threads - 1
  std::function<void()> at_end;               ///< after all threads, knowing all that they did
};

struct Options {
  Mutation mutation;
  bool reduced = true; ///< false: each order of execution is run, for tests of the reduction
};

struct Verdict {
  std::string fault;            ///< empty: every execution keeps the laws
  std::string trace;            ///< of the execution with the fault, an operation a line
  std::uint64_t executions = 0; ///< complete ones
  std::uint64_t cut = 0;        ///< given up because equivalent ones are among the complete ones
  std::uint64_t accesses = 0;   ///< to plain objects by the threads, each checked for races
  std::vector<Site> sites;      ///< the operations that were executed, with their unchanged orders
};

/// `make` builds the program, and what its threads share, again for each execution. Stops at the
/// first fault. One call at a time.
Verdict explore(const std::function<Program()>& make, const Options& options = {});

/// In a program: a law that must hold here.
void require(bool holds, const char* law);

/// What Atomic, Plain and fence() of atomics.hpp are made of.
Value perform(const Operation& operation, const Site& site);
void perform_fence(const Site& site);
std::size_t make_location(Value initial);
std::size_t make_plain();
void perform_access(std::size_t plain, Access access);

std::string describe(const Site& site);
const char* name_of(std::memory_order order);

} // namespace nendo::explorer
