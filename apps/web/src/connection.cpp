#include "connection.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include "http_request.hpp"

namespace nendo::web {

namespace {

constexpr std::chrono::milliseconds most_linger(2000);

} // namespace

SharedBytes shared_bytes(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
}

Connection::Connection(Descriptor socket, HostTime now, const ServerLimits& limits)
    : socket_(std::move(socket)), limits_(limits), since_(now), moved_(now), empty_(now),
      heard_(now), asked_(now), words_left_(limits.words_at_once), spoke_(now) {}

short Connection::events() const noexcept {
  return static_cast<short>((heard_end_ ? 0 : POLLIN) | (waiting_.empty() ? 0 : POLLOUT));
}

bool Connection::receive(HostTime now) {
  const std::size_t most = stage_ == Stage::socket ? ClientReader::most_pending : most_head_bytes;
  std::array<char, 4096> room;
  for (;;) {
    const bool keeps = stage_ == Stage::head || (stage_ == Stage::socket && !closes_);
    const std::size_t space =
        keeps ? std::min(room.size(), most - std::min(most, incoming_.size())) : room.size();
    if (space == 0) return true; // the rest comes when this has been looked at
    const ssize_t got = ::recv(fd(), room.data(), space, 0);
    if (got < 0) {
      if (errno == EINTR) continue;
      if (errno == EAGAIN || errno == EWOULDBLOCK) return true;
    }
    const bool may_wait = stage_ == Stage::head || stage_ == Stage::answer;
    if (got == 0 && may_wait && !heard_end_) { // `nc -N` does so, and waits
      heard_end_ = true;
      return true;
    }
    if (got <= 0) {
      stage_ = Stage::over;
      return false;
    }
    heard_ = now;
    if (!keeps) return true; // thrown away, a piece at a time
    incoming_.append(room.data(), static_cast<std::size_t>(got));
  }
}

void Connection::await_rest() noexcept {
  if (heard_end_) stage_ = Stage::over;
}

void Connection::queue(SharedBytes bytes, bool is_shape, HostTime now) {
  if (bytes->empty()) return;
  if (waiting_.empty()) moved_ = empty_ = now;
  if (is_shape)
    ++waiting_shapes_;
  else
    small_bytes_ += bytes->size();
  waiting_.push_back({std::move(bytes), is_shape});
  if (small_bytes_ > limits_.most_waiting) catching_up_ = true;
}

// The answer to a ping may be far behind a large shape.
void Connection::send_on(HostTime now) {
  heard_ = now;
  flush(now);
}

void Connection::flush(HostTime now) {
  while (!waiting_.empty()) {
    const auto& bytes = *waiting_.front().bytes;
    const ssize_t sent = ::send(fd(), bytes.data() + sent_of_first_, bytes.size() - sent_of_first_,
                                MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0) {
      if (errno == EINTR) continue;
      if (errno != EAGAIN && errno != EWOULDBLOCK) stage_ = Stage::over;
      return;
    }
    moved_ = now;
    sent_of_first_ += static_cast<std::size_t>(sent);
    if (sent_of_first_ < bytes.size()) continue;
    if (waiting_.front().is_shape)
      --waiting_shapes_;
    else
      small_bytes_ -= bytes.size();
    waiting_.pop_front();
    sent_of_first_ = 0;
  }
  moved_ = empty_ = now;
  catching_up_ = false;
  if (closes_ && stage_ != Stage::linger && stage_ != Stage::over) end_sending(now);
}

// A socket that is closed with bytes unread is reset, which takes back what was sent last.
void Connection::end_sending(HostTime now) {
  ::shutdown(fd(), SHUT_WR);
  stage_ = heard_end_ ? Stage::over : Stage::linger;
  since_ = now;
}

void Connection::answer(std::string head, SharedBytes body, HostTime now) {
  stage_ = Stage::answer;
  since_ = now;
  closes_ = true;
  queue(shared_bytes(head), false, now);
  if (body) queue(std::move(body), true, now);
  flush(now);
}

void Connection::upgrade(std::string head, HostTime now) {
  if (heard_end_) { // could answer no ping, nor say goodbye
    stage_ = Stage::over;
    return;
  }
  stage_ = Stage::socket;
  since_ = heard_ = asked_ = now;
  queue(shared_bytes(head), false, now);
  flush(now);
}

void Connection::send(Opcode opcode, const SharedBytes& payload, bool is_shape, HostTime now) {
  if (closes_) return;
  queue(shared_bytes(server_head(opcode, payload->size())), is_shape, now);
  queue(payload, is_shape, now);
  flush(now);
}

void Connection::send_control(std::string frame, HostTime now) {
  if (closes_ || catching_up_) return; // who floods with pings hears nothing
  queue(shared_bytes(frame), false, now);
  flush(now);
}

void Connection::close(CloseCode code, HostTime now) {
  if (closes_) return;
  queue(shared_bytes(close_frame(code)), false, now);
  closes_ = true;
  flush(now);
}

bool Connection::may_speak(HostTime now) noexcept {
  const double earned = limits_.words_a_second * to_seconds(now - spoke_);
  words_left_ = std::min(limits_.words_at_once, words_left_ + earned) - 1.0;
  spoke_ = now;
  return words_left_ >= 0.0;
}

bool Connection::is_overdue(HostTime now) const noexcept {
  if (stage_ == Stage::head) return now - since_ > limits_.head;
  if (stage_ == Stage::linger) return now - since_ > most_linger;
  const bool stalls = !waiting_.empty() && now - moved_ > limits_.stalled;
  if (stage_ != Stage::socket) return stalls; // a large model may take as long as it moves
  const bool lags = !waiting_.empty() && now - empty_ > limits_.lagging;
  return stalls || lags || now - heard_ > limits_.silent;
}

void Connection::keep_alive(HostTime now) {
  if (stage_ != Stage::socket || now - asked_ < limits_.ping) return;
  asked_ = now;
  send_control(control_frame(Opcode::ping, {}), now);
}

} // namespace nendo::web
