#pragma once
// Splits the byte stream of a 5DT Data Glove 5 into samples. It is pure (no I/O, clock, log or
// allocation), and bytes are not trusted. Nothing marks a sample's beginning for certain. So nine
// bytes are a sample if they begin with the header and their checksum fits; otherwise one byte is
// dropped.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "fivedt/fivedt_protocol.hpp"
#include "stream/findings.hpp"
#include "stream/stream_counters.hpp"

namespace nendo::driver::fivedt {

struct Record {
  std::array<std::uint8_t, fingers> flexion{}; ///< thumb to pinky, 0 straight to 255 bent
};

/// Decodes nine bytes. Returns nothing if header or checksum are wrong.
std::optional<Record> decode_record(std::span<const std::byte, sample_bytes> frame) noexcept;

class Parser {
public:
  /// Takes the next bytes of the stream, cut anywhere, and hands each whole sample to `sink(const
  /// Record&)`. A sample that is damaged counts once as bad, however many bytes are dropped before
  /// the next good one.
  template <class Sink>
  void push(std::span<const std::byte> chunk, Sink&& sink) {
    for (const std::byte byte : chunk) {
      const auto record = push_byte(byte);
      for (; bad_ > 0; --bad_)
        report(sink, BadRecord{});
      if (record) sink(*record);
    }
  }

  /// Drops the unfinished sample. The next byte may come from anywhere in a sample.
  void reset() noexcept;
  /// See StreamCounters::count_discarded.
  void count_discarded(std::uint64_t bytes) noexcept { counters_.count_discarded(bytes); }

  const StreamCounters& counters() const noexcept { return counters_; }
  /// Returns the bytes of the unfinished sample, always less than sample_bytes.
  std::size_t pending() const noexcept { return held_; }

private:
  std::optional<Record> push_byte(std::byte byte) noexcept;
  void drop_first() noexcept;
  void count_bad() noexcept { ++counters_.bad_records, ++bad_; }

  std::array<std::byte, sample_bytes> frame_{};
  std::size_t held_ = 0;
  bool in_step_ = false;  ///< the last sample was good, and no more than extra bytes came since
  std::size_t extra_ = 0; ///< bytes dropped since the last good sample, while in step
  unsigned bad_ = 0;      ///< found by the last byte, not yet told
  StreamCounters counters_;
};

} // namespace nendo::driver::fivedt
