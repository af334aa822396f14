#pragma once
// A device from its own side, without any I/O or clock: bytes from the host and the time go in,
// bytes to the host come out. Whoever has a terminal (PtyEmulator) or a test moves them.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

namespace nendo::driver {

struct UnitCounters {
  std::uint64_t records = 0;       ///< put into the output
  std::uint64_t bytes_refused = 0; ///< of records and replies for which the output had no room
};

class EmulatedUnit {
public:
  using Time = std::chrono::nanoseconds; ///< since the unit was switched on; never goes back

  static constexpr std::size_t output_capacity = 1024;

  EmulatedUnit() = default;
  EmulatedUnit(const EmulatedUnit&) = delete;
  EmulatedUnit& operator=(const EmulatedUnit&) = delete;
  virtual ~EmulatedUnit() = default;

  /// Obeys the bytes that arrive at `now`, one after another. Any bytes are allowed.
  virtual void receive(std::span<const std::byte> bytes, Time now) = 0;
  /// Does what is due at `now`, e.g. the records of a stream.
  virtual void advance(Time now) = 0;
  /// When advance() will have something to do; empty if only the host can cause it.
  virtual std::optional<Time> next_due() const noexcept = 0;

  /// What waits for the host, at most output_capacity bytes.
  std::span<const std::byte> output() const noexcept { return {output_.data(), output_size_}; }
  /// The host has taken the first `count` bytes of output().
  void take(std::size_t count) noexcept {
    count = std::min(count, output_size_);
    output_size_ -= count;
    std::memmove(output_.data(), output_.data() + count, output_size_);
  }

  UnitCounters counters() const noexcept { return counters_; }

protected:
  /// False: the message does not fit and is refused whole.
  bool send(std::span<const std::byte> message) noexcept {
    if (message.size() > output_capacity - output_size_) {
      counters_.bytes_refused += message.size();
      return false;
    }
    std::copy(message.begin(), message.end(), output_.data() + output_size_);
    output_size_ += message.size();
    return true;
  }

  UnitCounters counters_;

private:
  std::array<std::byte, output_capacity> output_{};
  std::size_t output_size_ = 0;
};

} // namespace nendo::driver
