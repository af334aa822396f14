#include "publish/vrpn_server.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <utility>

#include <sys/socket.h>

#include <nendo/base/number_in.hpp>
#include <nendo/base/utc.hpp>
#include <nendo/driver/vrpn_protocol.hpp>

namespace nendo::publish::vrpn {
namespace {

/// Small, because its contents can no longer be replaced by newer hands: some 20 ticks.
constexpr std::size_t send_buffer_bytes = std::size_t{64} << 10;
constexpr std::size_t max_datagram_bytes = 128;

void set_port(SocketAddress& address, std::uint16_t port) noexcept {
  if (address.address.any.sa_family == AF_INET6) {
    address.address.v6.sin6_port = htons(port);
  } else {
    address.address.v4.sin_port = htons(port);
  }
}

} // namespace

std::uint16_t asked_port(std::span<const std::byte> datagram) noexcept {
  constexpr std::uint16_t first_free_port = 1024; // those below are of services
  const std::string_view text = driver::vrpn::text_of(datagram);
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos) return 0;
  const auto port = number_in<std::uint16_t>(text.substr(blank + 1));
  return port && *port >= first_free_port ? *port : std::uint16_t{0};
}

Result<Server> Server::open(Endpoint endpoint) {
  auto listener = open_at(endpoint, SOCK_STREAM);
  if (!listener) return listener.error();
  auto asked = open_at(endpoint, SOCK_DGRAM);
  if (!asked) return asked.error();
  return Server(std::move(endpoint), *std::move(listener), *std::move(asked));
}

Server::Server(Endpoint endpoint, UniqueFd listener, UniqueFd asked)
    : endpoint_(std::move(endpoint)), listener_(std::move(listener)), asked_(std::move(asked)) {}

void Server::serve() {
  polled_.clear();
  polled_.push_back({listener_.get(), POLLIN, 0});
  polled_.push_back({asked_.get(), POLLIN, 0});
  for (const Client& client : clients_)
    polled_.push_back({client.fd(), client.events(), 0});
  if (::poll(polled_.data(), polled_.size(), 0) > 0) {
    std::size_t at = 2;
    for (Client& client : clients_)
      if (const short events = polled_[at++].revents; events != 0) client.serve(events);
  }
  const HostTime now = HostClock::now();
  if (polled_[0].revents != 0) accept_new(now);
  if (polled_[1].revents != 0) connect_to_asking(now);
  clients_.remove_if([&](const Client& client) {
    if (!client.is_over(now)) return false;
    counts_.missed += client.missed();
    return true;
  });
}

void Server::accept_new(HostTime now) {
  while (auto socket = accept_from(listener_, send_buffer_bytes)) {
    const bool is_full = clients_.size() == max_clients;
    ++(is_full ? counts_.refused : counts_.clients);
    if (!is_full) clients_.emplace_back(*std::move(socket), now);
  }
}

/// One datagram per call, so that a flood takes no more time than this. VRPN's client asks again
/// until it is connected to.
void Server::connect_to_asking(HostTime now) {
  std::array<std::byte, max_datagram_bytes> bytes;
  SocketAddress from;
  from.length = sizeof from.address;
  const ssize_t got = ::recvfrom(asked_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT,
                                 &from.address.any, &from.length);
  const std::uint16_t port =
      got <= 0 ? 0 : asked_port(std::span(bytes).first(static_cast<std::size_t>(got)));
  if (port == 0) return;
  set_port(from, port);
  if (is_client(from)) return;
  if (clients_.size() == max_clients) {
    ++counts_.refused;
    return;
  }
  auto socket = begin_to_connect(from, send_buffer_bytes);
  if (!socket) return;
  ++counts_.clients;
  clients_.emplace_back(*std::move(socket), now, from);
}

bool Server::is_client(const SocketAddress& address) const {
  return std::any_of(clients_.begin(), clients_.end(),
                     [&](const Client& client) { return client.asked_for() == address; });
}

void Server::send(const HandsRecord& record) {
  if (clients_.empty()) return;
  const HostTime now = HostClock::now();
  const std::int64_t time_us =
      utc_ns(HostTime(std::chrono::nanoseconds(record.record.woke_ns))) / 1000;
  Bytes hands;
  append_hands(hands, record, time_us);
  for (Client& client : clients_)
    client.offer(hands, record, time_us, now);
}

ServerCounts Server::counts() const {
  ServerCounts all = counts_;
  for (const Client& client : clients_)
    all.missed += client.missed();
  return all;
}

} // namespace nendo::publish::vrpn
