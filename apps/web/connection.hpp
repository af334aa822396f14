#pragma once
// A client's connection.

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/unique_fd.hpp>
#include <nendo/base/units.hpp>

#include "web/foxglove_feed.hpp"
#include "web/frame_stream.hpp"
#include "web/web_socket.hpp"

namespace nendo::web {

struct ServerLimits;

using SharedBytes = std::shared_ptr<const std::vector<std::byte>>;
SharedBytes shared_bytes(std::string_view text);

/// The messages that each client gets when it connects and after changes.
enum Fact : std::size_t {
  settings_fact,
  puppet_fact,
  clay_fact,
  wire_fact,
  commands_fact,
  form_fact, ///< and the next two, by FormKind
  run_form_fact,
  status_fact,
  figures_fact,
  fact_count
};
using Facts = std::array<SharedBytes, fact_count>;

/// A client's received bytes, its send queue, and its deadlines. No call blocks.
class Connection {
public:
  enum class Stage {
    head,   ///< receives the HTTP request
    body,   ///< receives the file that follows the request
    answer, ///< sends an HTTP answer, after which the connection ends
    socket, ///< a WebSocket
    linger, ///< everything is sent; discards input until the client closes
    ended,  ///< can be destroyed
  };

  /// `limits` must outlive the connection.
  Connection(UniqueFd socket, HostTime now, const ServerLimits& limits);

  int fd() const noexcept { return socket_.get(); }
  Stage stage() const noexcept { return stage_; }
  /// Return whether it is a WebSocket of a page, or of an application that uses Foxglove's
  /// protocol.
  bool is_page() const noexcept { return stage_ == Stage::socket && !foxglove; }
  bool is_foxglove() const noexcept { return stage_ == Stage::socket && foxglove; }
  short events() const noexcept; ///< the events for poll()
  /// Appends received bytes to incoming(), up to its capacity. Returns false if the connection has
  /// ended. A client that has shut down its sending side may still get an answer.
  bool receive(HostTime now);
  std::string& incoming() noexcept { return incoming_; }
  /// Waits for the rest of a request. Ends the connection if no more bytes can come.
  void await_more() noexcept;
  /// Receives a file of so many bytes in incoming(), which then has only that.
  void begin_body(std::size_t head_bytes, std::size_t body_bytes, HostTime now);
  bool has_body() const noexcept {
    return stage_ == Stage::body && incoming_.size() >= body_bytes_;
  }
  /// Sends from the queue. Call it when poll() reports POLLOUT.
  void resume_sending(HostTime now);

  /// Queues an HTTP answer, after which the connection ends. `body` may be null.
  void answer(const std::string& head, SharedBytes body, HostTime now);
  /// Queues the answer that makes the connection a WebSocket.
  void upgrade(const std::string& head, HostTime now);
  /// Queues a message of a WebSocket. Shapes are not counted against max_queued_bytes.
  void send(Opcode opcode, const SharedBytes& payload, bool is_shape, HostTime now);
  /// Queues a control frame, unless the queue is too long.
  void send_control(const std::string& frame, HostTime now);
  /// Queues a close frame, after which the connection ends.
  void close(CloseCode code, HostTime now, std::string_view reason = {});

  /// Takes a token from the client's bucket. Returns false if it is empty.
  bool within_message_rate(HostTime now) noexcept;
  /// Returns false after the queue became too long, until it is empty.
  bool accepts_updates() const noexcept { return !catching_up_; }
  bool has_queued_shape() const noexcept { return queued_shapes_ > 0; }
  bool is_expired(HostTime now) const noexcept; ///< a time limit has passed
  /// Sends a ping if one is due.
  void keep_alive(HostTime now);

  std::string file_name; ///< the name of the file that is received
  ClientReader reader;
  Feed feed;
  std::optional<FoxgloveFeed> foxglove; ///< set before upgrade()
  Facts sent_facts;                     ///< the last sent messages

private:
  struct Part {
    SharedBytes bytes;
    bool is_shape = false;
  };
  void queue(SharedBytes bytes, bool is_shape, HostTime now);
  /// Sends as much of the queue as the system takes.
  void flush(HostTime now);
  void end_sending(HostTime now);

  UniqueFd socket_;
  const ServerLimits& limits_;
  Stage stage_ = Stage::head;
  HostTime stage_since_;
  std::string incoming_;
  std::size_t body_bytes_ = 0;
  std::deque<Part> queue_;
  std::size_t sent_of_first_ = 0; ///< sent bytes of the queue's first part
  std::size_t queued_bytes_ = 0;  ///< queued bytes without shapes
  std::size_t queued_shapes_ = 0; ///< queued parts of shapes
  bool catching_up_ = false;
  bool peer_closed_ = false; ///< the client has shut down its sending side
  bool closing_ = false;     ///< ends the connection when the queue is empty
  HostTime last_progress_;   ///< the last time a byte was sent, or the queue was empty
  HostTime queue_empty_;     ///< the last time the queue was empty
  HostTime last_heard_;      ///< the last time the client sent, or took, bytes
  HostTime last_ping_;
  double messages_left_; ///< the tokens in the client's bucket
  HostTime last_message_;
};

} // namespace nendo::web
