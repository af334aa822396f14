#pragma once
// What of a recording belongs to gloves (driver/src/replay/FORMAT.md): who they are, and their
// samples as entries of an input log.

#include <cstdint>
#include <optional>
#include <span>

#include <nendo/base/byte_reader.hpp>
#include <nendo/base/byte_writer.hpp>
#include <nendo/driver/chunk_file.hpp>
#include <nendo/driver/glove.hpp>

namespace nendo::driver {

inline constexpr ChunkType glove_chunk = chunk_type("GLOV"); ///< one for each glove
inline constexpr ChunkType tape_chunk = chunk_type("TAPE");  ///< what happened, in its order

/// Kinds of entries; unknown ones are passed over.
enum class RecordKind : std::uint8_t { sample = 1, request = 2, tick = 3, gap = 4, wrist = 5 };

/// One entry of an input log: its kind and what it holds.
struct TapeRecord {
  std::uint8_t kind = 0;
  std::span<const std::byte> body;

  bool is(RecordKind wanted) const noexcept { return kind == static_cast<std::uint8_t>(wanted); }
};

/// The entries of an input log chunk's payload, one after another; pure.
class TapeRecords {
public:
  explicit TapeRecords(std::span<const std::byte> payload) noexcept : reader_(payload) {}
  /// Nothing: the end, or a payload that ends in the middle of an entry, which ended_well() tells.
  std::optional<TapeRecord> next() noexcept;
  bool ended_well() const noexcept { return !reader_.overrun(); }

private:
  ByteReader reader_;
};

/// Every kind's entry begins so.
void put_record_head(ByteWriter& writer, RecordKind kind, std::size_t body_bytes);

struct RecordedSample {
  std::uint8_t glove = 0; ///< the number that its GLOV chunk gives it
  GloveSample sample;
};

/// Times in a recording are nanoseconds of the host's clock; what lies a century off is refused, so
/// that differences of times never overflow.
bool is_usable_time(std::chrono::nanoseconds since_epoch) noexcept;
void put_time(ByteWriter& writer, HostTime time);
HostTime read_time(ByteReader& reader) noexcept;

void put_sample(ByteWriter& writer, const RecordedSample& recorded);
/// Nothing if the entry is no sample, or holds what no glove sends.
std::optional<RecordedSample> sample_of(const TapeRecord& record) noexcept;
/// The same of a sample that stands in another chunk, without an entry's head.
void put_sample_body(ByteWriter& writer, const RecordedSample& recorded);
std::optional<RecordedSample> read_sample_body(ByteReader& reader) noexcept;

struct RecordedGlove {
  std::uint8_t number = 0;
  GloveInfo info;
};

void put_glove(ByteWriter& writer, const RecordedGlove& glove);
/// Nothing if the payload is not what put_glove() writes. In its texts, what is
/// not printable ASCII becomes '?'.
std::optional<RecordedGlove> glove_of(std::span<const std::byte> payload);

} // namespace nendo::driver
