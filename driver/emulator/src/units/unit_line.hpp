#pragma once
// The serial line from a unit to its host, which takes 10 bits of time for each byte. It holds
// messages until their last byte has passed.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "units/emulated_unit.hpp"
#include "units/unit_message.hpp"

namespace nendo::emulator::unit {

class UnitLine {
public:
  using Time = EmulatedUnit::Time;

  struct Passed {
    Time at{}; ///< when the last byte passed
    Message bytes;
    bool is_record = false;
  };

  explicit UnitLine(unsigned baud) noexcept : baud_(baud) {}

  unsigned baud() const noexcept { return baud_; }
  /// Returns whether a message that is put now passes at once. Never while the line is paused.
  bool is_free(Time now) const noexcept { return !paused_ && free_at_ <= now; }
  /// Puts a message behind those that wait. Returns false, and puts nothing, if too many bytes
  /// wait.
  bool put(Message bytes, bool is_record, Time now) {
    if (waiting_bytes_ + bytes.size() > EmulatedUnit::output_capacity) return false;
    if (free_at_ < now) free_at_ = now;
    free_at_ += Time(static_cast<Time::rep>(bytes.size() * std::uint64_t{10'000'000'000} / baud_));
    waiting_bytes_ += bytes.size();
    waiting_.push_back({free_at_, std::move(bytes), is_record});
    return true;
  }
  /// Returns when the next message will have passed; nothing if none does.
  std::optional<Time> next_due() const noexcept {
    if (paused_ || waiting_.empty()) return std::nullopt;
    return waiting_.front().at;
  }
  /// Returns the next message that has passed, once.
  std::optional<Passed> take(Time now) {
    const auto due = next_due();
    if (!due || *due > now) return std::nullopt;
    Passed passed = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= passed.bytes.size();
    return passed;
  }
  /// Stops the line, or continues: XOFF and XON.
  void pause(bool paused) noexcept { paused_ = paused; }
  /// Forgets what waits, as when the unit restarts.
  void clear() noexcept {
    waiting_.clear();
    waiting_bytes_ = 0;
    free_at_ = {};
    paused_ = false;
  }

private:
  unsigned baud_;
  std::deque<Passed> waiting_;
  std::size_t waiting_bytes_ = 0;
  Time free_at_{};
  bool paused_ = false;
};

} // namespace nendo::emulator::unit
