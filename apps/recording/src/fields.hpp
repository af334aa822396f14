#pragma once
// Writes and reads values in the format of a recording (FORMAT.md). FieldWriter and FieldReader
// have the same functions, so that one template describes the bytes for both. Enumerators are
// written as their numbers, so new ones must be added at the ends of their lists, here and in the
// document.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nendo/base/byte_reader.hpp>
#include <nendo/base/byte_writer.hpp>
#include <nendo/base/text.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/puppet/puppet.hpp>

namespace nendo::recording {

// Limits of readers. A recorder refuses a setup that exceeds them (check_readable()). The solver
// takes no greater numbers.
inline constexpr double min_number = 1e-100;
inline constexpr double max_number = 1e100;
inline constexpr double farthest_wrist_m = 1e6;
inline constexpr std::size_t max_text_bytes = std::size_t{1} << 20;

/// Returns whether a time is within 2^61 ns (73 years) of the clock's zero. Readers refuse other
/// times, so that differences of times never overflow.
constexpr bool is_usable_time(std::chrono::nanoseconds since_epoch) noexcept {
  constexpr std::chrono::nanoseconds max_time{std::int64_t{1} << 61U};
  return since_epoch > -max_time && since_epoch < max_time;
}

/// Added to a filter's kind where pinches are closed.
inline constexpr unsigned pinches_bit = 128;

/// Writes one value after another.
class FieldWriter {
public:
  static constexpr bool reads = false;
  explicit FieldWriter(ByteWriter& writer) : writer_(&writer) {}

  void number(double value, double /*min*/, double /*max*/) { writer_->f64_le(value); }
  void number(double value) { writer_->f64_le(value); }
  void u8(std::uint8_t value) { writer_->u8(value); }
  void u16(std::uint16_t value) { writer_->u16_le(value); }
  void u32(std::uint32_t value) { writer_->u32_le(value); }
  void u64(std::uint64_t value) { writer_->u64_le(value); }
  template <class Integer>
  void whole(Integer value, std::uint32_t /*min*/, std::uint32_t /*max*/) {
    writer_->u32_le(static_cast<std::uint32_t>(value));
  }
  void size(std::uint64_t value, std::uint64_t /*max*/) { writer_->u64_le(value); }
  void flag(bool value) { writer_->u8(static_cast<std::uint8_t>(value)); }
  template <class Enum>
  void one_of(Enum value, Enum /*last*/) {
    writer_->u8(static_cast<std::uint8_t>(value));
  }
  void constant(std::uint8_t value) { writer_->u8(value); }
  void flag_constant(std::uint8_t off, std::uint8_t on, bool flag) { writer_->u8(flag ? on : off); }
  void reserved() { writer_->u16_le(0); }
  void bits(std::uint32_t value, std::size_t /*count*/) { writer_->u32_le(value); }
  void text(std::string_view value) { writer_->text(value); }
  void line(std::string_view value) { writer_->text(value); }
  void long_text(std::string_view value) {
    writer_->u32_le(static_cast<std::uint32_t>(value.size()));
    writer_->bytes(std::as_bytes(std::span(value)));
  }
  template <class Time>
  void time(Time value) {
    time_span(value.time_since_epoch());
  }
  void time_span(std::chrono::nanoseconds value) { writer_->i64_le(value.count()); }
  void signal(const puppet::HandSignal& value) {
    one_of(value.side(), Side::right);
    u8(value.number());
  }
  /// Returns `count`; a reader returns the count that it reads, or 0 after an unusable value.
  std::size_t count(std::size_t count, std::size_t /*max*/) {
    writer_->u16_le(static_cast<std::uint16_t>(count));
    return count;
  }
  template <class List, class Visit>
  void list(const List& values, std::size_t max, const Visit& visit) {
    count(values.size(), max);
    for (const auto& value : values)
      visit(value);
  }
  template <class T, class Visit>
  void optional(const std::optional<T>& value, const Visit& visit) {
    flag(value.has_value());
    if (value) visit(*value);
  }
  void counts(const std::optional<CountScale>& value) {
    flag(value.has_value());
    writer_->u16_le(value ? value->max_count : 0);
    flag(value && value->self_calibrated);
  }
  /// Writes the kind, and the bit `more` if it is set. Returns whether it is; a reader returns
  /// whether it reads the bit.
  bool filter_kind(const hand::FilterOptions& filter, unsigned more = 0, bool is_set = false) {
    writer_->u8(static_cast<std::uint8_t>(static_cast<unsigned>(filter.kind) |
                                          (is_set ? more : 0U) |
                                          (filter.close_pinches ? pinches_bit : 0U)));
    return is_set;
  }
  /// Returns whether the optional end of a chunk follows, which has no flag.
  bool has_end(bool is_needed) { return is_needed; }
  void require(bool /*fine*/) {}

private:
  ByteWriter* writer_;
};

/// Reads what FieldWriter writes, and remembers whether all values were usable.
class FieldReader {
public:
  static constexpr bool reads = true;
  explicit FieldReader(ByteReader& reader) : reader_(&reader) {}

