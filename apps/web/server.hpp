#pragma once
// An HTTP server. It sends one page to browsers, and the frames of a running loop over WebSockets
// to clients with the token (PROTOCOL.md), among them applications that use Foxglove's protocol
// (FOXGLOVE.md). One thread owns all sockets, which are non-blocking.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/endpoint.hpp>
#include <nendo/base/result.hpp>
#include <nendo/flow/command.hpp>

#include "web/client_commands.hpp"
#include "web/frame_stream.hpp"
#include "web/model_message.hpp"

namespace nendo::web {

/// The limits for each client, hostile ones included.
struct ServerLimits {
  /// Open connections. A new one beyond this limit closes the oldest that is not a WebSocket, and
  /// sends no file.
  std::size_t max_connections = 32;
  std::size_t max_clients = 16; ///< open WebSockets; the next one is answered with 503
  /// Bytes queued for a client, without shapes. A client with more queued bytes misses frames until
  /// its queue is empty.
  std::size_t max_queued_bytes = std::size_t{256} << 10;
  /// SO_SNDBUF of each socket. It is small, because its contents can no longer be skipped.
  std::size_t send_buffer_bytes = std::size_t{256} << 10;
  std::chrono::milliseconds request_timeout{5000}; ///< from the connection to the whole request
  std::chrono::milliseconds stall_timeout{10000};  ///< max time without sending a byte of the queue
  std::chrono::milliseconds lag_timeout{30000};    ///< max time with a non-empty WebSocket queue
  std::chrono::milliseconds ping_period{10000};    ///< between pings of a WebSocket
  std::chrono::milliseconds silence_timeout{30000}; ///< max silence of a WebSocket
  /// The token bucket for a client's messages: its size and fill rate. A client that exceeds it is
  /// closed.
  double message_burst = 512.0;
  double messages_per_second = 128.0;
};

/// Counts since open(), except for `clients`.
struct ServerCounters {
  std::uint64_t clients = 0;  ///< WebSockets that are open now
  std::uint64_t accepted = 0; ///< connections
  std::uint64_t refused = 0;  ///< requests that were answered with an error
  std::uint64_t dropped = 0;  ///< connections closed at a limit of time or number
  std::uint64_t updates = 0;  ///< update messages to all clients, and their bytes
  std::uint64_t update_bytes = 0;
  std::uint64_t shapes = 0; ///< shape messages to all clients, and their bytes
  std::uint64_t shape_bytes = 0;
  std::uint64_t weights = 0; ///< weights messages to all clients
  std::uint64_t skipped = 0; ///< frames that clients missed because their queues were full
};

class Server {
public:
  /// Opens the port and starts the server's thread. Until present() is called, answers requests for
  /// the model and for WebSockets with 503. Error: failed (the port is taken, the address is not
  /// one of this machine, the system has no random bytes for the token).
  static Result<std::unique_ptr<Server>> open(const Endpoint& endpoint, ServerLimits limits = {});
  /// Sends the rest of the last frame, closes all connections and joins the thread. Does not wait
  /// for slow clients.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Returns where the server listens, with the port that the system chose in place of 0.
  const Endpoint& endpoint() const noexcept;
  /// Returns the token: 128 random bits in hexadecimal digits. A client with the token may watch
  /// and send commands.
  const std::string& token() const noexcept;
  /// Returns the address for a browser. The token is in the fragment, which browsers do not send.
  std::string url() const;
  /// Returns the address for Foxglove and Lichtblick, with the token.
  std::string foxglove_url() const;

  // The following functions, except next_command(), are thread-safe. They do not wait for the
  // network.

  /// Serves another loop, which must not have begun yet: its frames, model_message() and
  /// pictures_of(). Closes clients of the previous loop with code 1012; they may reconnect.
  void present(std::shared_ptr<FrameStream> stream, std::vector<std::byte> model,
               Pictures pictures = {});
  /// Adds a weights_message(), by its number (Record::weights). Keeps the newest ones, and the one
  /// in use by frames.
  void add_weights(std::uint64_t number, std::vector<std::byte> message);
  /// Returns the next command of all clients, in order of arrival, or nothing. Only for one thread;
  /// wait-free.
  std::optional<ClientCommand> next_command() noexcept;
  /// Sends a report to all clients, which show an error in another colour.
  void report(std::string message, bool is_error);
  // The server sends the following values to clients when they connect, and after changes.
  void set_settings(const flow::LoopSettings& settings);
  /// Sets which commands of the table are on, and the refusals of others.
  void set_commands(const commands::Situation& now);
  /// Sets the state of the frame's clay, and its puppet; null: none. Notifies clients of clay at
  /// most 30 times per second.
  void follow(const flow::Frame& frame, const puppet::Rig* rig);
  /// Sets the controls that clients show (PROTOCOL.md, message 12), until another run is presented
  /// or, for a screen's, for good. From then on the server takes their input and, with a screen's,
  /// files to open.
  void set_form(FormKind kind, std::string_view json);
  /// Sets the hands that clients show without a run (PROTOCOL.md, message 13).
  void set_figures(std::string_view json);
  /// Replaces the pictures of forms. Those of the loop, and beside it, stay.
  void set_pictures(FormPictures pictures);
  /// Returns the next input of that form, of all clients in order of arrival.
  std::optional<FormInput> next_input(FormKind kind);
  /// A file that a client wants to open.
  struct File {
    std::string name; ///< without a path
    std::string bytes;
  };
  /// Returns the file that has arrived since the last call.
  std::optional<File> take_file();
  /// Returns the counters. Each number is atomic; together they are not a consistent snapshot.
  /// Wait-free.
  ServerCounters counters() const noexcept;

  /// Serves another model and its frames in place of the loop's, until end_beside(); clients are
  /// closed with code 1012 by both. The loop continues meanwhile, and may be replaced.
  void present_beside(std::shared_ptr<FrameStream> stream, std::vector<std::byte> model,
                      Pictures pictures);
  void end_beside();
  /// Serves an empty model without frames, for a form and figures.
  void present_nothing();

private:
  class Work;
  /// Does the same, but calls make() for the message only if the version differs from the last one.
  template <class Make>
  void set_fact(std::size_t fact, std::uint64_t version, const Make& make);
  void set_fact(std::size_t fact, std::vector<std::byte> message);
  explicit Server(std::unique_ptr<Work> work) noexcept;
  std::unique_ptr<Work> work_;
};

} // namespace nendo::web
