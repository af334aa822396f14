#include <nendo/recording/chunk_file.hpp>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <utility>

#include <unistd.h>

#include <nendo/base/byte_reader.hpp>
#include <nendo/base/byte_writer.hpp>
#include <nendo/base/crc32c.hpp>

namespace nendo::recording {
namespace {

// As in PNG (its specification, 3.1): a byte that is no ASCII, and both kinds of line ends, so that
// a transfer that takes it for text shows at once.
constexpr std::array<std::uint8_t, 8> file_magic{0x89, 'N', 'E', 'N', 'D', 'O', '\r', '\n'};
constexpr ChunkType chunk_magic = chunk_type("NCHK");
constexpr std::size_t window_bytes = std::size_t{1} << 18;

// Numbers are little-endian, so they are copied as they are in memory.
static_assert(std::endian::native == std::endian::little);

template <std::size_t size>
void seal(std::array<std::byte, size>& header) noexcept {
  const std::uint32_t sum = crc32c(std::span(header).first(size - 4));
  std::memcpy(header.data() + size - 4, &sum, sizeof sum);
}

template <std::size_t size>
bool is_sealed(std::span<const std::byte> header) noexcept {
  ByteReader sum(header.subspan(size - 4, 4));
  return sum.u32_le() == crc32c(header.first(size - 4));
}

} // namespace

std::array<std::byte, file_header_bytes> file_header() noexcept {
  std::array<std::byte, file_header_bytes> header{};
  constexpr std::array version{format_major, format_minor};
  std::memcpy(header.data(), file_magic.data(), file_magic.size());
  std::memcpy(header.data() + file_magic.size(), version.data(), sizeof version);
  seal(header);
  return header;
}

std::array<std::byte, chunk_header_bytes>
chunk_header(ChunkType type, std::uint32_t number, std::span<const std::byte> payload) noexcept {
  std::array<std::byte, chunk_header_bytes> header{};
  const std::array words{chunk_magic, type, static_cast<std::uint32_t>(payload.size()), number};
  std::memcpy(header.data(), words.data(), sizeof words);
  seal(header);
  return header;
}

void append_chunk(std::vector<std::byte>& out, ChunkType type, std::uint32_t number,
                  std::span<const std::byte> payload) {
  ByteWriter writer(out);
  writer.bytes(chunk_header(type, number, payload));
  writer.bytes(payload);
  writer.u32_le(crc32c(payload));
}

Result<ChunkReader> ChunkReader::of_file(const std::filesystem::path& path) {
  auto opened = open_file(path, "recording");
  if (!opened) return opened.error();
  ChunkReader reader;
  reader.name_ = path.string();
  reader.file_ = std::move(opened->file);
  reader.end_ = opened->size;
  return reader;
}

Result<ChunkReader> ChunkReader::open(const std::filesystem::path& path) {
  auto reader = of_file(path);
  if (!reader) return reader;
  if (const auto fine = reader->check_file_header(); !fine) return fine.error();
  return reader;
}

Result<ChunkReader> ChunkReader::open_damaged(const std::filesystem::path& path) {
  auto reader = of_file(path);
  if (!reader) return reader;
  const auto header = reader->view(0, file_header_bytes);
  const bool whole = header.size() == file_header_bytes && is_sealed<file_header_bytes>(header);
  // A header that is whole, but of another format, is to be believed.
  if (const auto fine = reader->check_file_header(); !fine && whole) return fine.error();
  return reader;
}

Result<ChunkReader> ChunkReader::of(std::span<const std::byte> bytes, std::string_view name) {
  ChunkReader reader;
  reader.name_ = name;
  reader.bytes_ = bytes;
  reader.end_ = bytes.size();
  if (const auto fine = reader.check_file_header(); !fine) return fine.error();
  return reader;
}

Result<void> ChunkReader::check_file_header() {
  const auto bad = [&](const std::string& what) {
    return Error{Errc::bad_input, name_ + ": " + what};
  };
  const auto header = view(0, file_header_bytes);
  const std::size_t compared = std::min(header.size(), file_magic.size());
  if (header.empty()) return bad("is empty; nothing was recorded");
  if (std::memcmp(header.data(), file_magic.data(), compared) != 0)
    return bad("is no recording; name a file that `nendo record` or `nendo run --record` wrote");
  if (header.size() < file_header_bytes) return bad("ends in its header; nothing was recorded");
  if (!is_sealed<file_header_bytes>(header))
    return bad("its header is damaged; `nendo recording repair` saves what follows");
  ByteReader versions(header.subspan(file_magic.size()));
  const unsigned major = versions.u16_le();
  const unsigned minor = versions.u16_le();
  const auto numbers = [](unsigned of_major, unsigned of_minor) {
    return std::to_string(of_major) + "." + std::to_string(of_minor);
  };
  const std::string has = "has format " + numbers(major, minor) + ", made by ";
  const std::string reads = " nendo; this one reads " + numbers(format_major, format_minor);
  if (major > format_major) return bad(has + "a newer" + reads + ", so update it");
  if (major < format_major || minor < first_format_minor)
    return bad(has + "an unreleased" + reads + " and newer ones, so record it again");
  at_ = good_end_ = file_header_bytes;
  return {};
}

/// Fewer bytes than asked for, only where the file ends.
std::span<const std::byte> ChunkReader::view(std::uint64_t offset, std::size_t bytes) {
  if (offset >= end_) return {};
  bytes = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, end_ - offset));
  if (file_.is_open() && (offset < window_at_ || offset + bytes > window_at_ + bytes_.size())) {
    window_.resize(std::max(bytes, window_bytes));
    std::size_t filled = 0;
    while (filled < window_.size()) {
      const ssize_t got = ::pread(file_.get(), window_.data() + filled, window_.size() - filled,
                                  static_cast<off_t>(offset + filled));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break; // the end, or a disk that fails: there is no more
      filled += static_cast<std::size_t>(got);
    }
    window_at_ = offset;
    bytes_ = std::span(window_).first(filled);
    if (filled < bytes) end_ = offset + filled;
  }
  const std::size_t at = static_cast<std::size_t>(offset - window_at_);
  return bytes_.subspan(at, std::min(bytes, bytes_.size() - at));
}

