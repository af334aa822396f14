#pragma once
// The device's end of a pseudo-terminal, and the symbolic link by which hosts find the other one.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>

namespace nendo::emulator {

/// A symbolic link. The destructor removes it, unless it leads elsewhere by then.
class SymbolicLink {
public:
  /// Makes the link. It replaces an old link in one step, so that a host sees the old target or the
  /// new one, and never replaces anything but a link. Error: failed.
  static Result<SymbolicLink> make(const std::string& where, const std::string& target);
  SymbolicLink(SymbolicLink&& other) noexcept
      : path_(std::exchange(other.path_, {})), target_(std::move(other.target_)) {}
  SymbolicLink& operator=(SymbolicLink&&) = delete;
  ~SymbolicLink();

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
  /// Returns the device's end, which is non-blocking. poll() reports POLLHUP as long as no host has
  /// the other end open.
  int fd() const noexcept { return device_.get(); }
  const std::string& path() const noexcept { return path_; } ///< of the host's end

private:
  explicit PseudoTerminal(int fd) noexcept : device_(fd) {}

  UniqueFd device_;
  std::string path_;
  std::optional<SymbolicLink> link_; ///< last, so that it is removed first
};

} // namespace nendo::emulator