  void number(double& value, double min, double max) {
    value = reader_->f64_le();
    require(value >= min && value <= max);
  }
  void number(double& value) { value = reader_->f64_le(); }
  void u8(std::uint8_t& value) { value = reader_->u8(); }
  void u16(std::uint16_t& value) { value = reader_->u16_le(); }
  void u32(std::uint32_t& value) { value = reader_->u32_le(); }
  void u64(std::uint64_t& value) { value = reader_->u64_le(); }
  template <class Integer>
  void whole(Integer& value, std::uint32_t min, std::uint32_t max) {
    const std::uint32_t read = reader_->u32_le();
    require(read >= min && read <= max);
    value = static_cast<Integer>(read);
  }
  void size(std::uint64_t& value, std::uint64_t max) {
    value = reader_->u64_le();
    require(value <= max);
  }
  void flag(bool& value) { value = reader_->u8() != 0; }
  template <class Enum>
  void one_of(Enum& value, Enum last) {
    const unsigned read = reader_->u8();
    require(read <= static_cast<unsigned>(last));
    value = static_cast<Enum>(read);
  }
  void constant(std::uint8_t value) { require(reader_->u8() == value); }
  void flag_constant(std::uint8_t off, std::uint8_t on, bool& flag) {
    const std::uint8_t read = reader_->u8();
    require(read == off || read == on);
    flag = read == on;
  }
  void reserved() { reader_->u16_le(); }
  void bits(std::uint32_t& value, std::size_t count) {
    value = reader_->u32_le();
    require(value >> count == 0);
  }
  void text(std::string& value) { value = reader_->text(); }
  void line(std::string& value) { value = printable(reader_->text()); }
  void long_text(std::string& value) {
    const std::uint32_t size = reader_->u32_le();
    require(size > 0 && size <= max_text_bytes && size <= reader_->remaining());
    if (!fine_) return;
    const auto text = reader_->take(size);
    value.assign(reinterpret_cast<const char*>(text.data()), text.size());
  }
  template <class Time>
  void time(Time& value) {
    std::chrono::nanoseconds since_epoch{};
    time_span(since_epoch);
    value = Time(since_epoch);
  }
  void time_span(std::chrono::nanoseconds& value) {
    value = std::chrono::nanoseconds(reader_->i64_le());
    require(is_usable_time(value));
  }
  void signal(puppet::HandSignal& value) {
    Side side{};
    one_of(side, Side::right);
    const auto read = puppet::HandSignal::numbered(side, reader_->u8());
    require(read.has_value());
    value = read.value_or(puppet::HandSignal{});
  }
  std::size_t count(std::size_t /*count*/, std::size_t max) {
    const std::size_t read = reader_->u16_le();
    require(read <= max);
    return fine_ ? read : 0;
  }
  template <class List, class Visit>
  void list(List& values, std::size_t max, const Visit& visit) {
    values.resize(count(0, max));
    for (auto& value : values)
      visit(value);
  }
  template <class T, class Visit>
  void optional(std::optional<T>& value, const Visit& visit) {
    if (reader_->u8() != 0) visit(value.emplace());
  }
  void counts(std::optional<CountScale>& value) {
    const bool has_value = reader_->u8() != 0;
    const CountScale read{reader_->u16_le(), reader_->u8() != 0};
    if (has_value) value = read;
  }
  bool filter_kind(hand::FilterOptions& filter, unsigned more = 0, bool /*is_set*/ = false) {
    const unsigned value = reader_->u8();
    filter.close_pinches = (value & pinches_bit) != 0;
    const unsigned kind = value & ~(pinches_bit | more);
    require(kind <= static_cast<unsigned>(hand::FilterKind::one_euro));
    filter.kind = static_cast<hand::FilterKind>(kind);
    return (value & more) != 0;
  }
  bool has_end(bool /*is_needed*/) { return reader_->remaining() > 0; }
  void require(bool fine) { fine_ = fine_ && fine; }
  bool fine() const { return fine_ && !reader_->overrun(); }

private:
  ByteReader* reader_;
  bool fine_ = true;
};

/// Calls describe(fields, value) to read a payload. Returns nothing if it is not usable.
template <class Value>
std::optional<Value> read_value(std::span<const std::byte> payload, const auto& describe) {
  ByteReader reader(payload);
  FieldReader fields(reader);
  Value value{};
  describe(fields, value);
  if (!fields.fine()) return std::nullopt;
  return value;
}

} // namespace nendo::recording
