#include "serve/socket.hpp"

#include <algorithm>
#include <cerrno>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <nendo/base/system_error.hpp>
#include <nendo/base/text.hpp>

namespace nendo::serve {
namespace {

constexpr const char* another_name = "choose another name";
constexpr int max_waiting = 16; ///< connections that are not yet accepted

/// Makes the folder if it is missing. No other user may have it, who could put another socket
/// there.
Result<void> prepare_own(const std::string& folder) {
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    return system_error(printable(folder), "cannot be made",
                        "is XDG_RUNTIME_DIR a folder of yours?");
  struct stat status{};
  if (::lstat(folder.c_str(), &status) != 0)
    return system_error(printable(folder), "cannot be looked at",
                        "is XDG_RUNTIME_DIR a folder of yours?");
  if (!S_ISDIR(status.st_mode) || status.st_uid != ::geteuid() || (status.st_mode & 0022) != 0)
    return Error{Errc::no_permission, printable(folder) +
                                          ": must be a folder of yours in which no other user may "
                                          "write; remove it, or set XDG_RUNTIME_DIR"};
  return {};
}

Result<std::string> folder_in(const driver::ServeFolders& folders) {
  const bool is_service =
      !folders.services.empty() &&
      ::faccessat(AT_FDCWD, folders.services.c_str(), W_OK | X_OK, AT_EACCESS) == 0;
  if (is_service) return folders.services;
  if (folders.own.empty())
    return Error{Errc::failed,
                 "there is no place for the socket: XDG_RUNTIME_DIR is not set, and " +
                     printable(folders.services) +
                     " is not writable; set XDG_RUNTIME_DIR to a folder of yours"};
  if (auto prepared = prepare_own(folders.own); !prepared) return prepared.error();
  return folders.own;
}

/// Removes a dead server's socket; any other file stays. The caller has the lock.
Result<void> remove_stale(const std::string& path) {
  struct stat status{};
  if (::lstat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return {};
    return system_error(printable(path), "cannot be looked at", another_name);
  }
  if (!S_ISSOCK(status.st_mode) || status.st_uid != ::geteuid())
    return Error{Errc::failed,
                 printable(path) + ": is no socket of yours; remove it or " + another_name};
  if (::unlink(path.c_str()) != 0)
    return system_error(printable(path), "cannot be removed", another_name);
  return {};
}

} // namespace

Result<SocketTarget> parse_target(std::string_view text) {
  const auto wrong = [&](const std::string& what) {
    return Error{Errc::usage, in_quotes(text) + ": " + what};
  };
  SocketTarget target;
  const std::size_t mark = text.find('?');
  if (const std::string_view name = text.substr(0, mark); !name.empty()) target.name = name;
  if (!is_shared_name(target.name)) return wrong(std::string(shared_name_rule));
  if (mark == std::string_view::npos) return target;
  constexpr std::string_view key = "group=";
  const std::string_view option = text.substr(mark + 1);
  if (!option.starts_with(key))
    return wrong("unknown option; ?group=GROUP lets that group connect");
  target.group = group_named(std::string(option.substr(key.size())));
  if (!target.group) return wrong("no such group; getent group lists them");
  return target;
}

Result<Socket> Socket::claim(const SocketTarget& target, const driver::ServeFolders& folders) {
  const auto folder = folder_in(folders);
  if (!folder) return folder.error();
  const std::string path = driver::serve_socket(*folder, target.name);
  NameLock lock(*folder + "/." + target.name + ".lock");
  switch (lock.take()) {
  case NameLock::Outcome::taken:
    break;
  case NameLock::Outcome::held:
    return Error{Errc::failed, printable(path) +
                                   ": another program shares devices there; end it or " +
                                   another_name};
  case NameLock::Outcome::failed:
    return system_error(printable(lock.path()), "cannot be made", another_name);
  }
  Socket socket(target.name, path, std::move(lock));
  if (auto bound = socket.bind(target.group); !bound) return bound.error();
  return socket;
}

Result<void> Socket::bind(const std::optional<unsigned>& group) {
  if (auto removed = remove_stale(path_); !removed) return removed;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path_.size() >= sizeof address.sun_path)
    return Error{Errc::failed, printable(path_) + ": is longer than a socket's path may be (" +
                                   std::to_string(sizeof address.sun_path - 1) +
                                   " bytes); choose a shorter name, or XDG_RUNTIME_DIR"};
  std::copy(path_.begin(), path_.end(), address.sun_path);
  fd_ = UniqueFd(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  // The file gets this mode, less the umask; so it never has a wider one.
  if (!fd_.is_open() || ::fchmod(fd_.get(), 0600) != 0 ||
      ::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return system_error(printable(path_), "cannot be made", another_name);
  is_bound_ = true;
  if (::chmod(path_.c_str(), 0600) != 0)
    return system_error(printable(path_), "cannot be set up", another_name);
  if (!group) return {};
  if (::lchown(path_.c_str(), static_cast<uid_t>(-1), static_cast<gid_t>(*group)) != 0)
    return system_error(printable(path_), "cannot be given to the group",
                        "be a member of it (usermod -aG)");
  if (::chmod(path_.c_str(), 0660) != 0)
    return system_error(printable(path_), "cannot be made accessible to the group", another_name);
  return {};
}

Result<void> Socket::listen() {
  if (::listen(fd_.get(), max_waiting) != 0)
    return system_error(printable(path_), "cannot be listened at", another_name);
  return {};
}

Socket::Socket(Socket&& other) noexcept
    : name_(std::move(other.name_)), path_(std::move(other.path_)), lock_(std::move(other.lock_)),
      fd_(std::move(other.fd_)), is_bound_(std::exchange(other.is_bound_, false)) {}

// The lock is still held, so that the file is this server's.
Socket::~Socket() {
  if (is_bound_) ::unlink(path_.c_str());
}

} // namespace nendo::serve
