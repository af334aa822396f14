#pragma once
// Input that was recorded, played to a loop once more, at its own times and together with live
// hands. The loop takes it at the beginning of a tick, as it takes samples out of a ring.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/command.hpp>

namespace nendo::flow {

// The input log has the loop's input in the order in which the loop took it: samples, commands, and
// after them the tick that used them. Another loop of the same options makes the same shape of the
// same input, bit for bit.

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

/// The inputs that a loop may have: the hands and the layers over them.
inline constexpr std::size_t max_inputs = 16;

class NENDO_API InputScript {
public:
  /// Something that the loop took: a TakenSample or a Command, never a tick.
  struct Event {
    HostClock::duration at{}; ///< since the first tick: when the tick was due that took it
    InputLogEntry entry;
  };
  /// Where it begins again, and at what time it then continues.
  struct Round {
    HostClock::duration from{};
    HostClock::duration to{}; ///< later than `from` by shortest_round at least
  };
  static constexpr HostClock::duration shortest_round = std::chrono::milliseconds(200);
  /// What is later by so little is of the same tick: two grids round in different ways.
  static constexpr HostClock::duration rounding = std::chrono::microseconds(1);

  /// `events` in the order in which they were taken; `first_tick` is when the first tick was due by
  /// the clock of the samples. `length` is when the last one was, since then.
  InputScript(std::vector<Event> events, HostTime first_tick, HostClock::duration length)
      : events_(std::move(events)), first_tick_(first_tick), length_(length) {}

  // Before the loop begins:

  /// Adds an event before those of the same time.
  void add(HostClock::duration at, const Command& command);
  void repeat(const Round& round) { round_ = round; }
  /// Moves the times of all samples so that the first tick is due at `begin`.
  void begin_at(HostTime begin) noexcept { shift_ = begin - first_tick_; }
  /// Returns the sample with its times moved the same way, for HandInput::first.
  GloveSample moved(GloveSample sample) const noexcept;

  HostClock::duration length() const noexcept { return length_; }
  const std::optional<Round>& round() const noexcept { return round_; }

  // Loop's thread, wait-free:

  /// Hands all events to `take` that are due when the loop's tick is so much later than its first
  /// one: commands first, as from a loop's rings. Where a round ends, the next one begins in the
  /// next tick.
  template <class Take>
  void play(HostClock::duration now, Take&& take) noexcept {
    const HostClock::duration place = now - offset_ + rounding;
    const bool wraps = round_ && place >= round_->to;
    const HostClock::duration end = wraps ? round_->to : place + HostClock::duration(1);
    const std::size_t first = next_;
    for (; next_ < events_.size() && events_[next_].at < end; ++next_)
      if (const auto* command = std::get_if<Command>(&events_[next_].entry)) give(*command, take);
    for (std::size_t at = first; at < next_; ++at)
      if (const auto* taken = std::get_if<TakenSample>(&events_[at].entry))
        take(InputLogEntry(now_played(*taken, events_[at].at)));
    if (wraps) begin_again();
    if (!round_ && next_ == events_.size() && now >= length_)
      ended_.store(true, std::memory_order_release);
  }

  /// Returns whether all of it has been played. Never, if it repeats. Thread-safe.
  bool has_ended() const noexcept { return ended_.load(std::memory_order_acquire); }
  /// The commands that a loop does not execute itself: changes of settings and puppets, and
  /// Subdivide. The code that runs the loop takes them from here, and reports how many were refused
  /// (counters()). Asking thread.
  CommandRing& for_others() noexcept { return for_others_; }

private:
  template <class Take>
  void give(const Command& command, Take& take) noexcept {
    if (is_for_loop(command))
      take(InputLogEntry(command));
    else
      for_others_.try_push(command); // the ring counts what it refuses
  }
  TakenSample now_played(TakenSample taken, HostClock::duration at) noexcept;
  void begin_again() noexcept;

  /// Of one input.
  struct Stream {
    GloveSample last{}; ///< as it was given
    GloveSample held{}; ///< the last one of the round before, from which the next one departs
    std::uint64_t recorded = 0; ///< the sequence number of the last one in the recording
    bool begun = false;
    bool departs = false; ///< it has a `held`
  };

  std::vector<Event> events_;
  HostTime first_tick_;
  HostClock::duration length_;
  std::optional<Round> round_;
  HostClock::duration shift_{};
  HostClock::duration offset_{}; ///< from the script's time to that of the loop
  std::size_t next_ = 0;
  std::array<Stream, max_inputs> streams_{};
  std::atomic<bool> ended_{false};
  CommandRing for_others_{256};
};

} // namespace nendo::flow
