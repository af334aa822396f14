#pragma once
// The device's end of a pseudo-terminal, and the symbolic link by which hosts find the other one.

#include <filesystem>
#include <string>
#include <utility>

#include <nendo/base/result.hpp>

namespace nendo::emulator {

/// A symbolic link that is gone when its maker is, unless someone has pointed it elsewhere
/// meanwhile.
class SymbolicLink {
public:
  SymbolicLink() = default;
  /// Replaces an old link in one step, so that a host sees the old target or the new one. Error:
  /// failed; it never replaces anything but a link.
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

/// Raw, 115200 baud. Hosts see it hung up when this is destroyed, and its link is gone before that:
/// the system may give the terminal's number to a stranger at once.
class PseudoTerminal {
public:
  /// `link` is empty or the link's path. Error: failed.
  static Result<PseudoTerminal> make(const std::string& link);
  PseudoTerminal(PseudoTerminal&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)),
        link_(std::move(other.link_)) {}
  PseudoTerminal& operator=(PseudoTerminal&&) = delete;
  ~PseudoTerminal();

  /// Does not block. poll() says POLLHUP as long as no host has the other end open.
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
