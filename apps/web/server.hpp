#pragma once
// An HTTP server. It sends one page to browsers, and the frames of a running loop over WebSockets
// to clients that have the token. PROTOCOL.md describes the bytes. One thread owns all sockets, and
// no call on a socket blocks it.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/flow/command.hpp>

#include "web/client_commands.hpp"
#include "web/endpoint.hpp"
#include "web/frame_stream.hpp"
#include "web/model_message.hpp"

namespace nendo::web {

/// What the server grants to each client, hostile ones included.
struct ServerLimits {
  /// Open connections. A new one beyond this limit closes the oldest that is not a WebSocket.
  std::size_t max_connections = 32;
  std::size_t max_clients = 16; ///< open WebSockets; the next one is answered with 503
  /// Bytes queued for a client, shapes not counted. A client that has more queued misses frames
  /// until its queue is empty.
  std::size_t max_queued_bytes = std::size_t{256} << 10;
  /// SO_SNDBUF of each socket. What waits there can no longer be skipped, so it is kept small.
  std::size_t send_buffer_bytes = std::size_t{256} << 10;
  std::chrono::milliseconds request_timeout{5000};  ///< from the connection to the whole request
  std::chrono::milliseconds stall_timeout{10000};   ///< without taking a byte of the queue
  std::chrono::milliseconds lag_timeout{30000};     ///< how long a WebSocket's queue may be in use
  std::chrono::milliseconds ping_period{10000};     ///< between pings of a WebSocket
  std::chrono::milliseconds silence_timeout{30000}; ///< how long a WebSocket may be silent
  /// Messages from a client, as a token bucket: its size, and how fast it fills. A client that
  /// sends more is closed.
  double message_burst = 512.0;
  double messages_per_second = 128.0;
};

/// Counts since the server was opened, except for `clients`.
struct ServerCounters {
  std::uint64_t clients = 0;  ///< WebSockets that are open now
  std::uint64_t accepted = 0; ///< connections
  std::uint64_t refused = 0;  ///< requests that were answered with an error
  std::uint64_t dropped = 0;  ///< connections that met a limit of time or number
  std::uint64_t updates = 0;  ///< update messages to all clients, and their bytes
  std::uint64_t update_bytes = 0;
  std::uint64_t shapes = 0; ///< shape messages to all clients, and their bytes
  std::uint64_t shape_bytes = 0;
  std::uint64_t weights = 0; ///< weights messages to all clients
  std::uint64_t skipped = 0; ///< frames that clients missed because their queues were full
};

class Server {
public:
  /// Opens the port and starts the server's thread. Until present() is called, requests for the
  /// model and for WebSockets are answered with 503. Error: failed (the port is taken, the address
  /// is not one of this machine, the system has no random bytes for the token).
  static Result<std::unique_ptr<Server>> open(const Endpoint& endpoint, ServerLimits limits = {});
  /// Sends what is left of the last frame, closes all connections and joins the thread. It does not
  /// wait for slow clients.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Returns where the server listens, with the port that the system chose in place of 0.
  const Endpoint& endpoint() const noexcept;
  /// Returns the token: 128 random bits in hexadecimal digits. A client that has it may watch and
  /// send commands.
  const std::string& token() const noexcept;
  /// Returns the address for a browser. The token follows "#", a part that browsers do not send.
  std::string url() const;

  // Any thread may call the following functions but next_command(). They do not wait for the
  // network.

  /// Serves another loop, which must not have begun yet, by its frames, its model_message() and its
  /// pictures_of(). Clients of the previous loop are closed with code 1012 and may connect again.
  void present(std::shared_ptr<FrameStream> stream, std::vector<std::byte> model,
               Pictures pictures = {});
  /// Adds a weights_message(), by its number (Record::weights). It keeps the last ones, and the one
  /// that frames need.
  void add_weights(std::uint64_t number, std::vector<std::byte> message);
  /// Returns the next command of any client, in the order in which they came, or nothing if there
  /// is none now. Only one thread may call it; wait-free.
  std::optional<ClientCommand> next_command() noexcept;
  /// Sends a report to all clients.
  void report(std::string message);
  // The following functions notify clients when they connect and when the values change.
  void set_settings(const flow::LoopSettings& settings);
  /// Sets which commands of the table are on, and which are not possible, with the reason.
  void set_commands(const commands::Situation& now);
  void set_steps(const flow::StepList& steps);
  /// Sets the puppet that is played, by the loop's number for it; null: none.
  void set_puppet(std::uint32_t number, const puppet::Rig* rig);
  /// Sets what the page shows of clay. Notifies clients at most 30 times per second.
  void set_clay(const flow::Frame& frame);
  /// Sets what the page shows of each glove. Wait-free.
  void set_gloves(const GloveStates& gloves) noexcept;
  /// Returns the counters. Each number is right by itself, but they are not all of the same moment.
  /// Wait-free.
  ServerCounters counters() const noexcept;

private:
  class Work;
  /// The same, but calls make() for the message only if the version differs from the last one.
  template <class Make>
  void set_fact(std::size_t fact, std::uint64_t version, const Make& make);
  void set_fact(std::size_t fact, std::vector<std::byte> message);
  explicit Server(std::unique_ptr<Work> work) noexcept;
  std::unique_ptr<Work> work_;
};

} // namespace nendo::web
