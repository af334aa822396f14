#pragma once
// Reads whole files, up to a limit, and writes whole files so that none is ever half-written.
// Errors are one line that begins with the path. All functions block for as long as the disk does.

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
  std::uint64_t size = 0; ///< when it was opened
};

/// Opens a regular file, to read it piece by piece. `kind` is as in read_file(). Error: bad_input.
NENDO_API Result<OpenFile> open_file(const std::filesystem::path& path, std::string_view kind);

/// Returns the contents of a regular file; a device or a pipe is refused, since it might never end.
/// `kind` says in errors what the file ought to be, e.g. "mesh". Error: bad_input, also if the file
/// has more than `max_bytes`.
NENDO_API Result<std::string> read_file(const std::filesystem::path& path, std::uint64_t max_bytes,
                                        std::string_view kind);

/// Replaces the file that `path` or its link leads to; it must be a regular file, if it exists.
/// Writes a temporary file beside it, syncs that and renames it, so that the file always is the old
/// one or the whole new one; its permissions are preserved. The temporary file (`.nendo.*.tmp`) is
/// removed on failure, and stays only if the process is killed. Error: failed.
NENDO_API Result<void> replace_file(const std::filesystem::path& path, std::string_view contents);

/// Writes all of `bytes`, in as many calls as it takes. Returns false, with errno set, if the
/// system refuses a call. It may be called in a signal handler.
NENDO_API bool write_all(int fd, std::span<const std::byte> bytes) noexcept;
/// Syncs the folder of `file`, because a new name is on the disk only when its folder is. Failures
/// are ignored, since some file systems cannot sync a folder.
NENDO_API void sync_folder_of(const std::filesystem::path& file);

/// Returns where a link leads, also if nothing is there yet; otherwise the path itself.
NENDO_API std::filesystem::path target_of(const std::filesystem::path& path);

/// Does what replace_file() does, piece by piece. Until finish() everything is in a temporary file,
/// which the destructor removes. The temporary file has the mode of the file that it replaces from
/// the beginning.
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
  /// Syncs, so that finish() can hardly fail any more. Only finish() may follow. It serves callers
  /// that replace several files and want all of them or none. Error: failed (e.g. the disk is
  /// full).
  Result<void> sync();
  /// Syncs and gives the file its name. No call may follow. Error: failed.
  Result<void> finish();

  std::uint64_t size() const noexcept { return size_; } ///< bytes written

private:
  FileReplacement(std::filesystem::path path, std::filesystem::path target);
  Error failure(int error_number) const;

  std::filesystem::path path_; ///< as it was named
  std::filesystem::path target_;
  std::filesystem::path temporary_; ///< empty: there is none
  UniqueFd file_;
  std::uint64_t size_ = 0;
};

} // namespace nendo
