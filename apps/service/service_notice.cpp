#include "service/service_notice.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace nendo::service {

ServiceNotice::ServiceNotice() {
  const char* const path = std::getenv("NOTIFY_SOCKET"); // NOLINT(concurrency-mt-unsafe): early
  if (path == nullptr || (path[0] != '/' && path[0] != '@')) return;
  socket_path_ = path;
  ::unsetenv("NOTIFY_SOCKET"); // NOLINT(concurrency-mt-unsafe)
  if (socket_path_.size() < sizeof(sockaddr_un::sun_path))
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

ServiceNotice::~ServiceNotice() {
  if (ready_) send("STOPPING=1");
  if (socket_ >= 0) ::close(socket_);
}

void ServiceNotice::alive() noexcept {
  if (socket_ < 0) return;
  send(ready_ ? "WATCHDOG=1" : "READY=1\nWATCHDOG=1");
  ready_ = true;
}

void ServiceNotice::send(std::string_view text) const noexcept {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(socket_path_.begin(), socket_path_.end(), address.sun_path);
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0'; // an abstract name (unix(7))
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_path_.size());
  ::sendto(socket_, text.data(), text.size(), MSG_NOSIGNAL,
           reinterpret_cast<const sockaddr*>(&address), length);
}

} // namespace nendo::service
