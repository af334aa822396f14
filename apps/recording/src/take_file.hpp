#pragma once
// Writes a recording. The file only grows, chunk by chunk, and is whole after each chunk.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nendo/driver/chunk_file.hpp>

#include "new_file.hpp"

namespace nendo::recording {

class TakeFile {
public:
  /// live: what is appended is on the disk when append() returns, and the file stays whatever
  /// happens later. copy: the file is of use only when it is complete, so it is removed again
  /// unless sync() has succeeded.
  enum class Kind { live, copy };

  /// Creates the file with `setup` as its first bytes, which contain that many chunks. After an
  /// error there is no file. Error: failed.
  static Result<TakeFile> create(const std::filesystem::path& path,
                                 std::span<const std::byte> setup, std::uint32_t chunks, Kind kind);

  /// Appends a chunk. After an error, a live file ends with the last whole chunk, and later calls
  /// do nothing. Error: failed, which is returned only once.
  Result<void> append(driver::ChunkType type, std::span<const std::byte> payload);
  /// Writes everything to the disk and makes a copy permanent. Error: failed.
  Result<void> sync();

  bool has_failed() const noexcept { return failed_; }
  std::uint64_t bytes() const noexcept { return bytes_; }
  const std::filesystem::path& path() const noexcept { return file_.path(); }

private:
  TakeFile(NewFile file, std::uint32_t chunks, Kind kind)
      : file_(std::move(file)), chunks_(chunks), kind_(kind) {}
  Result<void> write(std::span<const std::byte> bytes);
  Error give_up(const std::string& why, const std::string& remedy);

  NewFile file_;
  std::uint32_t chunks_;
  Kind kind_;
  std::uint64_t bytes_ = 0;
  bool failed_ = false;
  std::vector<std::byte> chunk_;
};

} // namespace nendo::recording
