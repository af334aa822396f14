#include <array>
#include <bit>
#include <chrono>
#include <cstring>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/base/byte_reader.hpp>

#include "publish/vrpn_server.hpp"
#include "support/eventually.hpp"

namespace vrpn_server_test {

using namespace nendo;
using namespace nendo::publish;
using test::eventually;
using vrpn::Server;

namespace {

// Another reader of the protocol than those of the driver and the server. The test owns both ends,
// so the server is served by each look at its bytes.

struct Message {
  std::string sender, type, payload;
  std::uint64_t time_us = 0;
};

class TestClient {
public:
  TestClient(Server& server, UniqueFd socket) : server_(server), socket_(std::move(socket)) {}
  /// receive_buffer: bytes that the system keeps for the client; 0: the system's choice.
  static UniqueFd connected_to(const Server& server, int receive_buffer = 0) {
    UniqueFd socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (receive_buffer > 0)
      REQUIRE(::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &receive_buffer,
                           sizeof receive_buffer) == 0);
    const SocketAddress to = server.endpoint().socket_address();
    REQUIRE(::connect(socket.get(), &to.address.any, to.length) == 0);
    return socket;
  }
  explicit TestClient(Server& server) : TestClient(server, connected_to(server)) {}

  void say(const std::string& bytes) const {
    REQUIRE(::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
            static_cast<ssize_t>(bytes.size()));
  }
  void greet() {
    std::string cookie = "vrpn: ver. 07.35  0";
    cookie.resize(24);
    say(cookie);
    REQUIRE(eventually([&] {
      look();
      return types_.size() == 5;
    }));
  }
  /// Returns whether the server has closed the connection.
  bool look() {
    server_.serve();
    std::array<char, 65536> part{};
    ssize_t got = 0;
    while ((got = ::recv(socket_.get(), part.data(), part.size(), MSG_DONTWAIT)) > 0)
      bytes_.append(part.data(), static_cast<std::size_t>(got));
    if (!has_cookie_ && bytes_.size() >= 24) {
      CHECK(bytes_.substr(0, 14) == "vrpn: ver. 07.");
      bytes_.erase(0, 24);
      has_cookie_ = true;
    }
    while (has_cookie_ && take()) {
    }
    return got == 0 || (got < 0 && errno == ECONNRESET);
  }
  std::vector<Message> take_all() {
    look();
    return std::exchange(messages_, {});
  }
  bool has_cookie() const { return has_cookie_; }
  const std::map<int, std::string>& senders() const { return senders_; }

private:
  bool take() {
    if (bytes_.size() < 24) return false;
    const auto all = std::as_bytes(std::span(bytes_));
    ByteReader reader(all);
    const std::size_t length = reader.u32_be();
    REQUIRE(length >= 24);
    const std::size_t padded = (length + 7) / 8 * 8;
    if (bytes_.size() < padded) return false;
    const std::uint64_t seconds = reader.u32_be(), micros = reader.u32_be();
    const int sender = reader.i32_be(), type = reader.i32_be();
    const std::string payload = bytes_.substr(24, length - 24);
    bytes_.erase(0, padded);
    if (type == -1 || type == -2) {
      (type == -1 ? senders_ : types_)[sender] = payload.substr(4, payload.size() - 5);
    } else {
      messages_.push_back(
          {senders_.at(sender), types_.at(type), payload, 1'000'000 * seconds + micros});
    }
    return true;
  }

