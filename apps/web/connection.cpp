#include "web/connection.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include "web/http_request.hpp"
#include "web/server.hpp"

namespace nendo::web {

namespace {

constexpr std::chrono::milliseconds linger_timeout(2000);
constexpr std::chrono::minutes body_timeout(2);            ///< the time of a whole file
constexpr std::size_t max_received = std::size_t{1} << 18; ///< bytes of a file in one turn

} // namespace

SharedBytes shared_bytes(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
}

Connection::Connection(UniqueFd socket, HostTime now, const ServerLimits& limits)
    : socket_(std::move(socket)), limits_(limits), stage_since_(now), last_progress_(now),
      queue_empty_(now), last_heard_(now), last_ping_(now), messages_left_(limits.message_burst),
      last_message_(now) {}

short Connection::events() const noexcept {
  return static_cast<short>((peer_closed_ ? 0 : POLLIN) | (queue_.empty() ? 0 : POLLOUT));
}

bool Connection::receive(HostTime now) {
  const std::size_t most = stage_ == Stage::socket ? ClientReader::max_pending
                           : stage_ == Stage::body
                               ? std::min(body_bytes_, incoming_.size() + max_received)
                               : max_head_bytes;
  std::array<char, 4096> buffer;
  for (;;) {
    const bool keeps =
        stage_ == Stage::head || stage_ == Stage::body || (stage_ == Stage::socket && !closing_);
    const std::size_t space =
        keeps ? std::min(buffer.size(), most - std::min(most, incoming_.size())) : buffer.size();
    if (space == 0) return true; // the rest is read when this has been parsed
    const ssize_t got = ::recv(fd(), buffer.data(), space, 0);
    if (got < 0) {
      if (errno == EINTR) continue;
      if (errno == EAGAIN || errno == EWOULDBLOCK) return true;
    }
    const bool may_wait = stage_ == Stage::head || stage_ == Stage::answer;
    if (got == 0 && may_wait && !peer_closed_) { // as `nc -N` does, which waits for the answer
      peer_closed_ = true;
      return true;
    }
    if (got <= 0) {
      stage_ = Stage::ended;
      return false;
    }
    last_heard_ = now;
    if (!keeps) return true; // discarded, one piece a turn
    incoming_.append(buffer.data(), static_cast<std::size_t>(got));
  }
}

void Connection::begin_body(std::size_t head_bytes, std::size_t body_bytes, HostTime now) {
  incoming_.erase(0, head_bytes);
  body_bytes_ = body_bytes;
  if (incoming_.size() > body_bytes) incoming_.resize(body_bytes); // what follows is no request
  const bool is_lost = peer_closed_ && incoming_.size() < body_bytes;
  stage_ = is_lost ? Stage::ended : Stage::body;
  stage_since_ = last_heard_ = now;
}

void Connection::await_more() noexcept {
  if (peer_closed_) stage_ = Stage::ended;
}

void Connection::queue(SharedBytes bytes, bool is_shape, HostTime now) {
  if (bytes->empty()) return;
  if (queue_.empty()) last_progress_ = queue_empty_ = now;
  if (is_shape)
    ++queued_shapes_;
  else
    queued_bytes_ += bytes->size();
  queue_.push_back({std::move(bytes), is_shape});
  if (queued_bytes_ > limits_.max_queued_bytes) catching_up_ = true;
}

// Taking bytes is a sign of life: the answer to a ping may come long after a large shape.
void Connection::resume_sending(HostTime now) {
  last_heard_ = now;
  flush(now);
}

void Connection::flush(HostTime now) {
  while (!queue_.empty()) {
    const auto& bytes = *queue_.front().bytes;
    const ssize_t sent = ::send(fd(), bytes.data() + sent_of_first_, bytes.size() - sent_of_first_,
                                MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0) {
      if (errno == EINTR) continue;
      if (errno != EAGAIN && errno != EWOULDBLOCK) stage_ = Stage::ended;
      return;
    }
    last_progress_ = now;
    sent_of_first_ += static_cast<std::size_t>(sent);
    if (sent_of_first_ < bytes.size()) continue;
    if (queue_.front().is_shape)
      --queued_shapes_;
    else
      queued_bytes_ -= bytes.size();
    queue_.pop_front();
    sent_of_first_ = 0;
  }
  last_progress_ = queue_empty_ = now;
  catching_up_ = false;
  if (closing_ && stage_ != Stage::linger && stage_ != Stage::ended) end_sending(now);
}

// Closing a socket with unread bytes resets it, and the client would lose what was sent last.
void Connection::end_sending(HostTime now) {
  ::shutdown(fd(), SHUT_WR);
  stage_ = peer_closed_ ? Stage::ended : Stage::linger;
  stage_since_ = now;
}

void Connection::answer(const std::string& head, SharedBytes body, HostTime now) {
  stage_ = Stage::answer;
  stage_since_ = now;
  closing_ = true;
  queue(shared_bytes(head), false, now);
  if (body) queue(std::move(body), true, now);
  flush(now);
}

void Connection::upgrade(const std::string& head, HostTime now) {
  if (peer_closed_) { // it could neither answer a ping nor close the WebSocket
    stage_ = Stage::ended;
    return;
  }
  stage_ = Stage::socket;
  stage_since_ = last_heard_ = last_ping_ = now;
  queue(shared_bytes(head), false, now);
  flush(now);
}

void Connection::send(Opcode opcode, const SharedBytes& payload, bool is_shape, HostTime now) {
  if (closing_) return;
  queue(shared_bytes(server_head(opcode, payload->size())), is_shape, now);
  queue(payload, is_shape, now);
  flush(now);
}

void Connection::send_control(const std::string& frame, HostTime now) {
  if (closing_ || catching_up_) return; // so pings without end fill no queue
  queue(shared_bytes(frame), false, now);
  flush(now);
}

void Connection::close(CloseCode code, HostTime now, std::string_view reason) {
  if (closing_) return;
  queue(shared_bytes(close_frame(code, reason)), false, now);
  closing_ = true;
  flush(now);
}

bool Connection::within_message_rate(HostTime now) noexcept {
  const double earned = limits_.messages_per_second * to_seconds(now - last_message_);
  messages_left_ = std::min(limits_.message_burst, messages_left_ + earned) - 1.0;
  last_message_ = now;
  return messages_left_ >= 0.0;
}

bool Connection::is_expired(HostTime now) const noexcept {
  if (stage_ == Stage::head) return now - stage_since_ > limits_.request_timeout;
  if (stage_ == Stage::body)
    return now - last_heard_ > limits_.request_timeout || now - stage_since_ > body_timeout;
  if (stage_ == Stage::linger) return now - stage_since_ > linger_timeout;
  const bool stalls = !queue_.empty() && now - last_progress_ > limits_.stall_timeout;
  if (stage_ != Stage::socket) return stalls; // a large model may take long, while it moves
  const bool lags = !queue_.empty() && now - queue_empty_ > limits_.lag_timeout;
  return stalls || lags || now - last_heard_ > limits_.silence_timeout;
}

void Connection::keep_alive(HostTime now) {
  if (stage_ != Stage::socket || now - last_ping_ < limits_.ping_period) return;
  last_ping_ = now;
  send_control(control_frame(Opcode::ping, {}), now);
}

} // namespace nendo::web
