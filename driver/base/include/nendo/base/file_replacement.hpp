#pragma once
// Writes a whole file piece by piece, for contents that are too large to be in memory at once.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>

namespace nendo {

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
