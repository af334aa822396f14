#pragma once
// Memory that another program writes: a file, mapped for reading.

#include <cstddef>
#include <string>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace nendo::test {

class MappedFile {
public:
  explicit MappedFile(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status{};
    REQUIRE(::fstat(file, &status) == 0);
    bytes_ = static_cast<std::size_t>(status.st_size);
    base_ = ::mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, file, 0);
    ::close(file);
    REQUIRE(base_ != MAP_FAILED);
  }
  ~MappedFile() { ::munmap(base_, bytes_); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const void* base() const { return base_; }
  std::size_t bytes() const { return bytes_; }

private:
  void* base_ = nullptr;
  std::size_t bytes_ = 0;
};

} // namespace nendo::test
