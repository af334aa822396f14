#pragma once
// A loop that runs, with a server at it.

#include <atomic>
#include <functional>
#include <thread>

#include <doctest/doctest.h>

#include "following_client.hpp"
#include "support/restraint.hpp"
#include "tapped_loop.hpp"
#include "web_client.hpp"

namespace nendo::test {

inline std::unique_ptr<web::Server> open_server(web::ServerLimits limits = {}) {
  auto server = web::Server::open({"127.0.0.1", 0}, limits);
  REQUIRE(server);
  return *std::move(server);
}

/// As long as it takes on a machine that does much else.
inline bool wait_for(const std::function<bool()>& is_so) {
  for (const HostTime end = HostClock::now() + std::chrono::seconds(30); HostClock::now() < end;) {
    if (is_so()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return is_so();
}

/// A loop that runs on a thread of its own, with hands that open and close, and its server.
struct Served {
  TappedLoop tapped;
  std::unique_ptr<web::Server> server;
  RestraintCounts counts; ///< of the loop's thread

  explicit Served(flow::Mode mode, web::ServerLimits limits = {})
      : tapped(mode, deform::InjectiveOptions{}), server(open_server(limits)) {
    server->present(tapped.tap, tapped.model);
  }
  ~Served() { end(); }
  void begin() {
    hands_ = std::thread([this] {
      for (int bent = 0; !over_; ++bent) {
        tapped.test.bend(bent % 40 < 20 ? bent % 40 : 40 - bent % 40, HostClock::now());
        while (const auto request = server->next_request())
          tapped.test.requests.try_push(*request);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
    loop_ = std::thread([this] {
      const Restraint restraint;
      tapped.test.loop->run(over_);
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

/// Takes messages until it is so, or the connection ends.
inline bool follow_until(WebClient& client, FollowingClient& follower,
                         const std::function<bool()>& is_so) {
  while (!is_so()) {
    const auto frame = client.next();
    if (!frame || frame->opcode == 8) return is_so();
    if (frame->opcode == 2) CHECK(follower.take(frame->payload));
  }
  return true;
}

} // namespace nendo::test
