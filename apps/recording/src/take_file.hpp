#pragma once
// A recording that is being written: it only grows, chunk by chunk, and is whole after each.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/files.hpp>
#include <nendo/driver/chunk_file.hpp>

namespace nendo::recording {

class TakeFile {
public:
  /// A new file with these first bytes in it, of so many chunks. Error: failed.
  static Result<TakeFile> create(const std::filesystem::path& path,
                                 std::span<const std::byte> setup, std::uint32_t chunks);

  /// What is appended from now on is on the disk after sync() alone.
  void sync_at_end() noexcept { syncs_each_ = false; }
  /// As append() fails.
  Result<void> sync();

  /// On the disk when this returns. After an error the file ends with the last whole chunk, and
  /// nothing is written any more: every later call does nothing. Error: failed, once.
  Result<void> append(driver::ChunkType type, std::span<const std::byte> payload);

  bool has_failed() const noexcept { return failed_; }
  std::uint64_t bytes() const noexcept { return bytes_; }
  const std::filesystem::path& path() const noexcept { return path_; }

private:
  Result<void> write(std::span<const std::byte> bytes);
  Error give_up(const std::string& why);

  std::filesystem::path path_;
  Descriptor file_;
  std::uint32_t chunks_ = 0;
  std::uint64_t bytes_ = 0;
  bool failed_ = false;
  bool syncs_each_ = true;
  std::vector<std::byte> chunk_;
};

/// A descriptor of a new file, or what is in the way. Error: failed.
Result<Descriptor> create_file(const std::filesystem::path& path);

} // namespace nendo::recording
