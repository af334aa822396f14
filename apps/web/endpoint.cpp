#include "web/endpoint.hpp"

#include <array>
#include <charconv>
#include <optional>

#include <arpa/inet.h>

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

std::optional<std::uint16_t> port_of(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return port;
}

bool is_address(std::string_view host, bool bracketed) {
  std::array<std::byte, sizeof(in6_addr)> binary{};
  const std::string text(host);
  return ::inet_pton(bracketed ? AF_INET6 : AF_INET, text.c_str(), binary.data()) == 1;
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
  if (const auto port = port_of(text)) {
    endpoint.port = *port;
    return endpoint;
  }
  const auto parts = split(text);
  if (!parts || !parts->port || !is_address(parts->host, parts->bracketed)) return wrong;
  const auto port = port_of(*parts->port);
  if (!port) return wrong;
  endpoint.address = parts->host;
  endpoint.port = *port;
  return endpoint;
}

bool is_address_or_localhost(std::string_view authority) {
  const auto parts = split(authority);
  if (!parts || authority.find('\0') != std::string_view::npos) return false;
  if (parts->port && !port_of(*parts->port)) return false;
  if (!parts->bracketed && parts->host == "localhost") return true;
  return is_address(parts->host, parts->bracketed);
}

} // namespace nendo::web
