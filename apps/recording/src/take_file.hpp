#pragma once
// A recording that is being written: it only grows, chunk by chunk, and is whole after each.

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
  /// live: what is appended is on the disk, and stays there whatever comes later. copy: the file is
  /// of use when all of it is there, so that it goes again unless sync() was the last that was
  /// done.
  enum class Kind { live, copy };

  /// A new file with these first bytes in it, of so many chunks; there is none after an error.
  /// Error: failed.
  static Result<TakeFile> create(const std::filesystem::path& path,
                                 std::span<const std::byte> setup, std::uint32_t chunks, Kind kind);

  /// After an error a live file ends with the last whole chunk, and nothing is written any more:
  /// every later call does nothing. Error: failed, once.
  Result<void> append(driver::ChunkType type, std::span<const std::byte> payload);
  /// All of a copy is on the disk, and it stays. Error: failed.
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
