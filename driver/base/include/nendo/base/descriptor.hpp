#pragma once
// Owns a file descriptor and closes it when it goes.

#include <utility>

#include <nendo/base/api.hpp>

namespace nendo {

class NENDO_API Descriptor {
public:
  Descriptor() = default;
  /// Takes over what open() returned. A negative number means that no file is open.
  explicit Descriptor(int fd) noexcept : fd_(fd) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    if (this != &other) {
      close();
      fd_ = std::exchange(other.fd_, -1);
    }
    return *this;
  }

  int get() const noexcept { return fd_; }
  bool is_open() const noexcept { return fd_ >= 0; }
  /// Closes the file, if it is open. Returns false if the system reports that an earlier write
  /// failed.
  bool close() noexcept;

private:
  int fd_ = -1;
};

} // namespace nendo
