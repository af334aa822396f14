#pragma once
// Maps the file of a published segment (FORMAT.md).

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>

#include "publish/checked_segment.hpp"

namespace nendo::publish {

/// Returns the file of the segment NAME.
inline std::string segment_path(const std::string& name) {
  return "/dev/shm/nendo-" + name;
}

class MappedSegment {
public:
  /// Returns nullopt if there is no such file. Follows no link, and waits for no pipe. Errors,
  /// which name the path: no_permission, bad_input (another file, another version), failed.
  static Result<std::optional<MappedSegment>> open(const std::string& path) {
    UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    if (!file.is_open() && errno == ENOENT) return std::optional<MappedSegment>();
    if (!file.is_open() && (errno == EACCES || errno == EPERM))
      return Error{Errc::no_permission, path + ": may not be read"};
    const Error refused{Errc::bad_input, path + ": is no segment of nendo, version 1"};
    struct stat status{};
    if (!file.is_open() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode) ||
        static_cast<std::uint64_t>(status.st_size) < sizeof(nendo_publish_header))
      return refused;
    const auto bytes = static_cast<std::uint64_t>(status.st_size);
    void* const base = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file.get(), 0);
    if (base == MAP_FAILED) return Error{Errc::failed, path + ": " + std::strerror(errno)};
    MappedSegment mapped(std::move(file), base, bytes);
    if (!mapped.contents().is_usable()) return refused;
    return std::optional<MappedSegment>(std::move(mapped));
  }
  ~MappedSegment() {
    if (base_ != nullptr) ::munmap(base_, bytes_);
  }
  MappedSegment(MappedSegment&& other) noexcept
      : file_(std::move(other.file_)), base_(std::exchange(other.base_, nullptr)),
        bytes_(other.bytes_), contents_(std::exchange(other.contents_, {})) {}
  MappedSegment& operator=(MappedSegment&&) = delete;

  const CheckedSegment& contents() const noexcept { return contents_; }
  /// Returns whether the run has ended or was killed: while it lives, it holds a lock. One system
  /// call.
  bool has_ended() const noexcept {
    struct flock lock{};
    lock.l_type = F_RDLCK;
    lock.l_whence = SEEK_SET;
    return contents_.state() == NENDO_PUBLISH_ENDED ||
           (::fcntl(file_.get(), F_OFD_GETLK, &lock) == 0 && lock.l_type == F_UNLCK);
  }

private:
  MappedSegment(UniqueFd file, void* base, std::uint64_t bytes) noexcept
      : file_(std::move(file)), base_(base), bytes_(bytes), contents_(base, bytes) {}

  UniqueFd file_;
  void* base_;
  std::uint64_t bytes_;
  CheckedSegment contents_;
};

} // namespace nendo::publish
