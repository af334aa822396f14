#pragma once
// The loop's input in the order in which the loop took it: samples, commands, and after them the
// tick that used them. Another loop of the same options makes the same shape of the same input, bit
// for bit.

#include <cstddef>
#include <cstdint>
#include <utility>
#include <variant>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/command.hpp>

namespace nendo::flow {

struct TakenSample {
  std::uint8_t hand = 0; ///< the index of the loop's input
  GloveSample sample;
};

/// A tick. The entries between the previous tick and this one are the input of this tick.
struct LoggedTick {
  std::uint64_t number = 0; ///< Pacer::Due::number
  HostTime scheduled{};
  HostTime woke{};
  std::uint64_t lost = 0; ///< entries that had found the input log full until then
};

using InputLogEntry = std::variant<TakenSample, Command, LoggedTick>;

/// Hands the loop's input to a recorder through a ring. A full ring refuses entries, and the next
/// tick that is logged has their number. The loop's side is wait-free.
class InputLog {
public:
  /// Allocates once, 128 bytes for each entry. Two gloves and a loop at 90 Hz make 270 entries a
  /// second.
  explicit InputLog(std::size_t min_entries = std::size_t{1} << 14) : ring_(min_entries) {}

  void sample(std::uint8_t hand, const GloveSample& sample) noexcept {
    ring_.try_push(TakenSample{hand, sample}); // the ring counts what it refuses: lost()
  }
  void command(const Command& command) noexcept { ring_.try_push(command); }
  void tick(std::uint64_t number, HostTime scheduled, HostTime woke) noexcept {
    ring_.try_push(LoggedTick{number, scheduled, woke, ring_.counters().refused});
  }

  /// The recorder's thread only, wait-free. Hands all present entries to `sink`, in order.
  template <class Sink>
  std::size_t drain(Sink&& sink) noexcept {
    return ring_.drain(std::forward<Sink>(sink));
  }
  /// Returns how many entries were refused so far. Thread-safe.
  std::uint64_t lost() const noexcept { return ring_.counters().refused; }

private:
  SpscRing<InputLogEntry> ring_;
};

} // namespace nendo::flow
