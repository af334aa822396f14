#pragma once
// The container format of a recording (apps/recording/FORMAT.md): a file header, then chunks, each
// with a type, a length, a number and checksums. Damage is detected and affects only the chunks
// that it hit, and a truncated file is valid up to its last whole chunk.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/files.hpp>

namespace nendo::recording {

/// A chunk's type: four letters in file order (FourCC).
using ChunkType = std::uint32_t;
constexpr ChunkType chunk_type(const char (&letters)[5]) noexcept {
  ChunkType type = 0;
  for (unsigned at = 0; at < 4; ++at)
    type |= static_cast<ChunkType>(static_cast<unsigned char>(letters[at])) << (8 * at);
  return type;
}

// The format of new files. Minor versions before the first released one cannot be read, nor can
// newer major versions; newer minor versions only add data that a reader may skip.
inline constexpr std::uint16_t format_major = 1;
inline constexpr std::uint16_t format_minor = 14;
inline constexpr std::uint16_t first_format_minor = 13;
inline constexpr std::size_t file_header_bytes = 16;
inline constexpr std::size_t chunk_header_bytes = 20;
inline constexpr std::size_t chunk_checksum_bytes = 4; ///< after the payload
inline constexpr std::size_t max_payload_bytes = std::size_t{1} << 24;

/// Returns the header of a file. Pure; may be called in a signal handler.
NENDO_API std::array<std::byte, file_header_bytes> file_header() noexcept;
/// Returns the header of `payload`, which has at most max_payload_bytes. `number` counts the
/// chunks of the file, from 0. Pure; may be called in a signal handler.
NENDO_API std::array<std::byte, chunk_header_bytes>
chunk_header(ChunkType type, std::uint32_t number, std::span<const std::byte> payload) noexcept;
/// Appends a whole chunk to `out`: header, payload and checksum.
NENDO_API void append_chunk(std::vector<std::byte>& out, ChunkType type, std::uint32_t number,
                            std::span<const std::byte> payload);

struct Chunk {
  ChunkType type = 0;
  std::uint32_t number = 0;
  std::uint64_t offset = 0;           ///< file offset of its header
  std::span<const std::byte> payload; ///< valid until the next call of ChunkReader::next()
};

struct ChunkDamage {
  std::uint64_t offset = 0; ///< file offset of its beginning
  std::uint64_t bytes = 0;  ///< unusable bytes; 0 if chunks are missing between two good ones
  std::string what;         ///< description, one line
};

/// Iterates over the chunks of a file, or of bytes in memory. The file's size bounds time and
/// memory, also for hostile bytes. Blocks during disk access.
class NENDO_API ChunkReader {
public:
  /// Opens a recording. Error: bad_input (not a regular file, not a recording, of another format).
  static Result<ChunkReader> open(const std::filesystem::path& path);
  /// Opens a file for recovery: a wrong file header counts as damage. Error: bad_input (not a
  /// regular file).
  static Result<ChunkReader> open_damaged(const std::filesystem::path& path);
  /// Reads from memory. `bytes` must outlive the reader; error messages call them `name`.
  static Result<ChunkReader> of(std::span<const std::byte> bytes, std::string_view name);

  /// Returns the next whole chunk, or nullopt at the end. Damaged parts are skipped and listed in
  /// damages().
  std::optional<Chunk> next();

  /// Returns the first max_damages damages found so far.
  const std::vector<ChunkDamage>& damages() const noexcept { return damages_; }
  std::uint64_t damage_count() const noexcept { return damage_count_; }
  static constexpr std::size_t max_damages = 100;
  std::uint64_t size() const noexcept { return end_; }
  /// Returns the end offset of the last valid chunk.
  std::uint64_t good_end() const noexcept { return good_end_; }
  const std::string& name() const noexcept { return name_; }

private:
  struct Header {
    ChunkType type = 0;
    std::uint32_t length = 0;
    std::uint32_t number = 0;
  };

  static Result<ChunkReader> of_file(const std::filesystem::path& path);
  Result<void> check_file_header();
  std::span<const std::byte> view(std::uint64_t offset, std::size_t bytes);
  std::optional<Header> header_at(std::uint64_t offset);
  std::uint64_t find_header(std::uint64_t from);
  std::uint64_t after_bad_payload(const Header& header);
  void damaged(std::uint64_t offset, std::uint64_t bytes, std::string what);
  void count_number(std::uint32_t number);

  std::string name_;
  UniqueFd file_;                    ///< open for a file; closed for bytes in memory
  std::span<const std::byte> bytes_; ///< the bytes in memory, or the file's part from window_at_ on
  std::vector<std::byte> window_;
  std::uint64_t window_at_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t at_ = 0;
  std::uint64_t good_end_ = 0;
  std::uint64_t checked_ = 0; ///< bytes whose checksum failed
  std::uint32_t next_number_ = 0;
  std::vector<ChunkDamage> damages_;
  std::uint64_t damage_count_ = 0;
};

} // namespace nendo::recording
