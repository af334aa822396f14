#pragma once
// The device's end of a pseudo-terminal, and the symbolic link by which hosts find the other one.

#include <filesystem>
#include <string>
#include <utility>

#include <nendo/base/result.hpp>

namespace nendo::emulator {

/// A symbolic link. The destructor removes it, unless it leads elsewhere by then.
class SymbolicLink {
public:
  SymbolicLink() = default;
  /// Makes the link. It replaces an old link in one step, so that a host sees the old target or the
  /// new one, and never replaces anything but a link. Error: failed.
  static Result<SymbolicLink> make(const std::string& where, const std::string& target);
  SymbolicLink(SymbolicLink&& other) noexcept
      : path_(std::exchange(other.path_, {})), target_(std::move(other.target_)) {}
  SymbolicLink& operator=(SymbolicLink&&) = delete;
  ~SymbolicLink() { remove(); }
  void remove() noexcept;

private:
  SymbolicLink(std::filesystem::path path, std::string target)
      : path_(std::move(path)), target_(std::move(target)) {}

  std::filesystem::path path_;
  std::string target_;
};

/// A pseudo-terminal in raw mode at 115200 baud. When this is destroyed, hosts see a hang-up. The
/// link is removed before that, because the system may give the terminal's number to another
/// program at once.
class PseudoTerminal {
public:
  /// Makes the terminal, and the link unless `link`, its path, is empty. Error: failed.
  static Result<PseudoTerminal> make(const std::string& link);
  PseudoTerminal(PseudoTerminal&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)),
        link_(std::move(other.link_)) {}
  PseudoTerminal& operator=(PseudoTerminal&&) = delete;
  ~PseudoTerminal();

  /// Returns the device's end, which is non-blocking. poll() reports POLLHUP as long as no host has
  /// the other end open.
  int fd() const noexcept { return fd_; }
  const std::string& path() const noexcept { return path_; } ///< of the host's end

private:
  explicit PseudoTerminal(int fd) noexcept : fd_(fd) {}
  PseudoTerminal(PseudoTerminal&& other, SymbolicLink link) noexcept
      : fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)), link_(std::move(link)) {}

  int fd_;
  std::string path_;
  SymbolicLink link_;
};

} // namespace nendo::emulator
