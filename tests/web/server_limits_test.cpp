// What a client may take of the server, and that the loop has nothing to do with it.

#include <doctest/doctest.h>

#include "served.hpp"

using namespace nendo;
using namespace nendo::web;
using nendo::test::follow_until;
using nendo::test::FollowingClient;
using nendo::test::Served;
using nendo::test::wait_for;
using nendo::test::WebClient;
using std::chrono::milliseconds;

TEST_SUITE("server_limits") {
  TEST_CASE(
      "a client that does not read misses frames, and is given the whole shape when it does") {
    ServerLimits limits;
    limits.most_waiting = 8192;
    limits.system_buffer = 4096;
    Served served(flow::Mode::type2, limits);
    served.begin();
    WebClient client(*served.server, 4096);
    REQUIRE(client.open_socket() == 101);
    FollowingClient follower(served.tapped.model);
    follower.loop = 1;
    CHECK(follow_until(client, follower, [&] { return follower.follows(); }));
    CHECK(wait_for([&] { return served.server->counters().skipped > 50; }));
    const int shapes = follower.shapes;
    CHECK(follow_until(client, follower, [&] { return follower.shapes > shapes; }));
    CHECK(follow_until(client, follower, [&] { return follower.number == follower.newest; }));
    CHECK(follower.skipped > 50);
  }

  TEST_CASE("who stalls, is silent or does not finish a request is dropped in its time") {
    ServerLimits limits;
    limits.head = milliseconds(100);
    limits.ping = milliseconds(50);
    limits.silent = milliseconds(300);
    Served served(flow::Mode::type1, limits);
    served.begin();
    WebClient half(*served.server);
    half.send("GET / HTTP/1.1\r\nHost: 127");
    WebClient mute(*served.server); // half-open: never answers a ping
    REQUIRE(mute.open_socket() == 101);
    CHECK(half.is_ended());
    bool asked = false;
    while (const auto frame = mute.next())
      asked = asked || frame->opcode == 9;
    CHECK(asked);
    CHECK(mute.is_ended());
    CHECK(served.server->counters().dropped >= 2);
  }

  TEST_CASE("who talks without end is sent away, and who is slower for long is heard") {
    ServerLimits limits;
    limits.words_at_once = 20.0;
    limits.words_a_second = 50.0;
    Served served(flow::Mode::type1, limits);
    served.begin();
    WebClient steady(*served.server);
    REQUIRE(steady.open_socket() == 101);
    for (int n = 0; n < 60; ++n) { // more than at once, and 25 a second
      CHECK(steady.say("wrist left 0 0 0 0 0 0 1"));
      std::this_thread::sleep_for(milliseconds(40));
    }
    WebClient flood(*served.server);
    REQUIRE(flood.open_socket() == 101);
    for (int n = 0; n < 500; ++n)
      flood.say("wrist left 0 0 0 0 0 0 1");
    unsigned code = 0;
    while (const auto frame = flood.next())
      if (frame->opcode == 8) code = frame->close_code();
    CHECK(code == 1008);
    CHECK(steady.say("let go"));
    FollowingClient follower(served.tapped.model);
    follower.loop = 1;
    CHECK(follow_until(steady, follower, [&] { return follower.updates > 0 && !follower.held; }));
  }

  TEST_CASE("there are so many places, and a client that has one keeps it") {
    ServerLimits limits;
    limits.connections = 6;
    limits.clients = 3;
    Served served(flow::Mode::type1, limits);
    served.begin();
    std::vector<std::unique_ptr<WebClient>> clients;
    for (int n = 0; n < 3; ++n) {
      clients.push_back(std::make_unique<WebClient>(*served.server));
      REQUIRE(clients.back()->open_socket() == 101);
    }
    CHECK(WebClient(*served.server).open_socket() == 503);
    std::vector<std::unique_ptr<WebClient>> idle; // more than there are places
    for (int n = 0; n < 20; ++n)
      idle.push_back(std::make_unique<WebClient>(*served.server));
    CHECK(WebClient(*served.server).get("/").status == 200);
    for (auto& client : clients)
      CHECK(client->next());
    CHECK(served.server->counters().clients == 3);
  }

  TEST_CASE("ten slow and hostile clients do not touch the loop, nor who looks on quietly") {
    ServerLimits limits;
    limits.most_waiting = 16384;
    limits.system_buffer = 4096;
    Served served(flow::Mode::type2, limits);
    WebClient quiet(*served.server);
    REQUIRE(quiet.open_socket() == 101);
    std::vector<std::unique_ptr<WebClient>> hostile;
    for (int n = 0; n < 10; ++n)
      hostile.push_back(std::make_unique<WebClient>(*served.server, 2048));
    for (std::size_t n = 0; n < 5; ++n)
      hostile[n]->open_socket();
    served.begin();
    FollowingClient follower(served.tapped.model);
    follower.loop = 1;
    for (int round = 0; round < 200; ++round) {
      hostile[0]->send("");                                 // takes nothing
      hostile[1]->say(std::string(100, 'x'), 0x89);         // pings without end
      hostile[2]->send(std::string("\x81\xFF\xFF\xFF", 4)); // an endless frame
      hostile[3]->send(std::string("\x01\x80\0\0\0\0", 6)); // parts of nothing
      hostile[4]->say("undo");                              // presses a button all the time
      hostile[5]->send("G");                                // a letter at a time
      hostile[6]->send(std::string(1000, '\r'));
      hostile[7]->send("GET / HTTP/1.1\r\nA: b\r\n");
      hostile[8]->get("/model?token=guess" + std::to_string(round));
      hostile[9] = std::make_unique<WebClient>(*served.server, 2048);
      const int updates = follower.updates;
      CHECK(follow_until(quiet, follower, [&] { return follower.updates > updates; }));
    }
    hostile.clear();
    // A shape that is wanted comes with a tick, so all undos must have been made up for before the
    // last.
    const int settled = follower.updates + 50;
    CHECK(follow_until(quiet, follower, [&] {
      return follower.updates > settled && follower.number == follower.newest;
    }));
    served.end();
    const auto& stats = served.tapped.test.loop->stats();
    CHECK(stats.ticks > 100);
    CHECK(stats.failed == 0);
    CHECK(served.counts.allocations == 0);
    CHECK(served.counts.frees == 0);
    CHECK(served.counts.locks == 0);
    served.tapped.test.loop->frames().update();
    const auto& frame = served.tapped.test.loop->frames().front();
    CHECK(frame.ticks == stats.ticks);
    CHECK(follow_until(quiet, follower, [&] { return follower.number == frame.ticks; }));
    const auto shape = served.tapped.test.vertices_of(frame);
    CHECK((follower.vertices() - shape).cwiseAbs().maxCoeff() < 1e-5 * follower.diagonal);
  }
}
