#include <nendo/base/endpoint.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/tcp.h>

#include <nendo/base/number_in.hpp>

namespace nendo {
namespace {

constexpr int max_waiting_connections = 16;

Error cannot_open(const Endpoint& endpoint, int error) {
  const std::string at = endpoint.authority();
  switch (error) {
  case EADDRINUSE:
    return {Errc::failed,
            at + " is in use, by another program or by this one; choose another port"};
  case EADDRNOTAVAIL:
    return {Errc::failed, at + " is not of this machine; `ip address` lists its addresses"};
  case EACCES:
    return {Errc::no_permission, at + ": ports below 1024 need rights; choose one above"};
  default:
    return {Errc::failed, at + " cannot be opened (" + std::generic_category().message(error) +
                              "); choose another address or port"};
  }
}

/// Fills in an address of IPv6, which may have a zone. Returns false if it is none.
bool read_ipv6(const Endpoint& endpoint, SocketAddress& to) {
  addrinfo wanted{};
  wanted.ai_family = AF_INET6;
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(endpoint.port);
  if (::getaddrinfo(endpoint.address.c_str(), port.c_str(), &wanted, &found) != 0) return false;
  to.length = std::min<socklen_t>(found->ai_addrlen, sizeof to.address);
  std::memcpy(&to.address, found->ai_addr, to.length);
  ::freeaddrinfo(found);
  return true;
}

bool read_ipv4(const Endpoint& endpoint, SocketAddress& to) noexcept {
  to.address.v4.sin_family = AF_INET;
  to.address.v4.sin_port = htons(endpoint.port);
  to.length = sizeof to.address.v4;
  return ::inet_pton(AF_INET, endpoint.address.c_str(), &to.address.v4.sin_addr) == 1;
}

bool read_address(const Endpoint& endpoint, SocketAddress& to) {
  return endpoint.is_ipv6() ? read_ipv6(endpoint, to) : read_ipv4(endpoint, to);
}

void set_up_stream(const UniqueFd& socket, std::size_t send_buffer_bytes) {
  const int yes = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  const int bytes = static_cast<int>(send_buffer_bytes);
  ::setsockopt(socket.get(), SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
}

} // namespace

std::string Endpoint::authority() const {
  return (is_ipv6() ? "[" + address + "]" : address) + ":" + std::to_string(port);
}

SocketAddress Endpoint::socket_address() const {
  SocketAddress to;
  return read_address(*this, to) ? to : SocketAddress{};
}

Endpoint endpoint_of(const SocketAddress& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const bool is_ipv6 = address.address.any.sa_family == AF_INET6;
  if (is_ipv6) {
    ::inet_ntop(AF_INET6, &address.address.v6.sin6_addr, text.data(), text.size());
    return {text.data(), ntohs(address.address.v6.sin6_port)};
  }
  ::inet_ntop(AF_INET, &address.address.v4.sin_addr, text.data(), text.size());
  return {text.data(), ntohs(address.address.v4.sin_port)};
}

Result<Endpoint> parse_endpoint(std::string_view text, std::uint16_t min_port) {
  const Error wrong{Errc::usage, std::string(endpoint_rule)};
  Endpoint endpoint;
  const std::size_t colon = text.rfind(':');
  const bool has_address = colon != std::string_view::npos;
  const auto port = number_in<std::uint16_t>(has_address ? text.substr(colon + 1) : text);
  if (!port || *port < min_port) return wrong;
  endpoint.port = *port;
  if (!has_address) return endpoint;
  std::string_view address = text.substr(0, colon);
  const bool bracketed = address.size() > 2 && address.front() == '[' && address.back() == ']';
  if (bracketed) address = address.substr(1, address.size() - 2);
  endpoint.address = address;
  const bool has_nul = address.find('\0') != std::string_view::npos;
  SocketAddress ignored;
  if (has_nul || bracketed != endpoint.is_ipv6() || !read_address(endpoint, ignored)) return wrong;
  return endpoint;
}

Result<UniqueFd> open_at(Endpoint& endpoint, int type) {
  SocketAddress address = endpoint.socket_address();
  UniqueFd socket(::socket(address.address.any.sa_family, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return cannot_open(endpoint, errno);
  const int yes = 1;
  // So that a run can take the port of a run that has just ended. With datagrams it would let
  // another program take them.
  if (type == SOCK_STREAM) ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (endpoint.is_ipv6()) ::setsockopt(socket.get(), IPPROTO_IPV6, IPV6_V6ONLY, &yes, sizeof yes);
  if (::bind(socket.get(), &address.address.any, address.length) != 0 ||
      (type == SOCK_STREAM && ::listen(socket.get(), max_waiting_connections) != 0) ||
      ::getsockname(socket.get(), &address.address.any, &address.length) != 0)
    return cannot_open(endpoint, errno);
  endpoint.port = endpoint_of(address).port;
  return socket;
}

bool operator==(const SocketAddress& one, const SocketAddress& other) noexcept {
  return one.length == other.length && std::memcmp(&one.address, &other.address, one.length) == 0;
}

std::optional<UniqueFd> accept_from(const UniqueFd& listener, std::size_t send_buffer_bytes) {
  UniqueFd socket(::accept4(listener.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.is_open()) return std::nullopt;
  set_up_stream(socket, send_buffer_bytes);
  return socket;
}

std::optional<UniqueFd> begin_to_connect(const SocketAddress& to, std::size_t send_buffer_bytes) {
  UniqueFd socket(
      ::socket(to.address.any.sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return std::nullopt;
  set_up_stream(socket, send_buffer_bytes);
  if (::connect(socket.get(), &to.address.any, to.length) != 0 && errno != EINPROGRESS)
    return std::nullopt;
  return socket;
}

} // namespace nendo
