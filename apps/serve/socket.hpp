#pragma once
// The server's socket: its name, its place, and who may connect.

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/base/result.hpp>
#include <nendo/base/shared_name.hpp>
#include <nendo/base/unique_fd.hpp>
#include <nendo/driver/serve_place.hpp>

namespace nendo::serve {

struct SocketTarget {
  std::string name{driver::default_serve_name};
  std::optional<unsigned> group{}; ///< that may also connect
};

/// Parses `NAME`, `NAME?group=GROUP`, `?group=GROUP` or an empty text. Looks up the group. Error:
/// usage, in a message that begins with the text.
Result<SocketTarget> parse_target(std::string_view text);

/// A bound socket that does not listen yet, so that clients are refused and need not wait while
/// devices are opened.
class Socket {
public:
  /// Binds NAME.sock in the folder of services, if it exists and this user may write there, or else
  /// in this user's own, which is made if needed. Replaces the socket that a dead server left. Only
  /// this user and the group may connect. Does not block. Errors: failed (a server has the name,
  /// there is another file, there is no folder), no_permission.
  static Result<Socket> claim(const SocketTarget& target,
                              const driver::ServeFolders& folders = driver::serve_folders());
  /// Removes the socket's file, and releases the name.
  ~Socket();
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&&) = delete;

  /// From now on clients can connect. Error: failed.
  Result<void> listen();
  int fd() const noexcept { return fd_.get(); }
  const std::string& path() const noexcept { return path_; }
  const std::string& name() const noexcept { return name_; }

private:
  Socket(std::string name, std::string path, NameLock lock)
      : name_(std::move(name)), path_(std::move(path)), lock_(std::move(lock)) {}
  Result<void> bind(const std::optional<unsigned>& group);

  std::string name_;
  std::string path_;
  NameLock lock_; ///< shows that the server lives
  UniqueFd fd_;
  bool is_bound_ = false;
};

} // namespace nendo::serve
