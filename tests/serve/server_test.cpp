#include "serve/server.hpp"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "serve_fixtures.hpp"
#include "support/shell.hpp"

namespace server_test {

using namespace nendo;
using namespace std::chrono_literals;
using nlohmann::ordered_json;
using test::eventually;
using test::LineClient;
using test::ServedHands;

namespace {

const std::string samples_on = R"({"class":"WATCH","samples":true})";
const std::string samples_off = R"({"class":"WATCH","samples":false})";

/// A client that has read the introduction.
LineClient introduced(const ServedHands& served) {
  LineClient client(served.server->path());
  for (int line = 0; line < 4; ++line)
    client.next();
  return client;
}

void show(serve::Server& server, std::uint64_t tick, bool present = true) {
  static auto frame = std::make_unique<flow::Frame>();
  frame->tick = tick;
  frame->woke = HostClock::now();
  for (flow::HandFrame& hand : frame->hands) {
    hand.present = present;
    for (Eigen::Isometry3d& joint : hand.pose.joints)
      joint.setIdentity();
  }
  server.frames().show(*frame);
}

/// What a client got of a glove.
struct Received {
  std::vector<std::uint64_t> numbers;
  std::uint64_t dropped = 0;
};

/// Reads until the sample `last` of the left glove. `progress` is the number of samples so far.
Received received_until(LineClient& client, std::uint64_t last,
                        std::atomic<std::uint64_t>* progress = nullptr) {
  Received received;
  while (received.numbers.empty() || received.numbers.back() != last) {
    const ordered_json line = client.next();
    if (line["class"] != "SAMPLE" || line["glove"] != 0) continue;
    received.numbers.push_back(line["sequence"].get<std::uint64_t>());
    received.dropped += line["dropped"].get<std::uint64_t>();
    if (progress != nullptr) *progress = received.numbers.size();
  }
  return received;
}

} // namespace

TEST_SUITE("serve_server") {
  TEST_CASE("a client is introduced to the server and its devices") {
    const ServedHands served;
    LineClient client(served.server->path());
    const auto version = client.next();
    CHECK(version["class"] == "VERSION");
    CHECK(version["protocol"] == 1);
    CHECK(version["name"] == "hands");
    for (const char* side : {"left", "right"}) {
      const auto glove = client.next();
      CHECK(glove["class"] == "GLOVE");
      CHECK(glove["index"] == (side == std::string("left") ? 0 : 1));
      CHECK(glove["side"] == side);
      CHECK(glove["facts"]["serial"] == "A" + std::string(side));
    }
    const auto tracker = client.next();
    CHECK(tracker["class"] == "TRACKER");
    CHECK(tracker["side"] == "right");
    CHECK(tracker["station"] == 4);
    CHECK(served.server->counters().accepted == 1);
  }

  TEST_CASE("samples and poses come in order, each with the index of its device") {
    const ServedHands served;
    LineClient client = introduced(served);
    const auto answer = client.ask(samples_on);
    CHECK(answer ==
          ordered_json{{"class", "WATCH"}, {"samples", true}, {"hands", false}, {"rate_hz", 30.0}});
    PoseSample pose;
    pose.station = 4;
    for (std::uint64_t number = 0; number < 50; ++number) {
      served.send(ServedHands::right_input, number);
      pose.sequence = number;
      served.server->input().pose(Side::right, pose);
      served.server->input().pose(Side::left, pose); // of no served tracker
      served.server->input().command(flow::Request::commit);
      served.server->input().tick(number, {}, {});
      served.send(7, number); // of no served glove
    }
    for (std::uint64_t number = 0; number < 50; ++number) {
      const auto sample = client.next();
      CHECK(sample["class"] == "SAMPLE");
      CHECK(sample["glove"] == 1);
      CHECK(sample["sequence"] == number);
      CHECK(sample["dropped"] == 0);
      const auto place = client.next();
      CHECK(place["class"] == "POSE");
      CHECK(place["tracker"] == 0);
      CHECK(place["sequence"] == number);
    }
    client.ask(samples_off);
    served.send(ServedHands::left_input, 1);
    std::this_thread::sleep_for(20ms);
    CHECK(client.ask(samples_on)["samples"] == true); // no sample before
  }

  TEST_CASE("clients that stall, send garbage or leave cost the others nothing") {
    const ServedHands served;
    LineClient good = introduced(served);
    LineClient stalled = introduced(served);
    LineClient leaving = introduced(served);
    LineClient hostile = introduced(served);
    for (LineClient* client : {&good, &stalled, &leaving, &hostile})
      client->ask(samples_on);
    constexpr std::uint64_t count = 500;
    Received received;
    std::atomic<std::uint64_t> progress{0};
    std::jthread reader([&] { received = received_until(good, count - 1, &progress); });
    for (std::uint64_t number = 0; number < count; ++number) {
      served.send(ServedHands::left_input, number);
      served.send(ServedHands::right_input, number);
      if (number == 200) leaving.leave();
      if (number == 300) hostile.send("\xFF\x01 GET / HTTP/1.1\n");
      REQUIRE(eventually([&] { return progress + 20 > number; })); // the good one keeps up
    }
    reader.join();
    REQUIRE(received.numbers.size() + received.dropped == count);
    CHECK(received.dropped == 0);
    CHECK(eventually([&] { return served.server->counters().clients == 2; }));
    // The stalled one gets the newest, and knows the number of those that it missed.
    const Received late = received_until(stalled, count - 1);
    CHECK(late.numbers.size() + late.dropped == count);
    CHECK(late.dropped > count / 4);
    CHECK(served.server->counters().dropped >= late.dropped);
    for (std::size_t at = 1; at < late.numbers.size(); ++at)
      CHECK(late.numbers[at] > late.numbers[at - 1]);
  }

  TEST_CASE("what the full log refused is counted as dropped") {
    const ServedHands served({.log_entries = 256});
    LineClient client = introduced(served);
    client.ask(samples_on);
    constexpr std::uint64_t count = 20'000; // faster than any server
    for (std::uint64_t number = 0; number < count; ++number)
      served.send(ServedHands::left_input, number);
    REQUIRE(served.server->counters().lost > 0);
    std::uint64_t sent = count;
    for (std::uint64_t lost = 0; lost != served.server->counters().lost; ++sent) {
      std::this_thread::sleep_for(20ms);
      lost = served.server->counters().lost;
      served.send(ServedHands::left_input, count); // until the log takes it
    }
    const Received received = received_until(client, count);
    CHECK(received.numbers.size() + received.dropped == sent);
  }

  TEST_CASE("wrong requests get an error and the end of the connection") {
    const ServedHands served;
    for (const std::string& request :
         {std::string("\n"), std::string("x\n"), std::string("{\"class\":\"LIST\"}\n"),
          std::string("{\"class\":\"WATCH\",\"samples\":\"yes\"}\n"), std::string(4096, 'x'),
          std::string(9000, 'x'), std::string("\0\0\n", 3),
          "{\"class\":\"WATCH\",\"pad\":\"" + std::string(5000, ' ') + "\"}\n"}) {
      CAPTURE(request.substr(0, 40));
      LineClient client = introduced(served);
      client.send(request);
      const auto line = client.next();
      CHECK(line["class"] == "ERROR");
      CHECK_FALSE(line["message"].get<std::string>().empty());
      CHECK(client.is_closed());
    }
    CHECK(eventually([&] { return served.server->counters().clients == 0; }));
  }

  TEST_CASE("a request of 4096 bytes is taken, whole or in pieces") {
    const ServedHands served;
    LineClient client = introduced(served);
    const std::string padded = R"({"class":"WATCH","hands":true,"pad":")";
    const std::string request = padded + std::string(4096 - padded.size() - 3, ' ') + "\"}";
    REQUIRE(request.size() + 1 == 4096);
    CHECK(client.ask(request)["hands"] == true);
    for (const char letter : samples_on)
      client.send(std::string(1, letter));
    CHECK(client.ask("")["samples"] == true);
    // Several in one piece, each with its answer.
    client.send(samples_off + "\n" + samples_on + "\n");
    CHECK(client.next()["samples"] == false);
    CHECK(client.next()["samples"] == true);
  }

