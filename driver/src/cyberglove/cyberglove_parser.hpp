#pragma once
// Splits the CyberGlove's byte stream into records. It is pure (no I/O, clock, log or allocation),
// and bytes are not trusted. Framing finds the end of a record; decoding checks its content.
//
// Plain records end in NUL, which occurs nowhere else in them (but see decode_record). So damage
// costs at most the record that it is in and the next one. High-resolution records contain many
// NULs and are found by their whole layout, wherever it begins.
//
// The protocol has no checksum. With the status byte on, one gap in a stream, or one run of extra
// bytes without NUL, yields no record with a value at a wrong index. A lost byte and an extra
// byte in the same record do, and that cannot be seen.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "cyberglove/cyberglove_protocol.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::cyberglove {

enum class RecordForm : std::uint8_t { plain, hi_res };

/// The expected fields of a record. `values` is 1 to max_values, and 22 in the hi_res
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
  // Of the hi_res form only. No source says what a sub-frame is, so the time is exact only to
  // within a frame, and not for a DeviceClock.
  std::uint32_t second = 0;   ///< second since midnight by the glove's own clock
  std::uint8_t frame = 0;     ///< number within the second, 0 to 30
  std::uint8_t sub_frame = 0; ///< 0 to 9
  /// Failed sensors: those that sent 0. Their values are 1. If all have failed, no_glove is set.
  unsigned clamped = 0;
};

/// Decodes one frame, which includes its NUL. Returns nothing if length, header or content are
/// wrong. The only other byte that may be NUL is the time stamp's first one: sources disagree on
/// whether bit 7 is set there.
std::optional<Record> decode_record(std::span<const std::byte> frame,
                                    const RecordShape& shape) noexcept;

/// Maps each value of a record to its sensor slot. The map is computed from the masks that the
/// glove reports, and not from a table for gloves of 18 or 22 sensors, because the program that
/// used the glove last may have changed its masks.
struct ChannelMap {
  std::array<std::uint8_t, max_values> slot{}; ///< the slot of value k
  std::size_t count = 0;                       ///< values in a record

  constexpr SensorMask sensors() const noexcept {
    SensorMask mask;
    for (std::size_t k = 0; k < count; ++k)
      mask.bits |= 1U << slot[k];
    return mask;
  }
  friend constexpr bool operator==(const ChannelMap&, const ChannelMap&) = default;
};

/// Returns the map of the first `max_count` sensors that are both built in and wanted.
constexpr ChannelMap make_channel_map(SensorMask hardware, SensorMask software,
                                      std::size_t max_count) noexcept {
  ChannelMap map;
  for (std::uint8_t slot = 0; slot < sensor_slots && map.count < max_count; ++slot) {
    if (((hardware.bits & software.bits) >> slot & 1U) != 0) map.slot[map.count++] = slot;
  }
  return map;
}

/// High-resolution records do not depend on masks. They always carry the 22 values of the full
/// glove.
inline constexpr ChannelMap hi_res_channels =
    make_channel_map(sensors_22, sensors_22, hi_res_values);

/// The result of checking a well-formed record.
struct Verdict {
  bool plausible = true;
  std::uint64_t missed = 0; ///< records known to have been lost since the last plausible one
};

class Parser : public StreamParser<Parser> {
public:
  explicit Parser(const RecordShape& shape) noexcept : shape_(shape) {}

  /// Takes the next bytes of the stream, cut anywhere. Each well-formed record is passed to
  /// `check(Record&) -> Verdict` and, if plausible, to `sink(const Record&)`. The sink also
  /// receives each BadRecord and Unplugged.
  template <class Check, class Sink>
  void push(std::span<const std::byte> chunk, Check&& check, Sink&& sink) {
    for (const std::byte byte : chunk) {
      ++counters_.bytes;
      auto record = push_byte(byte);
      report_bad(sink);
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

private:
  std::optional<Record> push_byte(std::byte byte) noexcept;
  std::optional<Record> extend_plain() noexcept;
  std::optional<Record> end_plain() noexcept;
  std::optional<Record> extend_hi_res() noexcept;
  void look_for_tail(std::byte byte) noexcept;
  bool settle(const Record& record, const Verdict& verdict) noexcept;
  void count_unplugged() noexcept;
  bool may_be_stamp() const noexcept;
  void drop_bad_frame() noexcept;
  void discard(std::size_t count) noexcept;

  RecordShape shape_;
  std::array<std::byte, max_record_bytes> frame_{};
  bool overlong_ = false;       ///< plain: the frame outgrew every record; skip to its NUL
  bool nul_in_stamp_ = false;   ///< plain: the frame holds a NUL where a time stamp may have one
  std::uint8_t tail_ = 0;       ///< hi_res: bytes of CR LF NUL just seen
  bool damage_counted_ = false; ///< hi_res: the record that the next tail ends is counted already
};

} // namespace nendo::driver::cyberglove
