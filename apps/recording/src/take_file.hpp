#pragma once
// Writes recordings: a new file that is removed again unless it is made permanent, and a file that
// only grows, chunk by chunk, and is whole after each chunk. All functions block as long as the
// disk does.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>
#include <nendo/recording/chunk_file.hpp>

namespace nendo::recording {

class NewFile {
public:
  /// Creates the file. Error: failed (a file of that name exists already, or it cannot be created).
  static Result<NewFile> create(const std::filesystem::path& path);
  NewFile(NewFile&& other) noexcept
      : path_(std::move(other.path_)), file_(std::move(other.file_)),
        provisional_(std::exchange(other.provisional_, false)) {}
  NewFile& operator=(NewFile&&) = delete;
  /// Removes the file unless make_permanent() was called.
  ~NewFile();

  /// Lets the file stay. Its name is on the disk when this returns.
  void make_permanent();
  bool is_permanent() const noexcept { return !provisional_; }

  int fd() const noexcept { return file_.get(); }
  bool close() noexcept { return file_.close(); } ///< false, with errno, if the system refuses
  const std::filesystem::path& path() const noexcept { return path_; }

private:
  NewFile(std::filesystem::path path, UniqueFd file)
      : path_(std::move(path)), file_(std::move(file)), provisional_(true) {}

  std::filesystem::path path_;
  UniqueFd file_;
  bool provisional_;
};

class TakeFile {
public:
  /// live: what is appended is on the disk when append() returns, and the file stays whatever
  /// happens later. copy: the file is of use only when it is complete, so it is removed again
  /// unless sync() has succeeded.
  enum class Kind { live, copy };

  /// Creates the file with `setup` as its first bytes, which contain `chunks` chunks. After an
  /// error there is no file. Error: failed.
  static Result<TakeFile> create(const std::filesystem::path& path,
                                 std::span<const std::byte> setup, std::uint32_t chunks, Kind kind);

  /// Appends a chunk. After an error, a live file ends with the last whole chunk, and later calls
  /// do nothing. Error: failed, which is returned only once.
  Result<void> append(ChunkType type, std::span<const std::byte> payload);
  /// Writes everything to the disk and makes a copy permanent. Error: failed.
  Result<void> sync();

  std::uint64_t bytes() const noexcept { return bytes_; }

private:
  TakeFile(NewFile file, std::uint32_t chunks, Kind kind)
      : file_(std::move(file)), chunks_(chunks), kind_(kind) {}
  Result<void> write(std::span<const std::byte> bytes);
  Error give_up(const std::string& reason, const std::string& remedy);

  NewFile file_;
  std::uint32_t chunks_;
  Kind kind_;
  std::uint64_t bytes_ = 0;
  bool failed_ = false;
  std::vector<std::byte> chunk_;
};

} // namespace nendo::recording
