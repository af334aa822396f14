#pragma once
// The glove data of a recording (apps/recording/FORMAT.md): the gloves' descriptions, and their
// samples as entries of an input log.

#include <cstdint>
#include <optional>
#include <span>

#include <nendo/base/byte_reader.hpp>
#include <nendo/base/byte_writer.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/tracker.hpp>
#include <nendo/recording/chunk_file.hpp>

namespace nendo::recording {

inline constexpr ChunkType glove_chunk = chunk_type("GLOV");   ///< one per glove
inline constexpr ChunkType tracker_chunk = chunk_type("TRAK"); ///< one per tracked wrist
inline constexpr ChunkType log_chunk = chunk_type("TAPE"); ///< entries of the input log, in order

/// Kinds of entries. Readers skip unknown kinds.
enum class EntryKind : std::uint8_t {
  sample = 1,
  request = 2,
  tick = 3,
  gap = 4,
  wrist = 5,
  settings = 6,
  hold_still = 7,
  model = 8,
  mark = 9,
  clutch = 10,
  role = 11,
  symmetry = 12,
  puppet = 13,
  layer = 15,
  wire = 16,
  pose = 17,
  recentre = 18,
};

/// One entry of an input log: its kind and its content.
struct LogEntry {
  std::uint8_t kind = 0;
  std::span<const std::byte> body;

  bool is(EntryKind wanted) const noexcept { return kind == static_cast<std::uint8_t>(wanted); }
};

/// Iterates over the entries of a TAPE chunk's payload. Pure.
class NENDO_API LogEntries {
public:
  explicit LogEntries(std::span<const std::byte> payload) noexcept : reader_(payload) {}
  /// Returns the next entry; nullopt at the end. ended_well() then says whether the payload ended
  /// with a whole entry.
  std::optional<LogEntry> next() noexcept;
  bool ended_well() const noexcept { return !reader_.overrun(); }

private:
  ByteReader reader_;
};

struct RecordedSample {
  std::uint8_t glove = 0; ///< number from the glove's GLOV chunk
  GloveSample sample;
};

/// Returns the sample of an entry; nullopt if the entry is no sample, or has values that no glove
/// sends.
NENDO_API std::optional<RecordedSample> sample_of(const LogEntry& record) noexcept;

struct RecordedGlove {
  std::uint8_t number = 0;
  driver::GloveInfo info;
};

/// A pose that moved the wrist of a hand.
struct RecordedPose {
  Side side = Side::right;
  PoseSample pose;
};

/// Returns the pose of an entry; nullopt if the entry is no pose, or has times or a side that are
/// out of range. Its numbers are those that the tracker sent.
NENDO_API std::optional<RecordedPose> pose_of(const LogEntry& record) noexcept;

/// The tracker that moved the wrist of a hand.
struct RecordedTracker {
  Side side = Side::right; ///< the hand's side on the stage
  std::uint16_t station = 0;
  driver::TrackerInfo info;
};

/// Writes the payload of a GLOV chunk.
NENDO_API void put_glove(ByteWriter& writer, const RecordedGlove& glove);
/// Returns the glove that the payload of a GLOV chunk describes; nullopt if put_glove() cannot have
/// written it. In its strings, characters other than printable ASCII become '?'.
NENDO_API std::optional<RecordedGlove> glove_of(std::span<const std::byte> payload);

} // namespace nendo::recording
