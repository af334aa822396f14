#pragma once
// Reads whole files, up to a size limit, and replaces whole files atomically. Error messages are
// one line that begins with the path. All functions block on file I/O.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>

namespace nendo {

struct OpenFile {
  UniqueFd file;
  std::uint64_t size = 0; ///< bytes, at opening
};

/// Opens a regular file for incremental reading. `kind` is as in read_file(). Error: bad_input.
NENDO_API Result<OpenFile> open_file(const std::filesystem::path& path, std::string_view kind);

/// Returns the contents of a regular file; devices and pipes are refused, since they might never
/// end. `kind` names the expected content in messages, e.g. "mesh". Error: bad_input, also if the
/// file exceeds `max_bytes`.
NENDO_API Result<std::string> read_file(const std::filesystem::path& path, std::uint64_t max_bytes,
                                        std::string_view kind);

/// Atomically replaces the regular file at `path`, or creates it; symbolic links are followed.
/// Writes a temporary file (`.nendo.*.tmp`) in the same folder, syncs it and renames it;
/// permissions are preserved. The temporary file is removed on failure, and remains only if the
/// process is killed. Error: failed.
NENDO_API Result<void> replace_file(const std::filesystem::path& path, std::string_view contents);

/// Writes all of `bytes`, by repeated write() calls. Returns false, with errno set, if a call
/// fails. Async-signal-safe.
NENDO_API bool write_all(int fd, std::span<const std::byte> bytes) noexcept;
/// Syncs the folder of `file`, which makes a new or renamed entry durable. Failures are ignored,
/// since some file systems cannot sync a folder.
NENDO_API void sync_folder_of(const std::filesystem::path& file);

/// Returns the target of a symbolic link, which need not exist; otherwise the path itself.
NENDO_API std::filesystem::path target_of(const std::filesystem::path& path);

/// An incremental replace_file(). Until finish(), the data are in a temporary file, which the
/// destructor removes. It is created with the mode of the file that it replaces.
class NENDO_API FileReplacement {
public:
  /// Starts to replace `path`. Error: failed (it is not a regular file, or cannot be written).
  static Result<FileReplacement> begin(const std::filesystem::path& path);
  FileReplacement(FileReplacement&& other) noexcept;
  FileReplacement& operator=(FileReplacement&&) = delete;
  ~FileReplacement();

  /// Appends bytes. Error: failed (for example if the disk is full).
  Result<void> write(std::span<const std::byte> bytes);
  Result<void> write(std::string_view text) { return write(std::as_bytes(std::span(text))); }
  /// Syncs the temporary file, so that finish() is unlikely to fail. Only finish() may follow. For
  /// callers that must replace several files or none. Error: failed (e.g. the disk is full).
  Result<void> sync();
  /// Syncs and renames the temporary file. No call may follow. Error: failed.
  Result<void> finish();

  std::uint64_t size() const noexcept { return size_; } ///< bytes written

private:
  FileReplacement(std::filesystem::path path, std::filesystem::path target);
  Error failure(int error_number) const;

  std::filesystem::path path_; ///< as given; for messages
  std::filesystem::path target_;
  std::filesystem::path temporary_; ///< empty if there is none
  UniqueFd file_;
  std::uint64_t size_ = 0;
};

} // namespace nendo
