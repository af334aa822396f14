#pragma once
// An owning file descriptor, which the destructor closes.

#include <utility>

#include <nendo/base/api.hpp>

namespace nendo {

class NENDO_API UniqueFd {
public:
  UniqueFd() = default;
  /// Takes ownership of `fd`. A negative `fd`, as from a failed open(), means no open file.
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
  /// Closes the file, if it is open. Returns false if the system reports a failed earlier write.
  bool close() noexcept;

private:
  int fd_ = -1;
};

} // namespace nendo
