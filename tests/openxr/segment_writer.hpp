#pragma once
// A segment in /dev/shm that a test writes.

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "openxr/segment_bytes.hpp"

namespace nendo::test {

/// A segment in /dev/shm. It is a new file each time, which takes the name of an earlier one.
class WrittenSegment {
public:
  /// Three such ticks are 30 s, so that no reader on a busy machine takes the writer for dead.
  static constexpr double slow_rate_hz = 0.1;

  static std::string unique_name(const std::string& what) {
    return "test-" + std::to_string(::getpid()) + "-" + what;
  }
  /// `length` is that of the file, which may be shorter than what its header says.
  explicit WrittenSegment(const std::string& name, std::size_t length = SegmentBytes::all_bytes,
                          bool writes = true)
      : path_("/dev/shm/nendo-" + name), length_(length) {
    const std::string hidden = path_ + ".new";
    const int file = ::open(hidden.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0400);
    REQUIRE(file >= 0);
    REQUIRE(::ftruncate(file, static_cast<off_t>(length)) == 0);
    struct stat status{};
    REQUIRE(::fstat(file, &status) == 0);
    inode_ = status.st_ino;
    void* const base = ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    REQUIRE(base != MAP_FAILED);
    base_ = static_cast<char*>(base);
    if (writes && length >= SegmentBytes::all_bytes) {
      bytes.emplace_back(base_, slow_rate_hz);
    } else if (writes) {
      std::vector<char> all(SegmentBytes::all_bytes);
      const SegmentBytes cut(all.data());
      std::memcpy(base_, all.data(), length);
    }
    std::filesystem::rename(hidden, path_);
  }
  ~WrittenSegment() {
    ::munmap(base_, length_);
    struct stat status{};
    if (::stat(path_.c_str(), &status) == 0 && status.st_ino == inode_) ::unlink(path_.c_str());
  }
  WrittenSegment(const WrittenSegment&) = delete;
  WrittenSegment& operator=(const WrittenSegment&) = delete;

  SegmentBytes& operator*() { return bytes.front(); }
  SegmentBytes* operator->() { return &bytes.front(); }
  const std::string& path() const { return path_; }

private:
  std::vector<SegmentBytes> bytes; ///< empty if the file is too short
  std::string path_;
  std::size_t length_;
  char* base_ = nullptr;
  ino_t inode_ = 0; ///< the name may be another segment's in the end
};

} // namespace nendo::test
