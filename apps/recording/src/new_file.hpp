#pragma once
// A file that is begun where none is, and goes again unless it becomes what it is to be.

#include <filesystem>
#include <utility>

#include <nendo/base/descriptor.hpp>
#include <nendo/base/result.hpp>

namespace nendo::recording {

class NewFile {
public:
  /// Error: failed (something of that name is there, or it cannot be made).
  static Result<NewFile> create(const std::filesystem::path& path);
  NewFile(NewFile&& other) noexcept
      : path_(std::move(other.path_)), file_(std::move(other.file_)),
        provisional_(std::exchange(other.provisional_, false)) {}
  NewFile& operator=(NewFile&&) = delete;
  ~NewFile(); ///< without keep() it is there no more

  /// From now on it stays. Its name is on the disk when this returns.
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
