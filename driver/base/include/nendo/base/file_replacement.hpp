#pragma once
// A whole file out, piece by piece: what is too large to be in memory at once.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include <nendo/base/descriptor.hpp>
#include <nendo/base/result.hpp>

namespace nendo {

/// replace_file(), piece by piece: until finish() everything is in the temporary file, which goes
/// without it. Its mode is that of the file in whose place it comes, from before the first byte.
class FileReplacement {
public:
  /// Error: failed (not a regular file, cannot be written).
  static Result<FileReplacement> begin(const std::filesystem::path& path);
  FileReplacement(FileReplacement&& other) noexcept;
  FileReplacement& operator=(FileReplacement&&) = delete;
  ~FileReplacement();

  /// After what was written before. Error: failed (disk full, ...).
  Result<void> write(std::span<const std::byte> bytes);
  Result<void> write(std::string_view text) { return write(std::as_bytes(std::span(text))); }
  /// Nothing follows but finish(), which can then hardly fail: for who replaces several files, and
  /// wants all of them or none. Error: failed (what a disk found full only now).
  Result<void> sync();
  /// Syncs and gives the file its name; the last call. Error: failed.
  Result<void> finish();

  std::uint64_t size() const noexcept { return size_; } ///< bytes written

private:
  FileReplacement(std::filesystem::path path, std::filesystem::path target);
  Error failure(int error_number) const;

  std::filesystem::path path_; ///< as it was named
  std::filesystem::path target_;
  std::filesystem::path temporary_; ///< empty: there is none
  Descriptor file_;
  std::uint64_t size_ = 0;
};

} // namespace nendo
