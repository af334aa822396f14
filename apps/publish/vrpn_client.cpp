#include "publish/vrpn_client.hpp"

#include <cerrno>
#include <chrono>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include <nendo/driver/vrpn_protocol.hpp>

namespace nendo::publish::vrpn {
namespace {

constexpr std::chrono::seconds patience(5);
/// Answers to pings that wait. A client that sends more pings without reading is no client.
constexpr std::size_t max_waiting_bytes = std::size_t{64} << 10;

bool is_for_later(int error) noexcept {
  return error == EAGAIN || error == EINTR;
}

} // namespace

Client::Client(UniqueFd socket, HostTime now, const SocketAddress& asked_for)
    : socket_(std::move(socket)), asked_for_(asked_for), waiting_(driver::vrpn::greeting()),
      stalled_since_(now) {
  flush();
}

short Client::events() const noexcept {
  return static_cast<short>(waiting_.empty() ? POLLIN : POLLIN | POLLOUT);
}

void Client::serve(short events) {
  if ((events & (POLLIN | POLLERR | POLLHUP)) != 0) receive();
  if (!waiting_.empty()) flush();
}

void Client::receive() {
  std::array<std::byte, 4096> buffer;
  const ssize_t got = ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (got < 0 && is_for_later(errno)) return;
  if (got <= 0) {
    is_gone_ = true;
    return;
  }
  std::vector<std::size_t> pinged;
  is_gone_ = !requests_.push(std::span(buffer).first(static_cast<std::size_t>(got)), pinged);
  if (requests_.has_greeted() && !is_named_) {
    const Bytes all = names();
    waiting_.insert(waiting_.end(), all.begin(), all.end());
    is_named_ = true;
  }
  for (const std::size_t sender : pinged)
    append_pong(waiting_, sender);
  if (waiting_.size() > max_waiting_bytes) is_gone_ = true;
}

void Client::flush() {
  const ssize_t sent =
      ::send(socket_.get(), waiting_.data(), waiting_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent < 0) {
    is_gone_ = !is_for_later(errno);
    return;
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + sent);
}

void Client::offer(const Bytes& hands, const HandsRecord& record, std::int64_t time_us,
                   HostTime now) {
  if (!is_named_ || is_gone_) return;
  if (!waiting_.empty()) {
    ++missed_;
    return;
  }
  stalled_since_ = now;
  waiting_ = hands;
  for (std::size_t side = 0; side < 2; ++side) {
    const std::optional<bool> is_on = switch_of(record, side);
    if (!is_on || is_on == switches_[side]) continue;
    append_switch(waiting_, side, *is_on, time_us);
    switches_[side] = is_on;
  }
  if (!waiting_.empty()) flush();
}

bool Client::is_over(HostTime now) const noexcept {
  const bool is_stalled = !is_named_ || !waiting_.empty();
  return is_gone_ || (is_stalled && now - stalled_since_ > patience);
}

} // namespace nendo::publish::vrpn
