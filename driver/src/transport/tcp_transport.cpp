#include "transport/tcp_transport.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <future>
#include <system_error>
#include <thread>
#include <utility>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>

#include <nendo/base/unique_fd.hpp>
#include <nendo/base/units.hpp>

#include "transport/fd_io.hpp"
#include "transport/socket_transport.hpp"

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;

constexpr auto look_up_time = 1s;
constexpr auto first_connect_time = 1s;
constexpr auto connect_time = 500ms; ///< a stop of the reader waits for it
constexpr int max_unconfirmed_ms = 2000;

/// What getaddrinfo() answers.
struct Found {
  int error = 0; ///< EAI_...; 0 if there are addresses
  std::vector<SocketAddress> addresses;
};

Found look_up(const std::string& host, std::uint16_t port, int flags) {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* first = nullptr;
  Found found;
  found.error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &first);
  if (found.error != 0) return found;
  for (const addrinfo* at = first; at != nullptr; at = at->ai_next) {
    SocketAddress& address = found.addresses.emplace_back();
    address.length = std::min<socklen_t>(at->ai_addrlen, sizeof address.address);
    std::memcpy(&address.address, at->ai_addr, address.length);
  }
  ::freeaddrinfo(first);
  return found;
}

Error not_found(const std::string& host, int error) {
  const std::string what =
      error == EAI_NONAME  ? "no such host; is the name right?"
      : error == EAI_AGAIN ? "its name cannot be looked up now; is the network up?"
                           : "its name cannot be looked up: " + std::string(gai_strerror(error));
  return {Errc::no_device, host + ": " + what};
}

/// A lookup cannot be ended, and may take many seconds. So a thread of its own does it, and is left
/// alone if it takes too long.
Result<std::vector<SocketAddress>> resolve(const std::string& host, std::uint16_t port) {
  if (Found numeric = look_up(host, port, AI_NUMERICHOST); numeric.error == 0)
    return std::move(numeric.addresses);
  std::promise<Found> promise;
  std::future<Found> answer = promise.get_future();
  try {
    std::thread([promise = std::move(promise), host, port]() mutable {
      promise.set_value(look_up(host, port, 0));
    }).detach();
  } catch (const std::system_error& error) {
    return Error{Errc::no_device, host + ": no thread to look the name up: " + error.what()};
  }
  if (answer.wait_for(look_up_time) != std::future_status::ready)
    return Error{Errc::no_device, host + ": the lookup of the name takes longer than 1 s; is the "
                                         "network up? A numeric address needs no lookup"};
  Found found = answer.get();
  if (found.error != 0) return not_found(host, found.error);
  return std::move(found.addresses);
}

/// Returns 0 and the connected socket, or an error number.
int connect_socket(const SocketAddress& to, HostTime deadline, UniqueFd& connected) {
  UniqueFd fd(::socket(to.address.any.sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd.is_open()) return errno;
  const int on = 1;
  ::setsockopt(fd.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  ::setsockopt(fd.get(), IPPROTO_TCP, TCP_USER_TIMEOUT, &max_unconfirmed_ms,
               sizeof max_unconfirmed_ms);
  if (::connect(fd.get(), &to.address.any, to.length) != 0) {
    if (errno != EINPROGRESS) return errno;
    if (wait_fd(fd.get(), POLLOUT, deadline) == IoStatus::timeout) return ETIMEDOUT;
    int error = 0;
    socklen_t length = sizeof error;
    if (::getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &error, &length) != 0) return errno;
    if (error != 0) return error;
  }
  connected = std::move(fd);
  return 0;
}

Error not_connected(const std::string& name, int error) {
  switch (error) {
  case ECONNREFUSED:
    return {Errc::no_device,
            name + ": no program accepts connections there; is the server started, and is the "
                   "port right?"};
  case ETIMEDOUT:
    return {Errc::no_device, name + ": no answer; is the address right, is the machine on, and "
                                    "does its firewall let the port through?"};
  default:
    return {Errc::no_device, name + ": cannot connect: " + std::generic_category().message(error) +
                                 "; is this machine in the server's network?"};
  }
}

} // namespace

TcpConnector::TcpConnector(std::string host, std::uint16_t port)
    : host_(std::move(host)), port_(port) {}

std::string TcpConnector::name() const {
  return Endpoint{host_, port_}.authority();
}

Result<std::unique_ptr<Transport>> TcpConnector::connect() {
  if (addresses_.empty()) {
    auto found = resolve(host_, port_);
    if (!found) return found.error();
    addresses_ = *std::move(found);
  }
  const HostTime begin = HostClock::now();
  const HostClock::duration time = connections_ == 0 ? first_connect_time : connect_time;
  int error = EADDRNOTAVAIL;
  for (std::size_t at = 0; at < addresses_.size(); ++at) {
    // The addresses share the time, so that one that does not answer leaves some to the next.
    const auto share = static_cast<std::int64_t>(at + 1);
    const HostTime deadline = begin + time * share / static_cast<std::int64_t>(addresses_.size());
    UniqueFd fd;
    error = connect_socket(addresses_[at], deadline, fd);
    if (error != 0) continue;
    ++connections_;
    return transport_of_socket(std::move(fd));
  }
  return not_connected(name(), error);
}

} // namespace nendo::driver
