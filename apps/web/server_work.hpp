#pragma once
// The server's thread, and all that it owns.

#include <array>
#include <atomic>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <nendo/base/unique_fd.hpp>

#include "web/http_request.hpp"
#include "web/server.hpp"
#include "web/web_socket.hpp"

struct pollfd;

namespace nendo::web {

using SharedBytes = std::shared_ptr<const std::vector<std::byte>>;
SharedBytes shared_bytes(std::string_view text);

/// The messages that each client gets when it connects and after changes.
enum Fact : std::size_t {
  settings_fact,
  history_fact,
  puppet_fact,
  clay_fact,
  commands_fact,
  fact_count
};
using Facts = std::array<SharedBytes, fact_count>;

/// A client's received bytes, its send queue, and its deadlines. No call blocks.
class Connection {
public:
  enum class Stage {
    head,   ///< receives the HTTP request
    answer, ///< sends an HTTP answer, after which the connection ends
    socket, ///< a WebSocket
    linger, ///< everything is sent; discards input until the client closes
    ended,  ///< can be destroyed
  };

  /// `limits` must outlive the connection.
  Connection(UniqueFd socket, HostTime now, const ServerLimits& limits);

  int fd() const noexcept { return socket_.get(); }
  Stage stage() const noexcept { return stage_; }
  short events() const noexcept; ///< the events for poll()
  /// Appends received bytes to incoming(), up to its capacity. Returns false if the connection has
  /// ended. A client that has shut down its sending side may still get an answer.
  bool receive(HostTime now);
  std::string& incoming() noexcept { return incoming_; }
  /// Waits for the rest of a request. Ends the connection if no more bytes can come.
  void await_more() noexcept;
  /// Sends from the queue. Call it when poll() reports POLLOUT.
  void resume_sending(HostTime now);

  /// Queues an HTTP answer, after which the connection ends. `body` may be null.
  void answer(std::string head, SharedBytes body, HostTime now);
  /// Queues the answer that makes the connection a WebSocket.
  void upgrade(std::string head, HostTime now);
  /// Queues a message of a WebSocket. Shapes are not counted against max_queued_bytes.
  void send(Opcode opcode, const SharedBytes& payload, bool is_shape, HostTime now);
  /// Queues a control frame, unless the queue is too long.
  void send_control(std::string frame, HostTime now);
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

  ClientReader reader;
  Feed feed;
  Facts sent_facts; ///< the last sent messages

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
  std::deque<Part> queue_;
  std::size_t sent_of_first_ = 0; ///< sent bytes of the queue's first part
  std::size_t queued_bytes_ = 0;  ///< queued bytes without shapes
  std::size_t queued_shapes_ = 0; ///< queued parts of shapes
  bool catching_up_ = false;
  bool peer_closed_ = false; ///< the client has shut down its sending side
  bool closing_ = false;     ///< ends the connection when the queue is empty
  HostTime last_progress_;   ///< the last time a byte was sent, or the queue was empty
  HostTime queue_empty_;     ///< the last time the queue was empty
  HostTime last_heard_;      ///< the last time a WebSocket received bytes
  HostTime last_ping_;
  double messages_left_; ///< the tokens in the client's bucket
  HostTime last_message_;
};

class Server::Work {
public:
  Work(Endpoint endpoint, std::string token, UniqueFd listener, UniqueFd waker,
       ServerLimits limits);
  ~Work();
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  void wake() noexcept;
  void report(std::string message);

  const Endpoint endpoint;
  const std::string token;
  // The server's thread writes or shares the following members.
  /// Enough for commands of 16 clients in half a second. Further commands are dropped.
  SpscRing<ClientCommand> commands{1024};
  /// `missed` of a glove that does not report it: all bits set, also in the 32 that are sent.
  static constexpr std::uint64_t unknown_count = ~std::uint64_t{0};
  /// Each number is atomic; together they are not a consistent snapshot.
  struct SharedGloveState {
    std::atomic<std::uint64_t> delivered{0}, missed{0}, refused{0}, bad{0};
    std::atomic<bool> uncalibrated{false};
  };
  std::array<SharedGloveState, 2> gloves; ///< index: flow::Placement::index_of(side)
  struct Counts {
    std::atomic<std::uint64_t> clients{0}, accepted{0}, refused{0}, dropped{0}, updates{0},
        update_bytes{0}, shapes{0}, shape_bytes{0}, weights{0}, skipped{0};
  } counts;

  /// The served loop. Connections share its model while they send it.
  struct Presented {
    std::shared_ptr<FrameStream> stream;
    SharedBytes model;
    Pictures pictures;
    std::uint16_t loop = 0; ///< the loop's number within the run, in model and shape messages
  };

  struct Weights {
    std::uint64_t number = 0;
    SharedBytes message;
  };

  /// Data from other threads for the server's thread.
  struct Inbox {
    std::mutex mutex;              ///< guards the other members
    std::optional<Presented> next; ///< set by present(), not taken yet
    std::uint16_t loops = 0;
    std::string report;   ///< the newest report; empty: already sent
    HostTime next_clay{}; ///< the earliest time of the next clay message
    Facts facts;          ///< messages; null until they are set
    std::array<std::uint64_t, fact_count> versions{}; ///< the last versions of versioned facts
    std::vector<Weights> weights;                     ///< oldest first
    std::uint64_t weights_in_use = 0;
  } inbox;

private:
  void run();
  void wait();
  void take_presented();
  void send_report(HostTime now);
  void send_facts(HostTime now);
  void end();
  void accept_all(HostTime now);
  void drop_oldest();
  void serve(Connection& connection, short events, HostTime now);
  void read_head(Connection& connection, HostTime now);
  void open_socket(Connection& connection, const HttpRequest& request, HostTime now);
  void send_picture(Connection& connection, const HttpRequest& request, HostTime now);
  void read_socket(Connection& connection, HostTime now);
  void handle(Connection& connection, const std::string& text, HostTime now);
  void refuse(Connection& connection, int status, std::string_view why, HostTime now);
  void send_frames(HostTime now);
  void send_weights(Connection& client, HostTime now);
  void send_frames(Connection& client, const std::optional<FrameStream::Shape>& shape,
                   const SharedBytes& bytes, HostTime now);
  void drop_expired(HostTime now);
  std::size_t clients() const noexcept;

  const ServerLimits limits_;
  UniqueFd listener_, waker_;
  Presented presented_;
  std::list<Connection> connections_; ///< oldest first
  std::vector<pollfd> polled_;
  std::vector<Record> records_;
  FeedCounters feed_counters_;
  HostTime next_frames_{};
  HostTime next_accept_{};
  std::atomic<bool> over_{false};
  std::thread thread_;
};

} // namespace nendo::web
