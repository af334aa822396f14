#pragma once
// Reads and writes the single chunks of a setup, which FORMAT.md describes. Enumerators are written
// as their numbers, so new ones must be added at the ends of their lists, here and in the document.

#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nendo/base/byte_reader.hpp>
#include <nendo/base/byte_writer.hpp>
#include <nendo/flow/setting.hpp>
#include <nendo/recording/sample_record.hpp>
#include <nendo/recording/setup.hpp>

namespace nendo::recording {

inline constexpr ChunkType head_chunk = chunk_type("HEAD");
inline constexpr ChunkType hand_chunk = chunk_type("HAND");
inline constexpr ChunkType loop_chunk = chunk_type("LOOP");
inline constexpr ChunkType rest_chunk = chunk_type("REST");
inline constexpr ChunkType origin_chunk = chunk_type("ORIG");
inline constexpr ChunkType puppet_chunk = chunk_type("PUPP");

constexpr bool is_setup_chunk(ChunkType type) noexcept {
  return type == head_chunk || type == hand_chunk || type == loop_chunk || type == rest_chunk ||
         type == origin_chunk || type == puppet_chunk || type == glove_chunk;
}

/// Writes which signal of which hand it is; read_signal() returns nothing if there is no such one.
void put_signal(ByteWriter& writer, const puppet::HandSignal& signal);
std::optional<puppet::HandSignal> read_signal(ByteReader& reader);

// Limits of readers. A recorder refuses a setup that exceeds them (check_readable()). The solver
// takes no greater numbers.
inline constexpr double min_number = 1e-100;
inline constexpr double max_number = 1e100;
inline constexpr double farthest_wrist_m = 1e6;
inline constexpr std::size_t max_text_bytes = std::size_t{1} << 20;

/// Added to a filter's kind where pinches are closed.
inline constexpr unsigned pinches_bit = 128;

/// Writes one value after another. FieldReader has the same functions, so that one template
/// describes the bytes for both.
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
  void reserved() { writer_->u16_le(0); }
  void text(std::string_view value) { writer_->text(value); }
  void long_text(std::string_view value) {
    writer_->u32_le(static_cast<std::uint32_t>(value.size()));
    writer_->bytes(std::as_bytes(std::span(value)));
  }
  void time(HostTime value) { put_time(*writer_, value); }
  void time_span(std::chrono::nanoseconds value) { writer_->i64_le(value.count()); }
  void signal(const puppet::HandSignal& value) { put_signal(*writer_, value); }
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
    writer_->u16_le(value ? value->most : 0);
    flag(value && value->whole_range);
  }
  /// Writes the kind and the bits `more`; a reader returns those of `more` that it reads.
  unsigned filter_kind(const hand::FilterOptions& filter, unsigned more) {
    writer_->u8(static_cast<std::uint8_t>(static_cast<unsigned>(filter.kind) | more |
                                          (filter.close_pinches ? pinches_bit : 0U)));
    return more;
  }
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
  void reserved() { reader_->u16_le(); }
  void text(std::string& value) { value = reader_->text(); }
  void long_text(std::string& value) {
    const std::uint32_t size = reader_->u32_le();
    require(size > 0 && size <= max_text_bytes && size <= reader_->remaining());
    if (!fine_) return;
    const auto text = reader_->take(size);
    value.assign(reinterpret_cast<const char*>(text.data()), text.size());
  }
  void time(HostTime& value) {
    value = read_time(*reader_);
    require(is_usable_time(value.time_since_epoch()));
  }
  void time_span(HostClock::duration& value) {
    const std::chrono::nanoseconds read(reader_->i64_le());
    require(read.count() >= 0 && is_usable_time(read));
    value = read;
  }
  void signal(puppet::HandSignal& value) {
    const auto read = read_signal(*reader_);
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
  unsigned filter_kind(hand::FilterOptions& filter, unsigned more) {
    const unsigned value = reader_->u8();
    filter.close_pinches = (value & pinches_bit) != 0;
    const unsigned kind = value & ~(pinches_bit | more);
    require(kind <= static_cast<unsigned>(hand::FilterKind::one_euro));
    filter.kind = static_cast<hand::FilterKind>(kind);
    return value & more;
  }
  void require(bool fine) { fine_ = fine_ && fine; }
  bool fine() const { return fine_ && !reader_->overrun(); }

private:
  ByteReader* reader_;
  bool fine_ = true;
};

void put_head(ByteWriter& writer, const Setup& setup);
void put_hand(ByteWriter& writer, std::uint8_t number, const flow::HandInput& hand);
void put_loop(ByteWriter& writer, const LoopSetup& loop);
void put_puppet(ByteWriter& writer, const LoopSetup& loop);
/// Writes some of the blocks of the shape at first. A chunk has at most max_blocks_of_chunk.
void put_rest(ByteWriter& writer, std::span<const deform::VertexBlock> blocks);
inline constexpr std::size_t max_blocks_of_chunk = std::size_t{1} << 14;

/// Of the origins, the first ones that only subdivide. LOOP has their number, and ORIG the others.
std::size_t plain_origins(const LoopSetup& loop) noexcept;
inline constexpr std::size_t max_plain_origins = 16;
/// Writes that of so many chunks of an origin. Each has at most max_operations_of_chunk of its
/// operations, or max_vertices_of_chunk of the vertices of the shape that it was made of.
void put_origin(ByteWriter& writer, const flow::ModelOrigin& origin, std::size_t chunk);
std::size_t origin_chunks(const flow::ModelOrigin& origin) noexcept;
inline constexpr std::size_t max_operations_of_chunk = std::size_t{1} << 20;
/// Of 24 bytes each: more would not go into a chunk.
inline constexpr std::size_t max_vertices_of_chunk = std::size_t{1} << 19;

inline constexpr std::size_t settings_bytes = 98;
/// Writes the body of a settings entry.
void put_settings_entry(ByteWriter& writer, const flow::LoopSettings& settings);
/// Returns nothing if they are not usable.
std::optional<flow::LoopSettings> read_settings_entry(ByteReader& reader);

// These return false if the payload is not usable. Then nothing has changed.
bool read_head(ByteReader& reader, Setup& setup);
bool read_hand(ByteReader& reader, std::vector<flow::HandInput>& hands);
bool read_loop(ByteReader& reader, std::optional<LoopSetup>& loop);
bool read_rest(std::span<const std::byte> payload, std::optional<LoopSetup>& loop);
bool read_origin(std::span<const std::byte> payload, std::optional<LoopSetup>& loop);
bool read_puppet(ByteReader& reader, std::optional<LoopSetup>& loop);

struct NumberedPuppet {
  std::uint32_t number = 0;
  RecordedPuppet puppet;
};
/// Reads what put_puppet_version() writes. Returns nothing if it is not usable.
std::optional<NumberedPuppet> read_puppet_version(std::span<const std::byte> payload);

} // namespace nendo::recording
