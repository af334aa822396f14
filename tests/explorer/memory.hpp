#pragma once
// Memory: what threads may read and write under the C++20 memory model, one operation at a time.
//
// Each atomic location keeps all that was ever stored there, in modification order. A thread has a
// view: for each location the newest message that it knows of, before which it may not read any
// more, and for each thread how much of it happened before. A release takes the view along with the
// message, an acquire joins it to the reader's. Plain accesses that no view puts in order are a
// data race. This is the release/acquire part of RC11 (Lahav, Vafeiadis, Kang, Hur, Dreyer,
// "Repairing sequential consistency in C/C++11", PLDI 2017) in the operational form of Kang, Hur,
// Lahav, Vafeiadis, Dreyer, "A promising semantics", POPL 2017, without promises: a load reads from
// a store that was executed before it. seq_cst is not modelled, and refused.

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace nendo::explorer {

using Value = std::uint64_t;
inline constexpr std::size_t max_threads = 5; ///< with the one that sets up and checks, 0
inline constexpr std::size_t max_locations = 24;

/// Picks one of `count` possibilities.
using Choose = std::function<std::size_t(std::size_t count)>;

struct Operation {
  enum class Kind { load, store, exchange, add };
  Kind kind = Kind::load;
  std::size_t location = 0;
  Value value = 0; ///< to store, to exchange for or to add
  std::memory_order order = std::memory_order_relaxed;
};
enum class Access { read, write };

struct View {
  std::array<std::uint64_t, max_locations> seen{};   ///< by location: its newest message's stamp
  std::array<std::uint32_t, max_threads> happened{}; ///< by thread: how many of its steps

  void join(const View& other);
};

class Memory {
public:
  /// Thread 0 is alone before spawn() and after join_all().
  void spawn(std::size_t threads);
  void join_all();

  std::size_t new_location(Value initial);
  /// Returns what it read. `choose` picks among the messages that it may read, the newest first,
  /// and among the places in modification order that a store may take, the last first.
  Value apply(std::size_t thread, const Operation& operation, const Choose& choose);
  void fence(std::size_t thread, std::memory_order order);

  std::size_t new_plain(std::size_t thread);
  void access(std::size_t thread, std::size_t plain, Access access);

  /// The first data race, or wrong use; empty while there is none.
  [[nodiscard]] const std::string& fault() const { return fault_; }

private:
  struct Message {
    Value value = 0;
    std::uint64_t stamp = 0; ///< its place in modification order
    bool of_update = false; ///< by a read-modify-write: nothing comes between it and what that read
    View released;
  };
  using Location = std::vector<Message>; ///< in modification order
  struct Thread {
    View now;
    View to_acquire; ///< read by relaxed loads: an acquire fence joins it
    View released;   ///< at the last release fence: relaxed stores carry it
  };
  struct Plain {
    std::size_t writer = 0;
    std::uint32_t written = 0;                     ///< at which step of the writer
    std::array<std::uint32_t, max_threads> read{}; ///< at which step of each thread
  };

  std::vector<Location> locations_;
  std::vector<Plain> plains_;
  std::array<Thread, max_threads> threads_;
  std::size_t spawned_ = 0;
  std::string fault_;
};

} // namespace nendo::explorer