std::optional<ChunkReader::Header> ChunkReader::header_at(std::uint64_t offset) {
  const auto bytes = view(offset, chunk_header_bytes);
  if (bytes.size() < chunk_header_bytes) return std::nullopt;
  ByteReader reader(bytes);
  if (reader.u32_le() != chunk_magic) return std::nullopt;
  Header header;
  header.type = reader.u32_le();
  header.length = reader.u32_le();
  header.number = reader.u32_le();
  if (!is_sealed<chunk_header_bytes>(bytes) || header.length > max_payload_bytes)
    return std::nullopt;
  return header;
}

/// The first place from there on where a chunk begins; the end if none does.
std::uint64_t ChunkReader::find_header(std::uint64_t from) {
  while (from + chunk_header_bytes <= end_) {
    const auto bytes = view(from, window_bytes / 2);
    const auto* const begin = bytes.data();
    const auto* const found = static_cast<const std::byte*>(std::memchr(begin, 'N', bytes.size()));
    if (found == nullptr) {
      from += bytes.size();
      continue;
    }
    from += static_cast<std::uint64_t>(found - begin);
    if (header_at(from)) return from;
    ++from;
  }
  return end_;
}

void ChunkReader::damaged(std::uint64_t offset, std::uint64_t bytes, std::string what) {
  ++damage_count_;
  if (damages_.size() < max_damages) damages_.push_back({offset, bytes, std::move(what)});
}

void ChunkReader::count_number(std::uint32_t number) {
  if (number != next_number_) {
    damaged(at_, 0,
            number > next_number_
                ? std::to_string(number - next_number_) + " chunks are missing before number " +
                      std::to_string(number)
                : "chunk number " + std::to_string(number) + " comes after " +
                      std::to_string(next_number_ - 1));
  }
  next_number_ = number + 1;
}

/// Where to continue: behind the payload if a chunk begins there, or else where the next one does,
/// for bytes may be missing.
std::uint64_t ChunkReader::after_bad_payload(const Header& header) {
  const std::uint64_t behind = at_ + chunk_header_bytes + header.length + chunk_checksum_bytes;
  if (behind <= end_ && (behind == end_ || header_at(behind))) return behind;
  // Headers within headers would be summed up again and again; a disk does not do that to a file.
  if (checked_ > 8 * end_ + max_payload_bytes) return end_;
  return find_header(at_ + chunk_header_bytes);
}

std::optional<Chunk> ChunkReader::next() {
  while (at_ < end_) {
    const auto header = header_at(at_);
    if (!header) {
      const std::uint64_t found = find_header(at_ + 1);
      damaged(at_, found - at_,
              found == end_ ? "ends in the middle of a chunk" : "these bytes are no chunk");
      at_ = found;
      continue;
    }
    const std::uint64_t begin = at_ + chunk_header_bytes;
    const auto body = view(begin, header->length + chunk_checksum_bytes);
    const bool is_there = body.size() == header->length + chunk_checksum_bytes;
    const auto payload = body.first(is_there ? header->length : 0);
    if (is_there && ByteReader(body.subspan(header->length)).u32_le() == crc32c(payload)) {
      count_number(header->number);
      const Chunk chunk{header->type, header->number, at_, payload};
      at_ = good_end_ = begin + body.size();
      return chunk;
    }
    checked_ += body.size();
    const std::uint64_t next = after_bad_payload(*header);
    damaged(at_, next - at_,
            is_there ? "the checksum of a chunk does not fit" : "ends in the middle of a chunk");
    at_ = next;
    next_number_ = header->number + 1;
  }
  return std::nullopt;
}

} // namespace nendo::recording
