#pragma once
// Shares the gloves and trackers of a loop with other programs of this machine (PROTOCOL.md). One
// thread owns all sockets, which are non-blocking.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/input_script.hpp>

#include "serve/devices.hpp"
#include "serve/socket.hpp"

namespace nendo::serve {

/// The limits of a server.
struct ServerLimits {
  std::size_t max_clients = 32; ///< the next one gets an error line
  /// SO_SNDBUF of each socket. It is small, because its contents can no longer be dropped.
  std::size_t send_buffer_bytes = std::size_t{64} << 10;
  std::size_t log_entries = std::size_t{1} << 14; ///< the input log's
};

/// Counts since open(), except for `clients`.
struct ServerCounters {
  std::uint64_t clients = 0;  ///< that are connected now
  std::uint64_t accepted = 0; ///< connections
  std::uint64_t refused = 0;  ///< clients beyond the limit
  std::uint64_t dropped = 0;  ///< lines that clients missed because they read too slowly
  std::uint64_t lost = 0;     ///< entries that the full input log refused
};

class Server {
public:
  /// Listens at the socket, and starts the server's thread. Error: failed.
  static Result<std::unique_ptr<Server>> open(Socket socket, const Devices& devices,
                                              const ServerLimits& limits = {});
  /// Closes all connections and joins the thread. Does not wait for clients.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Returns the log for LoopOptions::input_log, from which clients get samples and poses. It must
  /// not be used after the server has gone.
  flow::InputLog& input() noexcept;
  /// Returns the sink for LoopOptions::sinks, from which clients get hands. Lives as the log.
  flow::FrameSink& frames() noexcept;
  const std::string& path() const noexcept;
  /// Returns the counters. Each number is atomic; together they are not a consistent snapshot.
  /// Thread-safe, wait-free.
  ServerCounters counters() const noexcept;

private:
  class Work;
  explicit Server(std::unique_ptr<Work> work) noexcept;
  std::unique_ptr<Work> work_;
};

} // namespace nendo::serve
