#pragma once
// What the loop took, in the order in which it took it: samples, commands, and the ticks that
// closed over them. Whoever gives the same to another loop of the same options gets the same shape,
// bit for bit.

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
  std::uint8_t hand = 0; ///< of the loop's hands, by their order
  GloveSample sample;
};

/// All that stands before it on the input log, up to the tick before, is what this tick took.
struct LoggedTick {
  std::uint64_t number = 0; ///< Pacer::Due::number
  HostTime scheduled{};
  HostTime woke{};
  std::uint64_t lost = 0; ///< entries that had found the input log full until then
};

using InputLogEntry = std::variant<TakenSample, Command, LoggedTick>;

/// From the loop to a recorder, through a ring; a full one refuses what comes, and the next tick
/// that finds room tells how much that was. The loop's side is wait-free.
class InputLog {
public:
  /// Allocates once, 128 bytes an entry. Two gloves and a loop at 90 Hz make 270 entries a second.
  explicit InputLog(std::size_t at_least = std::size_t{1} << 14) : ring_(at_least) {}

  void sample(std::uint8_t hand, const GloveSample& sample) noexcept {
    ring_.try_push(TakenSample{hand, sample});
  }
  void command(const Command& command) noexcept { ring_.try_push(command); }
  void tick(std::uint64_t number, HostTime scheduled, HostTime woke) noexcept {
    ring_.try_push(LoggedTick{number, scheduled, woke, ring_.counters().refused});
  }

  /// The recorder's thread only, wait-free: hands every entry that is there to `sink`, in order.
  template <class Sink>
  std::size_t drain(Sink&& sink) noexcept {
    return ring_.drain(std::forward<Sink>(sink));
  }
  /// Any thread.
  std::uint64_t lost() const noexcept { return ring_.counters().refused; }

private:
  SpscRing<InputLogEntry> ring_;
};

} // namespace nendo::flow
