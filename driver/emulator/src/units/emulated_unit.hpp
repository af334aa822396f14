#pragma once
// A device from its own side, without any I/O or clock. Bytes from the host and the time go in, and
// bytes to the host come out. The owner of a terminal (PtyEmulator), or a test, moves them.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include <nendo/driver/sample.hpp>

namespace nendo::emulator {

/// An event at the unit that the host did not cause.
struct Incident {
  enum class Kind : std::uint8_t {
    glove_out,
    glove_in,
    power_cycle,
    switch_on,
    switch_off,
    sensor_stuck,
    sensor_free,
    tracker_error
  };
  Kind kind = Kind::glove_out;
  unsigned sensors = 0; ///< glove_in: of another glove; 0: as before
  std::optional<Side> side = std::nullopt;
  Sensor sensor = Sensor::unused;                    ///< that is stuck, or free again
  std::optional<std::uint16_t> count = std::nullopt; ///< at most 255; nothing: its own count
  char letter = ' ';                                 ///< tracker_error: as its records have it
  unsigned station = 0;                              ///< tracker_error: of this one; 0: of all
};

/// A whole record or reply in the output.
struct UnitMessage {
  std::size_t bytes = 0;
  bool record = false;
};

struct UnitCounters {
  std::uint64_t records = 0; ///< put into the output
  std::uint64_t bytes_refused =
      0; ///< bytes of records and replies that did not fit into the output
};

class EmulatedUnit {
public:
  using Time = std::chrono::nanoseconds; ///< since the unit was switched on; never goes back

  static constexpr std::size_t output_capacity = 4096;

  EmulatedUnit() = default;
  EmulatedUnit(const EmulatedUnit&) = delete;
  EmulatedUnit& operator=(const EmulatedUnit&) = delete;
  virtual ~EmulatedUnit() = default;

  /// Handles the bytes that arrive at `now`, one after another. Any bytes are allowed.
  virtual void receive(std::span<const std::byte> bytes, Time now) = 0;
  /// Does what is due at `now`, e.g. the records of a stream.
  virtual void advance(Time now) = 0;
  /// Returns when advance() will have something to do; nothing if only the host can cause that.
  virtual std::optional<Time> next_due() const noexcept = 0;
  /// Lets an incident happen. A unit ignores those that its kind does not have.
  virtual void inject(const Incident& incident, Time now) { (void)incident, (void)now; }
  /// Returns the rate of its serial line; 0: it understands hosts of any rate.
  virtual unsigned baud() const noexcept { return 0; }

  /// Returns the bytes that wait for the host, at most output_capacity.
  std::span<const std::byte> output() const noexcept { return {output_.data(), output_size_}; }
  /// Returns the messages of which output() consists. The first one may be cut.
  std::span<const UnitMessage> messages() const noexcept { return messages_; }
  /// Removes the first `count` bytes of output(), which the host has taken.
  void take(std::size_t count) noexcept {
    count = std::min(count, output_size_);
    output_size_ -= count;
    std::memmove(output_.data(), output_.data() + count, output_size_);
    auto message = messages_.begin();
    for (; message != messages_.end() && message->bytes <= count; ++message)
      count -= message->bytes;
    if (message != messages_.end()) message->bytes -= count;
    messages_.erase(messages_.begin(), message);
  }

  UnitCounters counters() const noexcept { return counters_; }

protected:
  /// Puts a message into the output. Returns false if it does not fit; the whole message is then
  /// refused.
  bool send(std::span<const std::byte> message) { return put(message, false); }
  /// Sends a record, and counts it.
  bool send_record(std::span<const std::byte> message) {
    const bool sent = put(message, true);
    if (sent) ++counters_.records;
    return sent;
  }

  /// Sends `make(due)` for each time from `next` on that is due at `now`, one every `period`. Once
  /// the output is full, the others that are due count as refused and are not made.
  template <class Make>
  void send_due(Time& next, Time period, Time now, Make&& make) {
    for (; next <= now; next += period) {
      const auto record = make(next);
      if (send_record(std::as_bytes(std::span(record)))) continue;
      const auto others = (now - next) / period;
      counters_.bytes_refused += record.size() * static_cast<std::uint64_t>(others);
      next += others * period;
    }
  }

  UnitCounters counters_;

private:
  bool put(std::span<const std::byte> message, bool record) {
    if (message.size() > output_capacity - output_size_) {
      counters_.bytes_refused += message.size();
      return false;
    }
    std::copy(message.begin(), message.end(), output_.data() + output_size_);
    output_size_ += message.size();
    messages_.push_back({message.size(), record});
    return true;
  }

  std::array<std::byte, output_capacity> output_{};
  std::size_t output_size_ = 0;
  std::vector<UnitMessage> messages_;
};

} // namespace nendo::emulator