  Server& server_;
  UniqueFd socket_;
  std::string bytes_;
  bool has_cookie_ = false;
  std::map<int, std::string> senders_, types_;
  std::vector<Message> messages_;
};

HandsRecord some_hands() {
  HandsRecord record;
  record.record.woke_ns = HostClock::now().time_since_epoch().count();
  for (std::size_t side = 0; side < 2; ++side) {
    auto& hand = record.record.hands[side];
    hand.flags = NENDO_PUBLISH_PRESENT;
    for (std::size_t joint = 0; joint < NENDO_PUBLISH_JOINTS; ++joint) {
      auto& to = hand.joints[joint];
      to.position[0] = static_cast<float>(joint) / 8.0F;
      to.position[1] = static_cast<float>(side);
      to.orientation[3] = 1.0F;
    }
    for (std::size_t angle = 0; angle < NENDO_PUBLISH_ANGLES; ++angle)
      record.states.hands[side].angles[angle] = 0.01 * static_cast<double>(angle);
  }
  return record;
}

std::size_t count_of(const std::vector<Message>& messages, const std::string& sender) {
  return static_cast<std::size_t>(std::count_if(
      messages.begin(), messages.end(), [&](const auto& one) { return one.sender == sender; }));
}

std::vector<double> doubles_in(const std::string& payload, std::size_t from) {
  ByteReader reader(std::as_bytes(std::span(payload)).subspan(from));
  std::vector<double> numbers;
  while (reader.remaining() >= 8)
    numbers.push_back(reader.f64_be());
  return numbers;
}

Server open_server() {
  for (int attempt = 0; attempt < 20; ++attempt) { // a free port of TCP may be one of UDP's in use
    auto server = Server::open({});
    if (server) return *std::move(server);
  }
  FAIL("no port");
  std::abort();
}

std::vector<Message> sent_to(TestClient& client, Server& server, const HandsRecord& record) {
  client.take_all();
  server.send(record);
  std::vector<Message> all;
  for (int turn = 0; turn < 20; ++turn) {
    for (auto& message : client.take_all())
      all.push_back(std::move(message));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return all;
}

} // namespace

TEST_SUITE("vrpn_server") {
  TEST_CASE(
      "a client gets the cookie, the names after its own cookie, and then joints and angles") {
    Server server = open_server();
    TestClient client(server);
    CHECK(eventually([&] {
      client.look();
      return client.has_cookie();
    }));
    CHECK(sent_to(client, server, some_hands()).empty()); // it has not greeted
    client.greet();
    std::set<std::string> senders;
    for (const auto& [number, name] : client.senders())
      senders.insert(name);
    CHECK(senders == std::set<std::string>{"VRPN Control", "Hand0", "Hand1", "Glove0", "Glove1"});
    const HandsRecord record = some_hands();
    const auto messages = sent_to(client, server, record);
    CHECK(messages.size() == 2 * (26 + 1));
    const auto now_us = std::chrono::duration_cast<std::chrono::microseconds>(
                            std::chrono::system_clock::now().time_since_epoch())
                            .count();
    std::set<std::pair<std::string, std::uint32_t>> seen;
    for (const Message& message : messages) {
      CHECK(std::abs(static_cast<double>(message.time_us) - static_cast<double>(now_us)) < 1e7);
      if (message.type == "vrpn_Analog Channel") {
        const auto numbers = doubles_in(message.payload, 0);
        REQUIRE(numbers.size() == 1 + NENDO_PUBLISH_ANGLES);
        CHECK(numbers[0] == NENDO_PUBLISH_ANGLES);
        for (std::size_t angle = 0; angle < NENDO_PUBLISH_ANGLES; ++angle)
          CHECK(numbers[1 + angle] == record.states.hands[0].angles[angle]);
        continue;
      }
      REQUIRE(message.type == "vrpn_Tracker Pos_Quat");
      REQUIRE(message.payload.size() == 64);
      const std::uint32_t sensor = ByteReader(std::as_bytes(std::span(message.payload))).u32_be();
      CHECK(seen.insert({message.sender, sensor}).second);
      const double side = message.sender == "Hand1" ? 1.0 : 0.0;
      CHECK(doubles_in(message.payload, 8) ==
            std::vector<double>{sensor / 8.0, side, 0.0, 0.0, 0.0, 0.0, 1.0});
    }
    CHECK(seen.size() == 52);
  }

  TEST_CASE("a silent glove sends nothing, a lost tracker no poses, and an absent hand nothing") {
    Server server = open_server();
    TestClient client(server);
    client.greet();
    HandsRecord record = some_hands();
    record.record.hands[0].flags |= NENDO_PUBLISH_SILENT;
    record.states.hands[1].flags |= NENDO_PUBLISH_LOST;
    const auto messages = sent_to(client, server, record);
    CHECK(messages.size() == 1);
    CHECK(count_of(messages, "Glove1") == 1);
    record.record.hands[0].flags = 0;
    record.record.hands[1].flags = 0;
    CHECK(sent_to(client, server, record).empty());
  }

  TEST_CASE("a switch is a button, which each client hears once, and again when it changes") {
    Server server = open_server();
    TestClient first(server);
    first.greet();
    HandsRecord record = some_hands();
    record.record.hands[0].flags = record.record.hands[1].flags = 0;
    record.states.hands[1].flags = NENDO_PUBLISH_HAS_SWITCH | NENDO_PUBLISH_SWITCH_ON;
    const auto state_in = [](const std::vector<Message>& messages) {
      REQUIRE(messages.size() == 1);
      CHECK(messages[0].sender == "Glove1");
      CHECK(messages[0].type == "vrpn_Button Change");
      ByteReader reader(std::as_bytes(std::span(messages[0].payload)));
      CHECK(reader.u32_be() == 0);
      return reader.u32_be();
    };
    CHECK(state_in(sent_to(first, server, record)) == 1);
    CHECK(sent_to(first, server, record).empty());
    TestClient second(server);
    second.greet();
    CHECK(state_in(sent_to(second, server, record)) == 1);
    record.states.hands[1].flags = NENDO_PUBLISH_HAS_SWITCH;
    CHECK(state_in(sent_to(first, server, record)) == 0);
    CHECK(state_in(second.take_all()) == 0);
  }

  TEST_CASE("a client that does not read misses hands, and the others get all of them") {
    // Few records and a small buffer: the server drops a client that has taken nothing for five
    // seconds, and a busy machine under a sanitizer needs milliseconds for each record.
    Server server = open_server();
    TestClient stalled(server, TestClient::connected_to(server, 8192)), fine(server);
    stalled.greet();
    fine.greet();
    const HandsRecord record = some_hands();
    std::size_t got = 0;
    constexpr std::size_t records = 120; // 540 kB, more than the system buffers
    for (std::size_t sent = 0; sent < records; ++sent) {
      server.send(record);
      std::size_t of_this = 0;
      CHECK(eventually([&] {
        of_this += fine.take_all().size();
        return of_this == 54;
      }));
      got += of_this;
    }
    CHECK(got == 54 * records);
    const auto missed = server.counts().missed;
    CHECK(missed > 0);
    CHECK(missed < records);
    // When it reads again, no message is cut, and none is left out of those that it did not miss.
    std::size_t late = 0;
    CHECK(eventually([&] {
      late += stalled.take_all().size();
      return late >= 54 * (records - missed);
    }));
    CHECK(late == 54 * (records - missed));
    CHECK(stalled.take_all().empty());
  }

  TEST_CASE("pings are answered, strangers are dropped, and there is a limit of clients") {
    Server server = open_server();
    TestClient client(server);
    client.greet();
    const std::string ping_type("\0\0\0\x33\0\0\0\0\0\0\0\0\0\0\0\x05\xff\xff\xff\xfe\0\0\0\0"
                                "\0\0\0\x17vrpn_Base ping_message\0\0\0\0\0\0",
                                56);
    const std::string sender("\0\0\0\x22\0\0\0\0\0\0\0\0\0\0\0\x09\xff\xff\xff\xff\0\0\0\0"
                             "\0\0\0\x06Hand1\0\0\0\0\0\0\0",
                             40);
    const std::string ping("\0\0\0\x18\0\0\0\0\0\0\0\0\0\0\0\x09\0\0\0\x05\0\0\0\0", 24);
    client.say(ping_type + sender + ping);
    std::vector<Message> answers;
    CHECK(eventually([&] {
      for (auto& message : client.take_all())
        answers.push_back(message);
      return !answers.empty();
    }));
    REQUIRE(answers.size() == 1);
    CHECK(answers[0].sender == "Hand1");
    CHECK(answers[0].type == "vrpn_Base pong_message");

    TestClient stranger(server);
    stranger.say("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    CHECK(eventually([&] { return stranger.look(); }));
    std::vector<TestClient> many;
    many.reserve(vrpn::max_clients);
    for (std::size_t n = 0; n < vrpn::max_clients; ++n)
      many.emplace_back(server);
    CHECK(eventually([&] {
      server.serve();
      return server.counts().refused == 1;
    }));
    CHECK(eventually([&] { return many.back().look(); }));
    CHECK(sent_to(client, server, some_hands()).size() == 54);
  }

  TEST_CASE("a client that asks by a datagram is connected to, once") {
    Server server = open_server();
    Endpoint own;
    const auto listener = open_at(own, SOCK_STREAM);
    REQUIRE(listener);
    const UniqueFd asking(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const SocketAddress to = server.endpoint().socket_address();
    const auto ask = [&](const std::string& text) {
      REQUIRE(::sendto(asking.get(), text.data(), text.size(), 0, &to.address.any, to.length) > 0);
    };
    // Only the port counts: the server connects to the sender alone.
    const std::string request = "192.0.2.7 " + std::to_string(own.port) + std::string(1, '\0');
    for (const std::string& wrong :
         {std::string(), std::string("x"), std::string("127.0.0.1 80"), std::string(500, ' '),
          std::string("127.0.0.1 99999"), std::string("127.0.0.1 -5")})
      if (!wrong.empty()) ask(wrong);
    std::optional<UniqueFd> socket;
    CHECK(eventually([&] {
      ask(request);
      server.serve();
      if (!socket) socket = accept_from(*listener, 65536);
      return socket.has_value();
    }));
    REQUIRE(socket);
    TestClient client(server, *std::move(socket));
    client.greet();
    CHECK(sent_to(client, server, some_hands()).size() == 54);
    for (int turn = 0; turn < 50; ++turn) {
      ask(request);
      server.serve();
    }
    CHECK(server.counts().clients == 1);
    CHECK_FALSE(accept_from(*listener, 65536));
  }

  TEST_CASE("a port that is in use is an error that names it") {
    const Server server = open_server();
    const auto second = Server::open(server.endpoint());
    REQUIRE_FALSE(second);
    CHECK(second.error().message.starts_with(server.endpoint().authority() + " is in use"));
  }
}

} // namespace vrpn_server_test