  TEST_CASE("a flood of requests ends the connection and fills no memory") {
    const ServedHands served;
    LineClient client = introduced(served);
    std::string flood;
    for (int at = 0; at < 100; ++at)
      flood += samples_on + "\n";
    while (client.send(flood)) {
    }
    CHECK(eventually([&] { return served.server->counters().clients == 0; }));
    LineClient other = introduced(served);
    CHECK(other.ask(samples_on)["samples"] == true);
  }

  TEST_CASE("the thirty-third client is refused, until one leaves") {
    const ServedHands served;
    std::vector<LineClient> clients;
    for (int at = 0; at < 32; ++at)
      clients.push_back(introduced(served));
    LineClient more(served.server->path());
    CHECK(more.next()["class"] == "ERROR");
    CHECK(more.is_closed());
    CHECK(served.server->counters().refused == 1);
    clients.pop_back();
    CHECK(eventually([&] { return served.server->counters().clients == 31; }));
    LineClient next = introduced(served);
    CHECK(next.ask(samples_on)["samples"] == true);
  }

  TEST_CASE("a client that has ended its sending side still gets what it asked for") {
    const ServedHands served;
    LineClient client = introduced(served);
    client.send(samples_on); // without a line end
    client.end_sending();
    CHECK(client.next()["samples"] == true);
    served.send(ServedHands::left_input, 5);
    CHECK(client.next()["sequence"] == 5);
    LineClient idle = introduced(served);
    idle.end_sending();
    CHECK(idle.is_closed());
  }

