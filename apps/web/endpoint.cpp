#include "web/endpoint.hpp"

#include <array>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <nendo/base/number_in.hpp>

namespace nendo::web {
namespace {

struct Split {
  std::string_view host; ///< without brackets
  std::optional<std::string_view> port;
  bool bracketed = false;
};

std::optional<Split> split(std::string_view authority) {
  if (!authority.starts_with('[')) {
    const auto colon = authority.find(':');
    if (colon == std::string_view::npos) return Split{authority, std::nullopt};
    return Split{authority.substr(0, colon), authority.substr(colon + 1)};
  }
  const auto end = authority.find(']');
  if (end == std::string_view::npos) return std::nullopt;
  const auto host = authority.substr(1, end - 1);
  const auto rest = authority.substr(end + 1);
  if (rest.empty()) return Split{host, std::nullopt, true};
  if (rest.front() != ':') return std::nullopt;
  return Split{host, rest.substr(1), true};
}

bool is_address(std::string_view host, bool bracketed) {
  std::array<std::byte, sizeof(in6_addr)> binary{};
  const std::string text(host);
  return ::inet_pton(bracketed ? AF_INET6 : AF_INET, text.c_str(), binary.data()) == 1;
}

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

std::string Endpoint::authority() const {
  return (is_ipv6() ? "[" + address + "]" : address) + ":" + std::to_string(port);
}

Result<Endpoint> parse_endpoint(std::string_view text) {
  const Error wrong{Errc::usage, "--web " + std::string(text) +
                                     ": use PORT or ADDR:PORT, an address in figures, as "
                                     "8080, 192.168.1.5:8080 or [::1]:8080"};
  if (text.find('\0') != std::string_view::npos) return wrong;
  Endpoint endpoint;
  if (const auto port = number_in<std::uint16_t>(text)) {
    endpoint.port = *port;
    return endpoint;
  }
  const auto parts = split(text);
  if (!parts || !parts->port || !is_address(parts->host, parts->bracketed)) return wrong;
  const auto port = number_in<std::uint16_t>(*parts->port);
  if (!port) return wrong;
  endpoint.address = parts->host;
  endpoint.port = *port;
  return endpoint;
}

bool is_address_or_localhost(std::string_view authority) {
  const auto parts = split(authority);
  if (!parts || authority.find('\0') != std::string_view::npos) return false;
  if (parts->port && !number_in<std::uint16_t>(*parts->port)) return false;
  if (!parts->bracketed && parts->host == "localhost") return true;
  return is_address(parts->host, parts->bracketed);
}

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
