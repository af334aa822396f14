#pragma once
// Replays recorded input to a loop at its original times, together with live hands. The loop takes
// it at the beginning of a tick, like the samples of a ring.

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
#include <nendo/driver/pose_sample.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/command.hpp>

namespace nendo::flow {

// The input log has the loop's input in the order in which the loop took it: samples and commands,
// followed by their tick. A loop with the same options and input makes the same shape, bit for bit.

struct TakenSample {
  std::uint8_t hand = 0; ///< the index of the loop's input
  GloveSample sample;
};

/// A pose that moves the wrist of a hand.
struct TakenPose {
  PoseSample pose;
  Side side = Side::right; ///< the hand's side on the stage
};

/// A tick. The entries between the previous tick and this one are the input of this tick.
struct LoggedTick {
  std::uint64_t number = 0; ///< Pacer::Due::number
  HostTime scheduled{};
  HostTime woke{};
  std::uint64_t lost = 0; ///< entries that the full input log has refused so far
};

using InputLogEntry = std::variant<TakenSample, Command, LoggedTick, TakenPose>;

/// Passes the loop's input to a recorder through a ring. A full ring refuses entries; the next
/// logged tick has their number. The loop's side is wait-free.
class InputLog {
public:
  /// Allocates once, 128 bytes for each entry. Two gloves and a loop at 90 Hz make 270 entries per
  /// second.
  explicit InputLog(std::size_t min_entries = std::size_t{1} << 14) : ring_(min_entries) {}

  void sample(std::uint8_t hand, const GloveSample& sample) noexcept {
    ring_.try_push(TakenSample{hand, sample}); // the ring counts what it refuses: lost()
  }
  void pose(Side side, const PoseSample& pose) noexcept { ring_.try_push(TakenPose{pose, side}); }
  void command(const Command& command) noexcept { ring_.try_push(command); }
  void tick(std::uint64_t number, HostTime scheduled, HostTime woke) noexcept {
    ring_.try_push(LoggedTick{number, scheduled, woke, ring_.counters().refused});
  }

  /// Passes all present entries to `sink`, in order. Recorder's thread only; wait-free.
  template <class Sink>
  std::size_t drain(Sink&& sink) noexcept {
    return ring_.drain(std::forward<Sink>(sink));
  }
  /// Returns the number of refused entries. Thread-safe.
  std::uint64_t lost() const noexcept { return ring_.counters().refused; }

private:
  SpscRing<InputLogEntry> ring_;
};

/// The inputs that a loop may have: the hands and the layers over them.
inline constexpr std::size_t max_inputs = 16;

class NENDO_API InputScript {
public:
  /// An input of the loop: a TakenSample, TakenPose or Command, never a tick.
  struct Event {
    HostClock::duration at{}; ///< the deadline of its tick, since the first tick
    InputLogEntry entry;
  };
  /// A repetition: at `to`, playback continues at `from`.
  struct Round {
    HostClock::duration from{};
    HostClock::duration to{}; ///< later than `from` by shortest_round at least
  };
  static constexpr HostClock::duration shortest_round = std::chrono::milliseconds(200);
  /// Events later by at most this time belong to the same tick, because grids round differently.
  static constexpr HostClock::duration rounding = std::chrono::microseconds(1);

  /// `events` are in the order in which the loop took them; `first_tick` is the first tick's
  /// deadline by the samples' clock, and `length` the time from there to the last tick's.
  InputScript(std::vector<Event> events, HostTime first_tick, HostClock::duration length)
      : events_(std::move(events)), first_tick_(first_tick), length_(length) {}

  // Before the loop begins:

  /// Adds an event before those of the same time.
  void add(HostClock::duration at, const Command& command);
  void repeat(const Round& round) { round_ = round; }
  /// Shifts the times of all samples so that the first tick is due at `begin`.
  void begin_at(HostTime begin) noexcept { shift_ = begin - first_tick_; }
  /// Returns the sample with its times shifted by begin_at(), for HandInput::first.
  GloveSample moved(GloveSample sample) const noexcept;

  HostClock::duration length() const noexcept { return length_; }
  const std::optional<Round>& round() const noexcept { return round_; }

  // Loop's thread, wait-free:

  /// Passes all events to `take` that are due at `now`, the tick's time since the first one:
  /// commands first, as from a loop's rings. After the end of a round, the next one begins in the
  /// next tick.
  template <class Take>
  void play(HostClock::duration now, Take&& take) noexcept {
    const HostClock::duration place = now - offset_ + rounding;
    const bool wraps = round_ && place >= round_->to;
    const HostClock::duration end = wraps ? round_->to : place + HostClock::duration(1);
    const std::size_t first = next_;
    for (; next_ < events_.size() && events_[next_].at < end; ++next_)
      if (const auto* command = std::get_if<Command>(&events_[next_].entry)) give(*command, take);
    for (std::size_t at = first; at < next_; ++at) {
      if (const auto* pose = std::get_if<TakenPose>(&events_[at].entry))
        take(InputLogEntry(now_played(*pose)));
      if (const auto* taken = std::get_if<TakenSample>(&events_[at].entry))
        take(InputLogEntry(now_played(*taken, events_[at].at)));
    }
    if (wraps) begin_again();
    if (!round_ && next_ == events_.size() && now >= length_)
      ended_.store(true, std::memory_order_release);
  }

  /// Returns whether all events have been played; never true with repeat(). Thread-safe.
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
  TakenPose now_played(TakenPose taken) const noexcept;
  void begin_again() noexcept;

  /// The state of one input.
  struct Stream {
    GloveSample last{};         ///< the last sample, with its original values
    GloveSample held{};         ///< the last sample of the previous round
    std::uint64_t recorded = 0; ///< the last sample's sequence number in the recording
    bool begun = false;
    bool departs = false; ///< `held` is set
  };

  std::vector<Event> events_;
  HostTime first_tick_;
  HostClock::duration length_;
  std::optional<Round> round_;
  HostClock::duration shift_{};
  HostClock::duration offset_{}; ///< the loop's time minus the script's time
  std::size_t next_ = 0;
  std::array<Stream, max_inputs> streams_{};
  std::atomic<bool> ended_{false};
  CommandRing for_others_{256};
};

} // namespace nendo::flow
