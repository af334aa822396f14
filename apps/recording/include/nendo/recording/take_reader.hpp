#pragma once
// A recording, read entry by entry.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <nendo/driver/chunk_file.hpp>
#include <nendo/driver/sample_record.hpp>
#include <nendo/flow/input_log.hpp>
#include <nendo/recording/recorded_shape.hpp>
#include <nendo/recording/setup.hpp>

namespace nendo::recording {

/// Here something is missing: the recorder could not keep up, a chunk is damaged, or the recording
/// begins in the middle.
struct Gap {
  std::uint64_t entries = 0; ///< 0: nobody knows how many
};

using Entry =
    std::variant<driver::RecordedSample, flow::Request, flow::WristMove, flow::LoggedTick, Gap>;

/// What a recorder says when it has come to its end.
struct Ending {
  HostTime host{};
  std::uint64_t samples = 0;
  std::uint64_t requests = 0;
  std::uint64_t ticks = 0;
  std::uint64_t lost = 0;        ///< entries that found the input log full
  std::optional<ShapeSum> shape; ///< the loop's, when it had ended
};

/// An entry as it stands on an input log chunk. A sample's `hand` is its glove's number.
void put_entry(ByteWriter& writer, const Entry& entry);
void put_ending(ByteWriter& writer, const Ending& ending);
inline constexpr driver::ChunkType ending_chunk = driver::chunk_type("END ");

class TakeReader {
public:
  /// Reads up to the first entry. Errors: bad_input (as ChunkReader::open(), nothing in it).
  static Result<TakeReader> open(const std::filesystem::path& path);
  /// `bytes` must outlive it.
  static Result<TakeReader> of(std::span<const std::byte> bytes, std::string_view name);

  /// Complete, as far as it is whole, when this has been made: it does not change any more.
  const Setup& setup() const noexcept { return setup_; }
  /// The next entry that can be used; nothing at the end. Kinds and chunks that this nendo does not
  /// know are passed over.
  std::optional<Entry> next();
  /// The shape after the entries up to the latest but one, or up to the latest if there is no
  /// other; nothing: none is recorded there, or it has been taken.
  std::optional<RecordedShape> take_shape() { return std::exchange(shape_, std::nullopt); }
  /// At the end; nothing: the recording was cut off.
  const std::optional<Ending>& ending() const noexcept { return ending_; }
  const driver::ChunkReader& chunks() const noexcept { return chunks_; }
  std::uint64_t shapes() const noexcept { return shapes_; } ///< so far
  /// Chunks and entries whose checksum fits, but which no nendo writes.
  std::uint64_t strange() const noexcept { return strange_; }

private:
  explicit TakeReader(driver::ChunkReader chunks);
  bool next_chunk();
  std::optional<Entry> entry_of(const driver::TapeRecord& record);

  driver::ChunkReader chunks_;
  Setup setup_;
  driver::TapeRecords records_{{}};
  std::optional<Ending> ending_;
  std::optional<RecordedShape> shape_;
  std::uint64_t shapes_ = 0;
  std::uint64_t damages_told_ = 0;
  std::uint64_t strange_ = 0;
  bool setup_done_ = false; ///< at the first input log
  bool gap_due_ = false;
};

} // namespace nendo::recording
