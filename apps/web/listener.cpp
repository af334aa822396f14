#include "web/listener.hpp"

#include <cerrno>
#include <cstring>
#include <string>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace nendo::web {
namespace {

// The system's calls take addresses of all families by a pointer to their common head.
template <class Address>
sockaddr* as_any(Address& address) noexcept {
  return reinterpret_cast<sockaddr*>(&address);
}

Error refused(const Endpoint& endpoint, int error) {
  const std::string at = "--web " + endpoint.authority() + ": ";
  if (error == EADDRINUSE)
    return {Errc::failed, at + "another program listens there; choose another port, or 0 for any"};
  if (error == EACCES) return {Errc::failed, at + "ports below 1024 need rights; choose one above"};
  if (error == EADDRNOTAVAIL)
    return {Errc::failed, at + "that is no address of this machine; `ip address` lists them"};
  return {Errc::failed, at + std::strerror(error) + "; choose another address or port"};
}

int bind_to(const UniqueFd& socket, const Endpoint& endpoint) {
  if (endpoint.is_ipv6()) {
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_port = htons(endpoint.port);
    ::inet_pton(AF_INET6, endpoint.address.c_str(), &address.sin6_addr);
    return ::bind(socket.get(), as_any(address), sizeof address);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  ::inet_pton(AF_INET, endpoint.address.c_str(), &address.sin_addr);
  return ::bind(socket.get(), as_any(address), sizeof address);
}

} // namespace

Result<UniqueFd> listen_at(Endpoint& endpoint) {
  const int family = endpoint.is_ipv6() ? AF_INET6 : AF_INET;
  UniqueFd socket(::socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return refused(endpoint, errno);
  const int yes = 1; // so that a run can take the port of a run that has just ended
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (endpoint.is_ipv6()) // [::] does not include IPv4
    ::setsockopt(socket.get(), IPPROTO_IPV6, IPV6_V6ONLY, &yes, sizeof yes);
  if (bind_to(socket, endpoint) != 0 || ::listen(socket.get(), 16) != 0)
    return refused(endpoint, errno);
  sockaddr_in6 bound{}; // sockaddr_in has its port in the same place
  socklen_t length = sizeof bound;
  if (::getsockname(socket.get(), as_any(bound), &length) != 0) return refused(endpoint, errno);
  endpoint.port = ntohs(bound.sin6_port);
  return socket;
}

std::optional<UniqueFd> accept_from(const UniqueFd& listener, std::size_t buffer_bytes) {
  UniqueFd socket(::accept4(listener.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.is_open()) return std::nullopt;
  const int yes = 1; // updates are small, and must not wait for more
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  const int bytes = static_cast<int>(buffer_bytes);
  ::setsockopt(socket.get(), SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  return socket;
}

} // namespace nendo::web
