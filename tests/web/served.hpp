#pragma once
// A loop that runs, its server, and a client of it.

#include <atomic>
#include <functional>
#include <thread>

#include <doctest/doctest.h>

#include "following_client.hpp"
#include "streamed_loop.hpp"
#include "support/eventually.hpp"
#include "support/restraint.hpp"
#include "web/model_message.hpp"
#include "web_client.hpp"

namespace nendo::test {

inline std::unique_ptr<web::Server> open_server(web::ServerLimits limits = {}) {
  auto server = web::Server::open({"127.0.0.1", 0}, limits);
  REQUIRE(server);
  return *std::move(server);
}

/// A server, and its loop on a thread of its own, whose hands open and close.
struct Served {
  StreamedLoop streamed;
  std::unique_ptr<web::Server> server;
  RestraintCounts counts; ///< the loop's thread's

  explicit Served(flow::Mode mode, web::ServerLimits limits = {}, const char* puppet = nullptr)
      : streamed(mode, {.injective = deform::InjectiveOptions{}, .puppet = puppet}),
        server(open_server(limits)) {
    server->present(streamed.stream, streamed.model);
    if (const auto& surface = streamed.test.loop->changes().sculptor_options().surface)
      server->add_weights(surface->number(), web::weights_message(*surface));
  }
  ~Served() { end(); }
  void begin() {
    hands_ = std::thread([this] {
      for (int bent = 0; !over_; ++bent) {
        streamed.test.bend(bent % 40 < 20 ? bent % 40 : 40 - bent % 40, HostClock::now());
        while (const auto asked = server->next_command()) {
          const auto* const row = std::get_if<const commands::Row*>(&*asked);
          streamed.test.commands.try_push(row != nullptr ? (*row)->make(false)
                                                         : std::get<flow::Command>(*asked));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
    loop_ = std::thread([this] {
      const Restraint restraint;
      streamed.test.loop->run(over_);
      counts = restraint.counts();
    });
  }
  void end() {
    over_ = true;
    if (hands_.joinable()) hands_.join();
    if (loop_.joinable()) loop_.join();
  }

private:
  std::atomic<bool> over_{false};
  std::thread hands_, loop_;
};

/// A client of a server's first loop, over a WebSocket.
struct Viewer : FollowingClient {
  WebClient client;

  explicit Viewer(const Served& served, int receive_bytes = 0)
      : FollowingClient(served.streamed.model), client(*served.server, receive_bytes) {
    loop = 1;
    REQUIRE(client.open_socket() == 101);
  }
  /// Takes messages until it is so. False if the connection ends before.
  bool follow_until(const std::function<bool()>& is_so) {
    while (!is_so()) {
      const auto frame = client.next();
      if (!frame || frame->opcode == 8) return is_so();
      if (frame->opcode == 2) CHECK(take(frame->payload));
    }
    return true;
  }
};

} // namespace nendo::test
