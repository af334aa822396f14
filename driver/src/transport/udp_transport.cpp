#include "transport/udp_transport.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <span>
#include <system_error>
#include <thread>
#include <utility>

#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <nendo/base/number_in.hpp>
#include <nendo/base/unique_fd.hpp>
#include <nendo/base/units.hpp>

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;

constexpr auto rate_window_of_reads = 10ms;
constexpr int max_reads_per_window = max_datagrams_per_s / 100;

struct AddressFreer {
  void operator()(addrinfo* list) const noexcept { ::freeaddrinfo(list); }
};
using AddressHandle = std::unique_ptr<addrinfo, AddressFreer>;

bool is_ipv6(const UdpEndpoint& endpoint) noexcept {
  return endpoint.address.find(':') != std::string::npos;
}

/// Returns the endpoint as bind() takes it, or null if the address is not numeric.
AddressHandle numeric_address(const UdpEndpoint& endpoint) {
  addrinfo wanted{};
  wanted.ai_family = is_ipv6(endpoint) ? AF_INET6 : AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(endpoint.port);
  if (::getaddrinfo(endpoint.address.c_str(), port.c_str(), &wanted, &found) != 0) return nullptr;
  return AddressHandle(found);
}

Error cannot_listen(const UdpEndpoint& endpoint, int error_number) {
  const std::string at = "port " + to_string(endpoint);
  switch (error_number) {
  case EADDRINUSE:
    return {Errc::no_device, at + " is in use by another program, or by another tracker of this "
                                  "one; choose another port"};
  case EADDRNOTAVAIL:
    return {Errc::no_device, at + " is not of this machine; `ip address` lists its addresses"};
  case EACCES:
    return {Errc::no_permission, at + ": ports below 1024 need rights; choose one above"};
  default:
    return {Errc::no_device, at + " cannot be opened (" +
                                 std::generic_category().message(error_number) +
                                 "); choose another address or port"};
  }
}

class UdpTransport final : public Transport {
public:
  explicit UdpTransport(UniqueFd socket) noexcept : socket_(std::move(socket)) {}

  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds timeout) noexcept override {
    const HostTime deadline = HostClock::now() + timeout;
    if (!await_window(deadline)) return {};
    pollfd entry{socket_.get(), POLLIN, 0};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - HostClock::now());
    if (::poll(&entry, 1, static_cast<int>(std::clamp<long>(left.count(), 0, 60'000))) <= 0)
      return {};
    const ssize_t count = receive(buffer);
    if (count > 0) return {IoStatus::done, static_cast<std::size_t>(count)};
    const bool none = count == 0 || errno == EAGAIN || errno == EINTR;
    return {none ? IoStatus::timeout : IoStatus::gone, 0};
  }

  IoStatus write_all(std::span<const std::byte> /*bytes*/,
                     std::chrono::milliseconds /*timeout*/) noexcept override {
    return IoStatus::timeout; // there is no one receiver
  }

  void discard_input() noexcept override {
    constexpr int max_datagrams = 4096; // more than the system's buffer holds
    std::byte first{};
    for (int count = 0; count < max_datagrams && receive(std::span(&first, 1)) >= 0; ++count) {
    }
  }

private:
  ssize_t receive(std::span<std::byte> buffer) const noexcept {
    return ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  }

  /// Waits until the rate allows another read. Returns false if that is after `deadline`.
  bool await_window(HostTime deadline) noexcept {
    HostTime now = HostClock::now();
    if (now - window_begin_ < rate_window_of_reads && reads_in_window_ == max_reads_per_window) {
      const HostTime end = window_begin_ + rate_window_of_reads;
      std::this_thread::sleep_until(std::min(end, deadline));
      if (end > deadline) return false;
      now = HostClock::now();
    }
    if (now - window_begin_ >= rate_window_of_reads) {
      window_begin_ = now;
      reads_in_window_ = 0;
    }
    ++reads_in_window_;
    return true;
  }

  const UniqueFd socket_;
  HostTime window_begin_{};
  int reads_in_window_ = 0;
};

} // namespace

Result<UdpEndpoint> parse_udp_endpoint(std::string_view text) {
  const Error wrong{Errc::usage, "use PORT or ADDRESS:PORT, with a numeric address and a port of 1 "
                                 "to 65535, as 9000, 0.0.0.0:9000 or [::1]:9000"};
  const std::size_t colon = text.rfind(':');
  const bool has_address = colon != std::string_view::npos;
  const auto port = number_in<std::uint16_t>(has_address ? text.substr(colon + 1) : text);
  if (!port || *port == 0) return wrong;
  UdpEndpoint endpoint;
  endpoint.port = *port;
  if (!has_address) return endpoint;
  std::string_view address = text.substr(0, colon);
  const bool bracketed = address.size() > 2 && address.front() == '[' && address.back() == ']';
  if (bracketed) address = address.substr(1, address.size() - 2);
  endpoint.address = address;
  if (address.empty() || bracketed != is_ipv6(endpoint) || !numeric_address(endpoint)) return wrong;
  return endpoint;
}

std::string to_string(const UdpEndpoint& endpoint) {
  const std::string host = is_ipv6(endpoint) ? "[" + endpoint.address + "]" : endpoint.address;
  return host + ":" + std::to_string(endpoint.port);
}

Result<std::unique_ptr<Transport>> open_udp(const UdpEndpoint& endpoint) {
  const AddressHandle address = numeric_address(endpoint);
  if (!address) return cannot_listen(endpoint, EADDRNOTAVAIL);
  // Without SO_REUSEADDR, which would let another program take the datagrams.
  UniqueFd socket(::socket(address->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return cannot_listen(endpoint, errno);
  const int yes = 1; // [::] does not include IPv4
  if (is_ipv6(endpoint)) ::setsockopt(socket.get(), IPPROTO_IPV6, IPV6_V6ONLY, &yes, sizeof yes);
  if (::bind(socket.get(), address->ai_addr, address->ai_addrlen) != 0)
    return cannot_listen(endpoint, errno);
  return std::unique_ptr<Transport>(std::make_unique<UdpTransport>(std::move(socket)));
}

} // namespace nendo::driver
