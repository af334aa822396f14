#include "serve/client.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include "serve/lines.hpp"

namespace nendo::serve {
namespace {

/// The time that a client has to read its error.
constexpr std::chrono::milliseconds closing_time{500};

} // namespace

Client::Client(UniqueFd socket, std::string introduction, std::size_t devices)
    : socket_(std::move(socket)), rest_(std::move(introduction)), waiting_(devices) {
  flush();
}

// Further requests wait in the socket until the answers are sent, so `rest_` cannot grow.
short Client::events() const noexcept {
  const bool reads = may_ask_ && !is_closing_ && rest_.empty();
  return static_cast<short>((reads ? POLLIN : 0) | (is_full_ ? POLLOUT : 0));
}

bool Client::is_over(HostTime now) const noexcept {
  const bool is_closed = is_closing_ && (rest_.empty() || now - closing_since_ > closing_time);
  const bool is_idle = !may_ask_ && !watch_.samples && !watch_.hands && rest_.empty();
  return is_gone_ || is_closed || is_idle;
}

void Client::serve(short events, HostTime now) {
  if ((events & (POLLHUP | POLLERR | POLLNVAL)) != 0) is_gone_ = true;
  if (is_gone_) return;
  if ((events & POLLOUT) != 0) {
    is_full_ = false;
    flush();
    send_waiting();
  }
  if ((events & POLLIN) != 0) receive(now);
}

void Client::receive(HostTime now) {
  std::array<char, max_request_bytes> buffer;
  const ssize_t got = ::recv(fd(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (got < 0) {
    is_gone_ = errno != EAGAIN && errno != EINTR;
    return;
  }
  incoming_.append(buffer.data(), static_cast<std::size_t>(got));
  if (got == 0) {
    may_ask_ = false;
    if (!incoming_.empty()) incoming_ += '\n';
  }
  take_requests(now);
}

void Client::take_requests(HostTime now) {
  std::size_t begin = 0;
  while (!is_closing_) {
    const std::size_t end = incoming_.find('\n', begin);
    const std::size_t length = std::min(end, incoming_.size()) - begin;
    if (length >= max_request_bytes) return refuse("a request has at most 4096 bytes", now);
    if (end == std::string::npos) break;
    handle(std::string_view(incoming_).substr(begin, length), now);
    begin = end + 1;
  }
  incoming_.erase(0, begin);
}

void Client::handle(std::string_view request, HostTime now) {
  if (now - requests_since_ > std::chrono::seconds(1)) {
    requests_since_ = now;
    requests_ = 0;
  }
  if (++requests_ > max_requests_per_s)
    return refuse("a client sends at most 100 requests per second", now);
  const auto watch = changed(watch_, request);
  if (!watch) return refuse(watch.error().message, now);
  if (watch->samples != watch_.samples) std::fill(waiting_.begin(), waiting_.end(), Waiting{});
  if (watch->hands != watch_.hands) skipped_ = 0;
  watch_ = *watch;
  next_hands_ = now;
  answer(watch_line(watch_) + "\n");
}

void Client::refuse(std::string_view why, HostTime now) {
  is_closing_ = true;
  closing_since_ = now;
  answer(error_line(why) + "\n");
}

void Client::answer(const std::string& line) {
  rest_ += line;
  if (!is_full_) flush();
}

void Client::offer(std::size_t device, const std::string& object) {
  Waiting& line = waiting_[device];
  if (!is_full_ && try_send(with_count(object, "dropped", line.dropped))) {
    line.dropped = 0;
    return;
  }
  if (!line.object.empty()) {
    ++line.dropped;
    ++dropped_;
  }
  line.object = object;
}

void Client::count_lost(std::uint64_t lines) noexcept {
  for (Waiting& line : waiting_)
    line.dropped += lines;
  dropped_ += lines * waiting_.size();
}

void Client::offer_hands(const std::string& object, HostTime now) {
  const HostClock::duration period = from_seconds(1.0 / watch_.rate_hz);
  next_hands_ += period;
  if (next_hands_ <= now) next_hands_ = now + period;
  if (!is_full_ && try_send(with_count(object, "skipped", skipped_))) {
    skipped_ = 0;
    return;
  }
  ++skipped_;
  ++dropped_;
}

std::uint64_t Client::take_dropped() noexcept {
  return std::exchange(dropped_, 0);
}

void Client::flush() {
  while (!is_full_ && !rest_.empty())
    rest_.erase(0, send_now(rest_));
}

void Client::send_waiting() {
  for (Waiting& line : waiting_) {
    if (line.object.empty()) continue;
    if (is_full_ || !try_send(with_count(line.object, "dropped", line.dropped))) return;
    line = {};
  }
}

bool Client::try_send(const std::string& line) {
  const std::size_t sent = send_now(line);
  if (sent == 0) return false;
  rest_ = line.substr(sent);
  flush();
  return true;
}

std::size_t Client::send_now(std::string_view bytes) {
  const ssize_t sent = ::send(fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent >= 0) return static_cast<std::size_t>(sent);
  is_full_ = true;
  if (errno != EAGAIN && errno != EINTR && errno != ENOBUFS) is_gone_ = true;
  return 0;
}

} // namespace nendo::serve
