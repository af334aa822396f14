#pragma once
// One connection: what it has sent so far, what waits for it, and until when it must move. No call
// blocks.

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <nendo/base/descriptor.hpp>
#include <nendo/web/server.hpp>

#include "feed.hpp"
#include "socket_frames.hpp"

namespace nendo::web {

using SharedBytes = std::shared_ptr<const std::vector<std::byte>>;
SharedBytes shared_bytes(std::string_view text);

class Connection {
public:
  enum class Stage {
    head,   ///< its request is coming in
    answer, ///< is sent what it asked for; then it ends
    socket, ///< a WebSocket
    linger, ///< all is sent; what it still sends is thrown away until it closes
    over,
  };

  Connection(Descriptor socket, HostTime now, const ServerLimits& limits);

  int fd() const noexcept { return socket_.get(); }
  Stage stage() const noexcept { return stage_; }
  HostTime since() const noexcept { return since_; }
  /// What poll() is to wait for.
  short events() const noexcept;
  /// Reads what is there into incoming(), as far as that has room. False: it has ended. Who sends
  /// no more may still be waiting for an answer.
  bool receive(HostTime now);
  std::string& incoming() noexcept { return incoming_; }
  /// The request is not complete: waits for the rest, if any can come.
  void await_rest() noexcept;
  /// The system has room again, because the other side took something: sends on.
  void send_on(HostTime now);

  /// Queues an answer, after which the connection ends.
  void answer(std::string head, SharedBytes body, HostTime now);
  /// It is a WebSocket from now on.
  void upgrade(std::string head, HostTime now);
  /// Queues a message or a control frame of a WebSocket.
  void send(Opcode opcode, const SharedBytes& payload, bool is_shape, HostTime now);
  void send_control(std::string frame, HostTime now);
  /// Says so, and ends.
  void close(CloseCode code, HostTime now);

  /// Whether it may say something; counts that it has. False: it talks without end.
  bool may_speak(HostTime now) noexcept;
  /// Whether an update may be queued: not while it catches up.
  bool has_room() const noexcept { return !catching_up_; }
  /// Whether a shape is still on its way: another one would only be older when it came.
  bool has_shape_waiting() const noexcept { return waiting_shapes_ > 0; }
  bool is_overdue(HostTime now) const noexcept;
  /// Sends a ping if it is time.
  void keep_alive(HostTime now);

  ClientReader reader;
  Feed feed;

private:
  struct Part {
    SharedBytes bytes;
    bool is_shape = false;
  };
  void queue(SharedBytes bytes, bool is_shape, HostTime now);
  /// Sends what the system takes.
  void flush(HostTime now);
  void end_sending(HostTime now);

  Descriptor socket_;
  const ServerLimits& limits_;
  Stage stage_ = Stage::head;
  HostTime since_; ///< of its stage
  std::string incoming_;
  std::deque<Part> waiting_;
  std::size_t sent_of_first_ = 0;
  std::size_t small_bytes_ = 0;    ///< of what waits, without shapes
  std::size_t waiting_shapes_ = 0; ///< parts of such
  bool catching_up_ = false;
  bool heard_end_ = false; ///< it sends no more
  bool closes_ = false;    ///< ends when all is sent
  HostTime moved_;         ///< when it last took a byte, or nothing waited
  HostTime empty_;         ///< when nothing waited last
  HostTime heard_, asked_; ///< of a WebSocket: its last sign of life, the last ping
  double words_left_;      ///< that it may say at once
  HostTime spoke_;         ///< when it said something last
};

} // namespace nendo::web
