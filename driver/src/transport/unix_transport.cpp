#include "transport/unix_transport.hpp"

#include <algorithm>
#include <cerrno>
#include <optional>
#include <system_error>
#include <utility>

#include <sys/socket.h>
#include <sys/un.h>

#include <nendo/base/text.hpp>
#include <nendo/base/unique_fd.hpp>

#include "transport/socket_transport.hpp"

namespace nendo::driver {
namespace {

std::optional<sockaddr_un> unix_address(const std::string& path) noexcept {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return std::nullopt;
  std::copy(path.begin(), path.end(), address.sun_path);
  return address;
}

/// Returns 0 and the connected socket, or an error number.
int connect_unix(const std::string& path, UniqueFd& connected) {
  const auto address = unix_address(path);
  if (!address) return ENAMETOOLONG;
  UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd.is_open()) return errno;
  if (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0)
    return errno;
  connected = std::move(fd);
  return 0;
}

/// Whether the error says that nothing listens there.
bool is_absent(int error) noexcept {
  return error == ENOENT || error == ENOTDIR || error == ECONNREFUSED;
}

std::string listed_paths(const std::vector<std::string>& paths) {
  std::string list;
  for (const std::string& path : paths)
    list += (list.empty() ? "" : ", nor at ") + printable(path);
  return list;
}

} // namespace

Result<std::unique_ptr<Transport>> UnixConnector::connect() {
  int error = ENOENT;
  for (std::size_t at = 0; at < paths_.size(); ++at) {
    UniqueFd fd;
    const int here = connect_unix(paths_[at], fd);
    if (here == 0) {
      connected_ = at;
      ++connections_;
      return transport_of_socket(std::move(fd));
    }
    if (!is_absent(here)) {
      error = here;
      connected_ = at;
    }
  }
  if (is_absent(error))
    return Error{Errc::no_device, name_ + ": no program shares devices at " + listed_paths(paths_) +
                                      "; start `nendo serve`"};
  const std::string there = name_ + ": " + printable(path());
  switch (error) {
  case EACCES:
    return Error{Errc::no_permission, there + " is another user's; let its server name a "
                                              "group that you are in"};
  case EAGAIN:
    return Error{Errc::no_device,
                 there + " accepts no connections; is its program stuck? Restart it"};
  default:
    return Error{Errc::no_device,
                 there + " cannot be connected to: " + std::generic_category().message(error) +
                     "; is it the socket of `nendo serve`?"};
  }
}

} // namespace nendo::driver
