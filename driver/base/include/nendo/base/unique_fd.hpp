#pragma once
// The owner of a file descriptor, which closes it in the destructor.

#include <utility>

#include <nendo/base/api.hpp>

namespace nendo {

class NENDO_API UniqueFd {
public:
  UniqueFd() = default;
  /// Takes over a descriptor, as open() returned it. A negative number means that no file is open.
  explicit UniqueFd(int fd) noexcept : fd_(fd) {}
  ~UniqueFd() { close(); }
  UniqueFd(UniqueFd&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  UniqueFd& operator=(UniqueFd&& other) noexcept {
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
