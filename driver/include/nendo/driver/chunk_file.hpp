#pragma once
// The frame of a recording (driver/src/replay/FORMAT.md): a file header, then chunks, each with a
// type, a length, a number and checksums, so that damage is found, costs no more than the chunks
// that it hit, and a file that ends in the middle of a chunk is good up to there.

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

namespace nendo::driver {

/// Four letters, as they stand in the file.
using ChunkType = std::uint32_t;
constexpr ChunkType chunk_type(const char (&letters)[5]) noexcept {
  ChunkType type = 0;
  for (unsigned at = 0; at < 4; ++at)
    type |= static_cast<ChunkType>(static_cast<unsigned char>(letters[at])) << (8 * at);
  return type;
}

inline constexpr std::uint16_t format_major = 1; ///< a newer one cannot be read
inline constexpr std::uint16_t format_minor = 1; ///< newer ones add what may be passed over
inline constexpr std::size_t file_header_bytes = 16;
inline constexpr std::size_t chunk_header_bytes = 20;
inline constexpr std::size_t chunk_checksum_bytes = 4; ///< after the payload
inline constexpr std::size_t most_payload_bytes = std::size_t{1} << 24;

/// Pure, as the next; both may be called in a signal handler.
std::array<std::byte, file_header_bytes> file_header() noexcept;
/// `number`: of the chunk in its file, from 0; `payload`: at most most_payload_bytes.
std::array<std::byte, chunk_header_bytes> chunk_header(ChunkType type, std::uint32_t number,
                                                       std::span<const std::byte> payload) noexcept;
/// A whole chunk at the end of `out`.
void append_chunk(std::vector<std::byte>& out, ChunkType type, std::uint32_t number,
                  std::span<const std::byte> payload);

struct Chunk {
  ChunkType type = 0;
  std::uint32_t number = 0;
  std::uint64_t offset = 0;           ///< of its header, in the file
  std::span<const std::byte> payload; ///< until the next chunk is asked for
};

struct ChunkDamage {
  std::uint64_t offset = 0; ///< where it begins
  std::uint64_t bytes = 0;  ///< of no use; 0 if chunks are missing between two good ones
  std::string what;         ///< one line
};

/// Goes through a file, or bytes in memory, from chunk to chunk. Hostile bytes cost time and memory
/// that the file's size bounds. One thread; blocks for as long as the disk does.
class ChunkReader {
public:
  /// Errors: bad_input (no regular file, no recording, made by a newer nendo).
  static Result<ChunkReader> open(const std::filesystem::path& path);
  /// To save what can be saved: a header that is no recording's is damage like any other.
  static Result<ChunkReader> open_damaged(const std::filesystem::path& path);
  /// `bytes` must outlive it; `name` is what errors call them.
  static Result<ChunkReader> of(std::span<const std::byte> bytes, std::string_view name);

  /// The next chunk that is whole; nothing at the end. What is not whole is passed over and told by
  /// damages(); reading goes on at the next chunk that can be found.
  std::optional<Chunk> next();

  /// So far; of more than most_damages, the first ones.
  const std::vector<ChunkDamage>& damages() const noexcept { return damages_; }
  std::uint64_t damage_count() const noexcept { return damage_count_; }
  static constexpr std::size_t most_damages = 100;
  std::uint64_t size() const noexcept { return end_; }
  /// Where the last good chunk ended.
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
  Descriptor file_;                  ///< open, or else:
  std::span<const std::byte> bytes_; ///< all there is; of a file, its part from window_at_ on
  std::vector<std::byte> window_;
  std::uint64_t window_at_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t at_ = 0;
  std::uint64_t good_end_ = 0;
  std::uint64_t checked_ = 0; ///< bytes that were summed up in vain
  std::uint32_t next_number_ = 0;
  std::vector<ChunkDamage> damages_;
  std::uint64_t damage_count_ = 0;
};

} // namespace nendo::driver
