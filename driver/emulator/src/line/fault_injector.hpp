#pragma once
// Causes the faults between a unit and the terminal: it takes messages and gives bytes. It is pure
// and seeded, so the same messages and times give the same bytes. It causes the faults of the line
// itself, and reports when those of the unit and the terminal are due.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "line/fault.hpp"

namespace nendo::emulator {

class FaultInjector {
public:
  using Time = std::chrono::nanoseconds;
  using Wire = std::vector<std::byte>;

  /// A fault that begins, or is over.
  struct Event {
    Fault fault;
    bool over = false;
  };

  FaultInjector(const std::vector<Fault>& faults, std::uint32_t seed);

  /// Returns when next_event() will have something; nothing if it never will.
  std::optional<Time> next_due() const noexcept;
  /// Hands out each event once, in the order of their times, as soon as it is due.
  std::optional<Event> next_event(Time now);

  /// Appends to `wire` what the faults leave of a message that the unit sends at `now`.
  void pass(std::span<const std::byte> message, bool record, Time now, Wire& wire);
  /// Appends the bytes that a modem probe leaves behind: echoes, and the unit's error answers.
  void pass_junk(Wire& wire);

  /// Returns how many records passed, and how many of them do not arrive whole or arrive joined to
  /// other bytes.
  std::uint64_t records() const noexcept { return records_; }
  std::uint64_t records_faulted() const noexcept { return records_faulted_; }
  std::uint64_t done(FaultKind kind) const noexcept {
    return done_[static_cast<std::size_t>(kind)];
  }

private:
  struct Due {
    Time at{};
    Event event;
  };

  // The number of trials before the next success. So a random number is drawn for each fault and
  // not for each byte.
  struct Chance {
    double rate = 0.0;
    std::uint64_t misses = 0;
  };

  Chance& chance(FaultKind kind) noexcept { return chances_[static_cast<std::size_t>(kind)]; }
  std::uint64_t draw_misses(double rate);
  bool strikes(FaultKind kind);
  bool silent(Time now) const noexcept;
  std::byte random_byte() { return static_cast<std::byte>(random_() & 0xFFU); }
  void count(FaultKind kind) noexcept { ++done_[static_cast<std::size_t>(kind)]; }
  bool pass_noisy(std::span<const std::byte> message, Wire& wire);

  std::mt19937_64 random_;
  static constexpr std::size_t chance_kinds = 5;
  std::array<Chance, chance_kinds> chances_{};
  std::vector<Due> schedule_; ///< the next one last
  std::vector<Fault> silences_;
  bool joined_ = false; ///< what was passed last has no end of its own
  std::uint64_t records_ = 0;
  std::uint64_t records_faulted_ = 0;
  std::array<std::uint64_t, fault_kinds> done_{};
};

} // namespace nendo::emulator
