#pragma once
// Serves one page to browsers, and frames over WebSockets to whoever has the token (PROTOCOL.md).
// One thread, which owns all sockets and waits for none of them.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/request.hpp>
#include <nendo/flow/save_request.hpp>
#include <nendo/flow/wrist_move.hpp>
#include <nendo/web/endpoint.hpp>
#include <nendo/web/frame_stream.hpp>

namespace nendo::web {

/// What a client may take of the server, whoever it is.
struct ServerLimits {
  std::size_t connections = 32; ///< the oldest without a WebSocket goes for a new one
  std::size_t clients = 16;     ///< WebSockets
  /// Bytes that wait for a client, beside a shape; then it misses frames until it has them all.
  std::size_t most_waiting = std::size_t{256} << 10;
  std::size_t system_buffer = std::size_t{256} << 10; ///< what waits in the system arrives old
  std::chrono::milliseconds head{5000};               ///< for all of a request
  std::chrono::milliseconds stalled{10000};           ///< without taking a byte of what waits
  std::chrono::milliseconds lagging{30000};           ///< without having taken all of it
  std::chrono::milliseconds ping{10000};              ///< how often it is asked whether it is there
  std::chrono::milliseconds silent{30000};            ///< without any answer
  double words_at_once = 512.0;  ///< messages that a client may send, if it has been quiet
  double words_a_second = 128.0; ///< and in the long run; who says more is sent away
};

/// Since the server was opened.
struct ServerCounters {
  std::uint64_t clients = 0;  ///< WebSockets at present
  std::uint64_t accepted = 0; ///< connections
  std::uint64_t refused = 0;  ///< requests that were answered with an error
  std::uint64_t dropped = 0;  ///< clients that were too slow, silent or wrong
  std::uint64_t updates = 0;  ///< messages to clients, and their bytes
  std::uint64_t update_bytes = 0;
  std::uint64_t shapes = 0;
  std::uint64_t shape_bytes = 0;
  std::uint64_t skipped = 0; ///< frames that had no room on their way to a client
};

class Server {
public:
  /// Listens, and begins its thread; there is nothing to look at until present(). Errors: failed
  /// (the port is taken, the address is not this machine's, no randomness for a token).
  static Result<std::unique_ptr<Server>> open(const Endpoint& endpoint, ServerLimits limits = {});
  /// Closes all connections and waits for the thread, which is prompt.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// With the port that was found, if that was left open.
  const Endpoint& endpoint() const noexcept;
  /// 128 random bits in hexadecimal figures: who has them may look and press buttons.
  const std::string& token() const noexcept;
  /// What a person opens: the token stands behind "#", which browsers send to nobody.
  std::string url() const;

  /// Before a loop begins: what shows its frames, and its model (model_message()). Clients of the
  /// loop before are sent away, and come again. Any thread; does not wait for the network.
  void present(std::shared_ptr<FrameStream> tap, std::vector<std::byte> model);
  /// What clients asked of the loop, in their order. This and what follows: one thread; wait-free.
  std::optional<flow::Request> next_request() noexcept;
  /// Where a hand was moved to last, if that was since the last call; one hand after the other.
  std::optional<flow::WristMove> next_wrist() noexcept;
  /// What only a new loop can give, of all who asked since the last call.
  flow::LoopChange next_change() noexcept;
  /// What is to be kept, of all who asked since the last call.
  flow::SaveRequest next_save_request() noexcept;
  /// Words for the people who look on now. Any thread; does not wait for the network.
  void tell(std::string words);
  /// Of the gloves, for who looks. Any thread, wait-free.
  void tell_bad_records(std::array<std::uint32_t, 2> counts) noexcept;
  /// Any thread, wait-free; each for itself.
  ServerCounters counters() const noexcept;

private:
  class Work;
  explicit Server(std::unique_ptr<Work> work) noexcept;
  std::unique_ptr<Work> work_;
};

} // namespace nendo::web