  TEST_CASE("hands come at the rate that was asked for, each frame once") {
    const ServedHands served;
    LineClient client = introduced(served);
    client.ask(R"({"class":"WATCH","hands":true,"rate_hz":50})");
    LineClient slow = introduced(served);
    slow.ask(R"({"class":"WATCH","hands":true,"rate_hz":5})");
    const HostTime begin = HostClock::now();
    for (std::uint64_t tick = 1; tick <= 400; ++tick) {
      show(*served.server, tick);
      std::this_thread::sleep_for(1ms);
    }
    const auto ticks_of = [](LineClient& one) {
      one.send(samples_off + "\n");
      std::vector<std::uint64_t> ticks;
      for (auto line = one.next(); line["class"] == "HANDS"; line = one.next()) {
        CHECK(line["hands"].size() == 2);
        CHECK(line["skipped"] == 0);
        ticks.push_back(line["tick"].get<std::uint64_t>());
      }
      return ticks;
    };
    const auto fast_ticks = ticks_of(client);
    const auto slow_ticks = ticks_of(slow);
    const double seconds = to_seconds(HostClock::now() - begin);
    CHECK(fast_ticks.size() >= 5); // 20 in 400 ms, fewer on a busy machine
    CHECK(static_cast<double>(fast_ticks.size()) <= 50.0 * seconds + 2.0);
    CHECK(slow_ticks.size() >= 1);
    CHECK(static_cast<double>(slow_ticks.size()) <= 5.0 * seconds + 2.0);
    for (std::size_t at = 1; at < fast_ticks.size(); ++at)
      CHECK(fast_ticks[at] > fast_ticks[at - 1]);
  }

  TEST_CASE("a client that does not read skips frames, and gets the newest afterwards") {
    const ServedHands served;
    LineClient client = introduced(served);
    client.ask(R"({"class":"WATCH","hands":true,"rate_hz":1000})");
    std::atomic<std::uint64_t> tick{0};
    for (; served.server->counters().dropped < 20; std::this_thread::sleep_for(500us))
      show(*served.server, ++tick);
    std::uint64_t got = 0;
    std::uint64_t skipped = 0;
    std::uint64_t newest = 0;
    std::atomic<bool> over{false};
    std::jthread loop([&] {
      for (; !over; std::this_thread::sleep_for(1ms))
        show(*served.server, ++tick);
    });
    while (skipped == 0 || newest + 50 < tick) {
      const auto line = client.next();
      ++got;
      skipped += line["skipped"].get<std::uint64_t>();
      newest = line["tick"].get<std::uint64_t>();
    }
    over = true;
    loop.join();
    CHECK(skipped >= 20);
    CHECK(got + skipped <= tick);
  }

  TEST_CASE("a server that ends closes its connections and leaves no file") {
    ServedHands served;
    LineClient client = introduced(served);
    const std::string path = served.server->path();
    served.server.reset();
    CHECK(client.is_closed());
    CHECK_FALSE(std::filesystem::exists(path));
  }

  TEST_CASE("a client in Python that was made from PROTOCOL.md reads all classes") {
    const ServedHands served;
    std::atomic<bool> over{false};
    std::jthread loop([&] {
      PoseSample pose;
      pose.station = 4;
      pose.turn_xyzw = {0.5, -0.5, 0.5, 0.5};
      for (std::uint64_t number = 0; !over; ++number) {
        served.send(ServedHands::left_input, number);
        served.send(ServedHands::right_input, number);
        pose.sequence = number;
        pose.arrival = HostClock::now();
        pose.measured = pose.arrival - 2ms;
        pose.position_m = {static_cast<double>(number) / 3.0, 0.1, -1e-300};
        served.server->input().pose(Side::right, pose);
        served.server->input().tick(number, {}, {});
        show(*served.server, number);
        std::this_thread::sleep_for(2ms);
      }
    });
    const auto client =
        test::shell("python3 " NENDO_SERVE_CLIENT " " + served.server->path() + " 100");
    over = true;
    loop.join();
    CHECK_MESSAGE(client.exit_code == 0, client.out);
    CHECK(client.out == "VERSION 1\nGLOVE 2\nTRACKER 1\nSAMPLE 200\nPOSE 100\nHANDS 10\n"
                        "closed after an error\n");
  }
}

} // namespace server_test
