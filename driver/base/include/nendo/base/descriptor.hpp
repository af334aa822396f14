#pragma once
// An open file of the system's, closed when nobody holds it any more.

#include <utility>

namespace nendo {

class Descriptor {
public:
  Descriptor() = default;
  /// Takes what open() gave; a negative one is no open file.
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
  /// False if the system reports here what an earlier write could not keep.
  bool close() noexcept;

private:
  int fd_ = -1;
};

} // namespace nendo
