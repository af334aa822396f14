#pragma once
// Reads and writes the single chunks of a setup, which FORMAT.md describes. Enumerators are written
// as their numbers, so new ones must be added at the ends of their lists, here and in the document.

#include <optional>
#include <span>

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

/// Added to a filter's kind where pinches are closed.
inline constexpr std::uint8_t pinches_bit = 128;

inline void put_filter_kind(ByteWriter& writer, const hand::FilterOptions& filter,
                            unsigned more = 0) {
  writer.u8(static_cast<std::uint8_t>(static_cast<unsigned>(filter.kind) | more |
                                      (filter.close_pinches ? pinches_bit : 0U)));
}

inline void put_filter_numbers(ByteWriter& writer, const hand::FilterOptions& filter) {
  flow::for_each_filter_number(
      [&](const flow::NumberSetting& number) { writer.f64_le(number.of(filter)); });
}

/// Reads one value after another and remembers whether all of them were usable. After an unusable
/// count, count() returns 0.
class CheckedReader {
public:
  explicit CheckedReader(ByteReader& reader) : reader_(&reader) {}

  double number(double least, double most) {
    const double value = reader_->f64_le();
    require(value >= least && value <= most);
    return value;
  }
  template <class Enum>
  Enum one_of(Enum last) {
    const unsigned value = reader_->u8();
    require(value <= static_cast<unsigned>(last));
    return static_cast<Enum>(value);
  }
  std::uint64_t size(std::uint64_t most) {
    const std::uint64_t bytes = reader_->u64_le();
    require(bytes <= most);
    return bytes;
  }
  std::size_t count(std::size_t most) {
    const std::size_t counted = reader_->u16_le();
    require(counted <= most);
    return fine_ ? counted : 0;
  }
  void require(bool fine) { fine_ = fine_ && fine; }
  /// What put_filter_kind() writes, of whose bits `more` are told apart and returned.
  unsigned filter_kind(hand::FilterOptions& filter, unsigned more = 0) {
    const unsigned value = reader_->u8();
    filter.close_pinches = (value & pinches_bit) != 0;
    const unsigned kind = value & ~(unsigned{pinches_bit} | more);
    require(kind <= static_cast<unsigned>(hand::FilterKind::one_euro));
    filter.kind = static_cast<hand::FilterKind>(kind);
    return value & more;
  }
  bool fine() const { return fine_ && !reader_->overrun(); }

private:
  ByteReader* reader_;
  bool fine_ = true;
};

void put_head(ByteWriter& writer, const Setup& setup);
void put_hand(ByteWriter& writer, std::uint8_t number, const flow::HandInput& hand);
void put_loop(ByteWriter& writer, const LoopSetup& loop);
/// Writes which signal of which hand it is; read_signal() returns nothing if there is no such one.
void put_signal(ByteWriter& writer, const puppet::HandSignal& signal);
std::optional<puppet::HandSignal> read_signal(ByteReader& reader);
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

/// Writes settings, as they stand in a loop's chunk and in entries.
void put_settings(ByteWriter& writer, const flow::LoopSettings& settings);
inline constexpr std::size_t settings_bytes = 76;
/// Writes the brushes, which follow them.
void put_brushes(ByteWriter& writer, const flow::LoopSettings& settings);
inline constexpr std::size_t brushes_bytes = 5 + 8;
bool read_brushes(ByteReader& reader, flow::LoopSettings& settings);

/// How clayey the model is, and what of the hands holds it; behind the brushes.
void put_hold(ByteWriter& writer, const flow::LoopSettings& settings);
inline constexpr std::size_t hold_bytes = 8 + 1;
bool read_hold(ByteReader& reader, flow::LoopSettings& settings);
/// Returns nothing if they are not usable.
std::optional<flow::LoopSettings> read_settings(ByteReader& reader);

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
