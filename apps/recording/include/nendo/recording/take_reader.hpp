#pragma once
// Reads a recording entry by entry.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <nendo/base/byte_writer.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/input_script.hpp>
#include <nendo/recording/chunk_file.hpp>
#include <nendo/recording/sample_record.hpp>
#include <nendo/recording/setup.hpp>

namespace nendo::recording {

/// A shape in a recording. A replay does not need it. It is for programs that have no loop, and for
/// a comparison with the result of a replay on another machine.
struct RecordedShape {
  std::uint64_t tick = 0; ///< the number of the tick that made it
  std::vector<float> xyz; ///< model units, x y z of one vertex after another
};

inline constexpr ChunkType shape_chunk = chunk_type("SHAP");
/// The maximum number of vertices in a chunk.
inline constexpr std::size_t max_recorded_vertices = (max_payload_bytes - 12) / 12;

NENDO_API RecordedShape shape_of(std::uint64_t tick, const deform::Points& vertices);
/// Writes the payload of a chunk. The shape must have at most max_recorded_vertices.
NENDO_API void put_shape(ByteWriter& writer, const RecordedShape& shape);
/// Returns nullopt if put_shape() cannot have written the payload, or if it has a number that is
/// not finite.
NENDO_API std::optional<RecordedShape> read_shape(std::span<const std::byte> payload);

/// Returns the greatest distance between a vertex of `shape` and the same vertex of `vertices`, in
/// model units. Returns nullopt if the numbers of vertices differ.
NENDO_API std::optional<double> distance_between(const RecordedShape& shape,
                                                 const deform::Points& vertices);

/// Marks missing entries: the recorder could not keep up, a chunk is damaged, or the recording
/// begins in the middle.
struct Gap {
  std::uint64_t entries = 0; ///< 0 means an unknown number
};

/// The loop continues with another puppet, whose text and points are in a previous chunk.
struct PuppetChange {
  std::uint32_t number = 0;
  std::shared_ptr<const RecordedPuppet> puppet; ///< null: the one with which the recording began
};

using Entry = std::variant<RecordedSample, flow::Request, flow::WristMove, flow::LoopSettings,
                           flow::HoldStill, flow::ChangeModel, flow::Mark, flow::SetClutch,
                           flow::SetRole, flow::SetSymmetry, flow::SetLayer, flow::DrawWire,
                           PuppetChange, flow::LoggedTick, Gap, RecordedPose, flow::Recentre>;

template <class One, class Of = Entry>
inline constexpr bool is_entry = false;
/// True if `One` is an alternative of the variant Entry.
template <class One, class... Types>
inline constexpr bool is_entry<One, std::variant<Types...>> = (std::is_same_v<One, Types> || ...);

/// The data that a recorder writes at the end of a recording.
struct Ending {
  HostTime host{};
  std::uint64_t samples = 0;
  std::uint64_t requests = 0;
  std::uint64_t ticks = 0;
  std::uint64_t lost = 0;        ///< entries dropped because the input log was full
  std::optional<ShapeSum> shape; ///< the loop's shape after its last tick
};

/// Writes an entry in the format of an input log chunk. The `hand` of a sample is the number of its
/// glove.
NENDO_API void put_entry(ByteWriter& writer, const Entry& entry);
NENDO_API void put_ending(ByteWriter& writer, const Ending& ending);
inline constexpr ChunkType ending_chunk = chunk_type("END ");
/// Writes a puppet as a chunk, which must precede the entries that name its number.
NENDO_API void put_puppet_version(ByteWriter& writer, std::uint32_t number,
                                  const RecordedPuppet& puppet);
inline constexpr ChunkType puppet_version_chunk = chunk_type("PUPV");
/// Writes the record counts of the gloves so far, by glove number, for at most 255 gloves.
NENDO_API void put_sent(ByteWriter& writer, std::span<const driver::RecordCounts> gloves);
inline constexpr ChunkType sent_chunk = chunk_type("SENT");

class NENDO_API TakeReader {
public:
  /// Opens a recording and reads up to the first entry. Errors: bad_input (as for
  /// ChunkReader::open(), or the recording is empty).
  static Result<TakeReader> open(const std::filesystem::path& path);
  /// Does the same for a recording in memory. `bytes` must outlive the reader.
  static Result<TakeReader> of(std::span<const std::byte> bytes, std::string_view name);

  /// Returns the setup. It does not change any more, and it is complete as far as the recording is
  /// whole.
  const Setup& setup() const noexcept { return setup_; }
  /// Returns the next usable entry, or nullopt at the end. Entries and chunks of unknown kinds are
  /// skipped.
  std::optional<Entry> next();
  /// Takes the shape that was recorded just before the entry that next() returned last, or, at the
  /// end, after all entries. Returns nullopt if no shape is recorded there, or if it has been taken
  /// already.
  std::optional<RecordedShape> take_shape() { return std::exchange(shape_, std::nullopt); }
  /// Returns the ending once next() has reached the end. It stays empty if the recording was cut
  /// off.
  const std::optional<Ending>& ending() const noexcept { return ending_; }
  /// Returns the latest counts of the gloves' records, by their numbers, as far as next() has
  /// come. Empty if not recorded.
  const std::vector<driver::RecordCounts>& sent() const noexcept { return sent_; }
  const ChunkReader& chunks() const noexcept { return chunks_; }
  std::uint64_t shapes() const noexcept { return shapes_; } ///< number of shapes so far
  /// Returns the number of chunks and entries so far whose checksum is right, but which nendo does
  /// not write.
  std::uint64_t unknown_entries() const noexcept { return unknown_entries_; }

private:
  explicit TakeReader(ChunkReader chunks);
  static Result<TakeReader> begin(ChunkReader chunks, const std::string& name);
  bool next_chunk();
  bool take_chunk(const Chunk& chunk);
  std::optional<Entry> entry_of(const LogEntry& record);

  ChunkReader chunks_;
  Setup setup_;
  std::map<std::uint32_t, std::shared_ptr<const RecordedPuppet>>
      puppets_; ///< indexed by their numbers
  LogEntries records_{{}};
  std::optional<Ending> ending_;
  std::vector<driver::RecordCounts> sent_;
  std::optional<RecordedShape> shape_;
  std::uint64_t shapes_ = 0;
  std::uint64_t damages_seen_ = 0;
  std::uint64_t unknown_entries_ = 0;
  bool setup_done_ = false; ///< true from the first input log chunk on
  bool gap_due_ = false;
};

} // namespace nendo::recording
