// Tests of ServerLimits, and that no client slows the loop down.

#include <string>
#include <thread>

#include <doctest/doctest.h>

#include "served.hpp"

namespace server_limits_test {

using namespace nendo;
using namespace nendo::web;
using nendo::test::client_frame;
using nendo::test::eventually;
using nendo::test::Served;
using nendo::test::Viewer;
using nendo::test::WebClient;
using std::chrono::milliseconds;

namespace {

constexpr int small_buffer = 4096; ///< size of the buffers at both ends, so that they are soon full

/// Limits that no client reaches, except for those that a test sets afterwards.
ServerLimits generous() {
  ServerLimits limits;
  limits.send_buffer_bytes = small_buffer;
  limits.max_queued_bytes = std::size_t{1} << 30;
  for (auto* limit : {&limits.request_timeout, &limits.stall_timeout, &limits.lag_timeout,
                      &limits.silence_timeout})
    *limit = std::chrono::hours(1);
  return limits;
}

/// The newest frame of the running loop. Only the test's thread may call this.
const flow::Frame& newest_frame(Served& served) {
  served.streamed.test.loop->frames().update();
  return served.streamed.test.loop->frames().front();
}

} // namespace

TEST_SUITE("server_limits") {
  TEST_CASE(
      "a client that does not read misses frames, and is given the whole shape when it does") {
    ServerLimits limits;
    limits.max_queued_bytes = 8192;
    limits.send_buffer_bytes = 4096;
    Served served(flow::Mode::type2, limits);
    served.begin();
    Viewer viewer(served, 4096);
    CHECK(viewer.follow_until([&] { return viewer.follows(); }));
    CHECK(eventually([&] { return served.server->counters().skipped > 50; }));
    const int shapes = viewer.shapes;
    CHECK(viewer.follow_until([&] { return viewer.shapes > shapes; }));
    CHECK(viewer.follow_until([&] { return viewer.number == viewer.newest; }));
    CHECK(viewer.skipped > 50);
  }

  TEST_CASE("a client that does not read is not sent each form, but the newest when it reads") {
    ServerLimits limits = generous();
    limits.max_queued_bytes = 8192;
    const auto server = nendo::test::open_server(limits);
    server->present_nothing();
    WebClient client(*server, small_buffer);
    REQUIRE(client.open_socket() == 101);
    constexpr int last = 299;
    for (int number = 0; number <= last; ++number) {
      server->set_form(web::FormKind::screen, std::to_string(number) + std::string(4096, ' '));
      std::this_thread::sleep_for(milliseconds(2)); // the server's thread has taken it
    }
    int forms = 0;
    std::string newest;
    while (!newest.starts_with(std::to_string(last))) {
      const auto message = client.next();
      REQUIRE(message);
      ++forms;
      newest.assign(reinterpret_cast<const char*>(message->payload.data()) + 4,
                    message->payload.size() - 4);
    }
    CHECK(forms < last / 2);
  }

  TEST_CASE("of a puppet, a client that does not read misses frames, and then continues with the "
            "weights that it has, without a shape") {
    ServerLimits limits;
    limits.max_queued_bytes = 8192;
    limits.send_buffer_bytes = 4096;
    Served served(flow::Mode::type1, limits, test::ball_puppet);
    served.begin();
    Viewer viewer(served, 4096);
    CHECK(viewer.follow_until([&] { return viewer.follows() && viewer.vectors > 0; }));
    CHECK(eventually([&] { return served.server->counters().skipped > 50; }));
    CHECK(
        viewer.follow_until([&] { return viewer.skipped > 50 && viewer.number == viewer.newest; }));
    CHECK(viewer.good);
    CHECK(viewer.weights == 1);
    CHECK(viewer.shapes <= 2);
  }

  TEST_CASE(
      "clients that are silent or do not finish a request are dropped after their time limit") {
    ServerLimits limits;
    limits.request_timeout = milliseconds(100);
    limits.ping_period = milliseconds(50);
    limits.silence_timeout = milliseconds(300);
    Served served(flow::Mode::type1, limits);
    served.begin();
    WebClient half(*served.server);
    half.send("GET / HTTP/1.1\r\nHost: 127");
    WebClient mute(*served.server); // half-open: never answers a ping
    REQUIRE(mute.open_socket() == 101);
    CHECK(half.is_closed());
    bool asked = false;
    while (const auto frame = mute.next())
      asked = asked || frame->opcode == 9;
    CHECK(asked);
    CHECK(mute.is_closed());
    CHECK(served.server->counters().dropped >= 2);
  }

  TEST_CASE("a client that sends too many messages is closed, and one that sends fewer is heard") {
    ServerLimits limits;
    limits.message_burst = 20.0;
    limits.messages_per_second = 50.0;
    Served served(flow::Mode::type1, limits);
    served.begin();
    Viewer steady(served);
    for (int n = 0; n < 60; ++n) { // more than at once, and 25 per second
      CHECK(steady.client.send_text("wrist left 0 0 0 0 0 0 1"));
      std::this_thread::sleep_for(milliseconds(40));
    }
    WebClient flood(*served.server);
    REQUIRE(flood.open_socket() == 101);
    for (int n = 0; n < 500; ++n)
      flood.send_text("wrist left 0 0 0 0 0 0 1");
    CHECK(flood.close_code() == 1008);
    CHECK(steady.client.send_text("let go"));
    CHECK(steady.follow_until([&] { return steady.updates > 0 && !steady.held; }));
  }

  TEST_CASE("a client that takes no byte is dropped after its time limit, and so is one that never "
            "catches up") {
    ServerLimits no_byte = generous();
    no_byte.stall_timeout = milliseconds(200);
    ServerLimits not_all = generous();
    not_all.lag_timeout = milliseconds(300);
    for (const auto& way : {std::pair{no_byte, 0U}, {not_all, 1U}}) {
      CAPTURE(way.second);
      Served served(flow::Mode::type1, way.first);
      served.begin();
      WebClient client(*served.server, small_buffer);
      REQUIRE(client.open_socket() == 101);
      CHECK(eventually([&] { return served.server->counters().updates > 0; }));
      CHECK(eventually([&] {
        if (way.second > 0) client.take(way.second);
        return served.server->counters().dropped == 1;
      }));
      CHECK(eventually([&] { return served.server->counters().clients == 0; }));
    }
  }

  TEST_CASE("a client that takes what it is sent, however late, is not silent") {
    ServerLimits limits = generous();
    limits.silence_timeout = milliseconds(1500);
    Served served(flow::Mode::type1, limits);
    served.begin();
    WebClient client(*served.server, small_buffer); // answers no ping
    REQUIRE(client.open_socket() == 101);
    std::size_t taken = 0;
    const auto behind = [&] {
      const auto counters = served.server->counters();
      return counters.update_bytes + counters.shape_bytes - taken;
    };
    for (const HostTime end = HostClock::now() + milliseconds(3500); HostClock::now() < end;) {
      if (behind() > 16 * small_buffer) taken += client.take(1000);
      std::this_thread::sleep_for(milliseconds(1));
    }
    CHECK(served.server->counters().dropped == 0);
    CHECK(served.server->counters().clients == 1);
    CHECK(eventually([&] { return served.server->counters().dropped == 1; })); // it has stopped
  }

  TEST_CASE("an answer may take longer than a WebSocket may lag, while the client takes bytes") {
    ServerLimits limits = generous();
    limits.lag_timeout = milliseconds(100);
    limits.stall_timeout = milliseconds(5000);
    const auto server = nendo::test::open_server(limits);
    const std::size_t page_bytes = WebClient(*server).get("/").body.size();
    WebClient slow(*server, small_buffer);
    slow.send("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    for (int n = 0; n < 8; ++n) {
      std::this_thread::sleep_for(milliseconds(100)); // that it is overdue is seen every 250 ms
      slow.take(1000);
    }
    REQUIRE(page_bytes > 8 * 1000 + 8 * small_buffer); // it is still on its way
    CHECK(slow.answer().body.size() == page_bytes);
    CHECK(server->counters().dropped == 0);
  }

  TEST_CASE(
      "a client that stops reading while others undo has one shape waiting, not one for each") {
    Served served(flow::Mode::type1, generous());
    served.begin();
    Viewer viewer(served, small_buffer);
    REQUIRE(viewer.follow_until([&] { return viewer.follows() && viewer.held; }));
    viewer.client.send_text("commit");
    REQUIRE(viewer.follow_until([&] { return viewer.rest_changes == 1; }));
    const auto counters = [&] { return served.server->counters(); };
    const auto full = counters().update_bytes + 16 * small_buffer; // takes no more by then
    REQUIRE(eventually([&] { return counters().update_bytes > full; }));
    const auto shapes = counters().shapes;
    for (std::uint64_t turn = 1; turn <= 20; ++turn) {
      viewer.client.send_text(turn % 2 == 1 ? "undo" : "redo");
      REQUIRE(eventually([&] { return newest_frame(served).shape_jumps >= turn; }));
      const auto updates = counters().updates + 3;
      REQUIRE(eventually([&] { return counters().updates >= updates; }));
    }
    CHECK(counters().shapes > shapes); // they did want one
    CHECK(counters().shapes <= shapes + 2);
    const int taken = viewer.shapes;
    CHECK(viewer.follow_until([&] { return viewer.shapes > taken; }));
    CHECK(
        viewer.follow_until([&] { return viewer.jumps == 20 && viewer.number == viewer.newest; }));
  }

  TEST_CASE("when the last viewer has gone, the tick makes no records") {
    Served served(flow::Mode::type1, generous());
    served.begin();
    {
      Viewer viewer(served);
      CHECK(viewer.follow_until([&] { return viewer.updates > 3; }));
    }
    REQUIRE(eventually([&] { return served.server->counters().clients == 0; }));
    const auto lost = served.streamed.stream->lost();
    const auto later = newest_frame(served).ticks_run + 3000; // more than fit the ring
    CHECK(eventually([&] { return newest_frame(served).ticks_run > later; }));
    CHECK(served.streamed.stream->lost() == lost);
  }

  TEST_CASE("the number of connections is limited, and a client that has a WebSocket keeps it") {
    ServerLimits limits;
    limits.max_connections = 6;
    limits.max_clients = 3;
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

  TEST_CASE("connections without the token do not end one that sends a file") {
    ServerLimits limits = generous();
    limits.max_connections = 4;
    const auto server = nendo::test::open_server(limits);
    server->set_form(web::FormKind::screen, "{}");
    WebClient sender(*server);
    sender.send("POST " + sender.with_token("/open") +
                "&name=a.obj HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 2\r\n\r\nv");
    const auto has_begun = [&] { // so another file is refused
      WebClient other(*server);
      other.send("POST " + other.with_token("/open") +
                 "&name=b.obj HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 9\r\n\r\n");
      return other.answer().status == 503;
    };
    REQUIRE(eventually(has_begun));
    std::vector<std::unique_ptr<WebClient>> idle; // more than there are places
    for (int n = 0; n < 20; ++n)
      idle.push_back(std::make_unique<WebClient>(*server));
    CHECK(WebClient(*server).get("/").status == 200);
    sender.send("v");
    CHECK(sender.answer().status == 200);
  }

  TEST_CASE("ten slow and hostile clients do not touch the loop, nor another client") {
    ServerLimits limits;
    limits.max_queued_bytes = 16384;
    limits.send_buffer_bytes = 4096;
    Served served(flow::Mode::type2, limits);
    Viewer quiet(served);
    std::vector<std::unique_ptr<WebClient>> hostile;
    for (int n = 0; n < 10; ++n)
      hostile.push_back(std::make_unique<WebClient>(*served.server, 2048));
    for (std::size_t n = 0; n < 5; ++n)
      hostile[n]->open_socket();
    served.begin();
    for (int round = 0; round < 200; ++round) {
      hostile[0]->send("");                                        // takes nothing
      hostile[1]->send(client_frame(0x89, std::string(100, 'x'))); // pings without end
      hostile[2]->send(std::string("\x81\xFF\xFF\xFF", 4));        // an endless frame
      hostile[3]->send(std::string("\x01\x80\0\0\0\0", 6));        // parts of nothing
      hostile[4]->send_text("undo");                               // presses a button all the time
      hostile[5]->send("G");                                       // a letter at a time
      hostile[6]->send(std::string(1000, '\r'));
      hostile[7]->send("GET / HTTP/1.1\r\nA: b\r\n");
      hostile[8]->get("/model?token=guess" + std::to_string(round));
      hostile[9] = std::make_unique<WebClient>(*served.server, 2048);
      const int updates = quiet.updates;
      CHECK(quiet.follow_until([&] { return quiet.updates > updates; }));
    }
    hostile.clear();
    // Shapes come with ticks, so the shapes after all undos must have come before the last tick.
    const int settled = quiet.updates + 50;
    CHECK(quiet.follow_until(
        [&] { return quiet.updates > settled && quiet.number == quiet.newest; }));
    served.end();
    const auto& stats = served.streamed.test.loop->stats();
    CHECK(stats.ticks > 100);
    CHECK(stats.failed == 0);
    CHECK(served.counts.allocations == 0);
    CHECK(served.counts.frees == 0);
    CHECK(served.counts.locks == 0);
    served.streamed.test.loop->frames().update();
    const auto& frame = served.streamed.test.loop->frames().front();
    CHECK(frame.ticks_run == stats.ticks);
    CHECK(quiet.follow_until([&] { return quiet.number == frame.ticks_run; }));
    const auto shape = served.streamed.test.vertices_of(frame);
    CHECK((quiet.vertices() - shape).cwiseAbs().maxCoeff() < 1e-5 * quiet.diagonal);
  }
}

} // namespace server_limits_test
