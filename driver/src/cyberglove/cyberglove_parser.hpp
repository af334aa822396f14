#pragma once
// Splits the CyberGlove's byte stream into records. It is pure (no I/O, clock, log or allocation),
// and bytes are not trusted. Framing finds where a record ends; decoding judges what stands there.
//
// Plain records end in NUL, which occurs nowhere else in them (but see decode_record). So damage
// costs at most the record that it is in and the next one. High-resolution records contain many
// NULs and are found by their whole layout, wherever it begins.
//
// The protocol has no checksum. With the status byte on, one gap in a stream, or one run of extra
// bytes without NUL, yields no record with a value in the wrong place. A lost byte and an extra
// byte in the same record do, and that cannot be seen.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "cyberglove/cyberglove_protocol.hpp"
#include "stream/findings.hpp"
#include "stream/stream_counters.hpp"

namespace nendo::driver::cyberglove {

enum class RecordForm : std::uint8_t { plain, hi_res };

/// The parts that a record is expected to have. `values` is 1 to max_values, and 22 in the hi_res
/// form, which has neither time stamp nor status.
struct RecordShape {
  std::size_t values = 22;
  bool time_stamp = false;
  bool status = false;
  RecordForm form = RecordForm::plain;

  /// Returns the length with header and NUL, without error pairs.
  constexpr std::size_t bytes() const noexcept {
    if (form == RecordForm::hi_res) return hi_res_bytes;
    return 1 + values + (time_stamp ? time_stamp_bytes : 0U) + (status ? 1U : 0U) + 1;
  }
};

/// How Record::ticks relates to earlier ones. The parser says `continues` wherever there is a time
/// stamp; a check that compares records may correct it.
enum class Stamp : std::uint8_t { none, begins, continues };

struct Record {
  std::array<std::uint16_t, max_values>
      values{};            ///< the first RecordShape::values are set, none of them 0
  std::uint32_t ticks = 0; ///< 1/115200 s, wraps after 10.36 h; if the shape has a time stamp
  std::uint8_t status = 0; ///< see cyberglove_protocol.hpp; 0 if the shape has none
  Stamp stamp = Stamp::none;
  bool sampled_too_fast = false; ///< the glove could not keep its period; the values are good
  bool no_glove = false;         ///< the values mean nothing; counted, never delivered
  /// Of the hi_res form only: the time since midnight by the glove's own clock. A frame counts 1/30
  /// s. No source says what a sub-frame is, so each counts a tenth of a frame. The order is right
  /// in any case, but the time only to within a frame, so it is not for a DeviceClock.
  std::chrono::nanoseconds time_of_day{};
  std::uint32_t second = 0;   ///< of the hi_res form: since midnight
  std::uint8_t frame = 0;     ///< of the hi_res form: within the second, 0 to 30
  std::uint8_t sub_frame = 0; ///< of the hi_res form: 0 to 9
  /// Of the hi_res form: sensors that sent 0, which a sensor sends that has failed. Their values
  /// are
  /// 1. If all have, no_glove is set.
  unsigned clamped = 0;
};

/// Decodes one frame, which includes its NUL. Returns nothing if length, header or content are
/// wrong. The only other byte that may be NUL is the time stamp's first one: sources disagree on
/// whether bit 7 is set there.
std::optional<Record> decode_record(std::span<const std::byte> frame,
                                    const RecordShape& shape) noexcept;

/// The judgement on a well-formed record.
struct Verdict {
  bool plausible = true;
  std::uint64_t missed = 0; ///< records known to have been lost since the last plausible one
};

class Parser {
public:
  explicit Parser(const RecordShape& shape) noexcept : shape_(shape) {}

  /// Takes the next bytes of the stream, cut anywhere. Each well-formed record is given to
  /// `check(Record&) -> Verdict` and, if that finds it plausible, to `sink(const Record&)`. The
  /// sink is also told of each BadRecord and Unplugged (findings.hpp).
  template <class Check, class Sink>
  void push(std::span<const std::byte> chunk, Check&& check, Sink&& sink) {
    for (const std::byte byte : chunk) {
      auto record = push_byte(byte);
      for (; bad_ > 0; --bad_)
        report(sink, BadRecord{});
      if (!record) continue;
      if (record->no_glove) {
        count_unplugged();
        report(sink, Unplugged{});
      } else if (settle(*record, check(*record))) {
        sink(*record);
      } else {
        report(sink, BadRecord{});
      }
    }
  }
  /// Does the same without a check.
  template <class Sink>
  void push(std::span<const std::byte> chunk, Sink&& sink) {
    push(chunk, [](Record&) { return Verdict{}; }, sink);
  }

  /// Gives up the unfinished record and continues with records of another shape.
  void reset(const RecordShape& shape) noexcept;
  /// See StreamCounters::count_discarded.
  void count_discarded(std::uint64_t bytes) noexcept { counters_.count_discarded(bytes); }

  const StreamCounters& counters() const noexcept { return counters_; }
  /// Returns the bytes of the unfinished record, always less than max_record_bytes.
  std::size_t pending() const noexcept { return held_; }

private:
  std::optional<Record> push_byte(std::byte byte) noexcept;
  std::optional<Record> extend_plain() noexcept;
  std::optional<Record> end_plain() noexcept;
  std::optional<Record> extend_hi_res() noexcept;
  void look_for_tail(std::byte byte) noexcept;
  bool settle(const Record& record, const Verdict& verdict) noexcept;
  void count_unplugged() noexcept;
  bool may_be_stamp() const noexcept;
  void count_bad() noexcept { ++counters_.bad_records, ++bad_; }
  void drop_bad_frame() noexcept;
  void discard(std::size_t count) noexcept;

  RecordShape shape_;
  std::array<std::byte, max_record_bytes> frame_{};
  std::size_t held_ = 0;
  bool overlong_ = false;       ///< plain: the frame outgrew every record; skip to its NUL
  bool nul_in_stamp_ = false;   ///< plain: the frame holds a NUL where a time stamp may have one
  std::uint8_t tail_ = 0;       ///< hi_res: how much of CR LF NUL was just seen
  bool damage_counted_ = false; ///< hi_res: the record that the next tail ends is counted already
  unsigned bad_ = 0;            ///< found by the last byte, not yet told
  StreamCounters counters_;
};

} // namespace nendo::driver::cyberglove
