#pragma once
// A new file that is removed again unless it is kept.

#include <filesystem>
#include <utility>

#include <nendo/base/descriptor.hpp>
#include <nendo/base/result.hpp>

namespace nendo::recording {

class NewFile {
public:
  /// Creates the file. Error: failed (a file of that name exists already, or it cannot be created).
  static Result<NewFile> create(const std::filesystem::path& path);
  NewFile(NewFile&& other) noexcept
      : path_(std::move(other.path_)), file_(std::move(other.file_)),
        provisional_(std::exchange(other.provisional_, false)) {}
  NewFile& operator=(NewFile&&) = delete;
  /// Removes the file unless keep() was called.
  ~NewFile();

  /// Makes the file permanent. Its name is on the disk when this returns.
  void keep();
  bool is_kept() const noexcept { return !provisional_; }

  int fd() const noexcept { return file_.get(); }
  bool close() noexcept { return file_.close(); } ///< false, with errno, if the system refuses
  const std::filesystem::path& path() const noexcept { return path_; }

private:
  NewFile(std::filesystem::path path, Descriptor file)
      : path_(std::move(path)), file_(std::move(file)), provisional_(true) {}

  std::filesystem::path path_;
  Descriptor file_;
  bool provisional_;
};

} // namespace nendo::recording
