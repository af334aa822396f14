#include <random>

#include <doctest/doctest.h>

#include "web/web_socket.hpp"
#include "web_client.hpp"

namespace socket_frames_test {

using namespace nendo::web;

namespace {

using Kind = ClientEvent::Kind;
using nendo::test::client_frame;

/// All events of these bytes, given in pieces of so many.
std::vector<ClientEvent> events_of(const std::string& bytes, std::size_t piece) {
  ClientReader reader;
  std::vector<ClientEvent> events;
  std::string waiting;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    waiting += bytes.substr(at, piece);
    for (auto event = reader.next(waiting); event.kind != Kind::nothing;
         event = reader.next(waiting))
      events.push_back(event);
  }
  return events;
}

ClientEvent only_event(const std::string& bytes) {
  const auto events = events_of(bytes, bytes.size());
  REQUIRE(events.size() == 1);
  return events[0];
}

} // namespace

TEST_SUITE("socket_frames") {
  TEST_CASE("the examples of RFC 6455, section 5.7") {
    const ClientEvent hello = only_event("\x81\x85\x37\xFA\x21\x3D\x7F\x9F\x4D\x51\x58");
    CHECK(hello.kind == Kind::text);
    CHECK(hello.payload == "Hello");
    CHECK(server_head(Opcode::text, 5) + "Hello" == "\x81\x05Hello");
    CHECK(control_frame(Opcode::ping, "Hello") == "\x89\x05Hello");
    using namespace std::string_literals;
    CHECK(server_head(Opcode::binary, 256) == "\x82\x7E\x01\x00"s);
    CHECK(server_head(Opcode::binary, 65536) == "\x82\x7F\x00\x00\x00\x00\x00\x01\x00\x00"s);
    CHECK(server_head(Opcode::binary, 125).size() == 2);
    CHECK(server_head(Opcode::binary, 126).size() == 4);
    CHECK(server_head(Opcode::binary, 65535).size() == 4);
    CHECK(close_frame(CloseCode::normal) == "\x88\x02\x03\xE8");
    CHECK(close_frame(CloseCode::policy, "too far") == "\x88\x09\x03\xF0too far");
    CHECK(close_frame(CloseCode::policy, std::string(500, 'w')).size() == 2 + 125);
  }

  TEST_CASE("a message in parts is one, with a ping between, however the bytes are cut") {
    const std::string bytes = client_frame(0x01, "let") + client_frame(0x89, "there?") +
                              client_frame(0x00, "") + client_frame(0x80, " go") +
                              client_frame(0x82, "\x01") + client_frame(0x8A, "") +
                              client_frame(0x88, "");
    for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
      const auto events = events_of(bytes, piece);
      REQUIRE(events.size() == 5);
      CHECK(events[0].kind == Kind::ping);
      CHECK(events[0].payload == "there?");
      CHECK(events[1].kind == Kind::text);
      CHECK(events[1].payload == "let go");
      CHECK(events[2].kind == Kind::binary);
      CHECK(events[3].kind == Kind::pong);
      CHECK(events[4].kind == Kind::close);
    }
  }

  TEST_CASE("what breaks the protocol is a fault with its code, and ends all events") {
    const auto fault = [](const std::string& bytes, CloseCode code) {
      ClientReader reader;
      std::string waiting = bytes + client_frame(0x81, "grab");
      ClientEvent event = reader.next(waiting);
      while (event.kind != Kind::nothing && event.kind != Kind::fault)
        event = reader.next(waiting);
      CHECK(event.kind == Kind::fault);
      CHECK(event.code == code);
      CHECK(reader.next(waiting).kind == Kind::nothing);
    };
    fault(client_frame(0x81, "grab", false), CloseCode::protocol_error); // not masked
    for (const unsigned bit : {0x40U, 0x20U, 0x10U})
      fault(client_frame(0x81 | bit, "x"), CloseCode::protocol_error);
    for (const unsigned opcode : {3U, 4U, 5U, 6U, 7U, 11U, 12U, 13U, 14U, 15U})
      fault(client_frame(0x80 | opcode, "x"), CloseCode::protocol_error);
    fault(client_frame(0x09, "x"), CloseCode::protocol_error); // a ping in parts
    fault(client_frame(0x89, std::string(126, 'x')), CloseCode::protocol_error);
    fault(client_frame(0x80, "x"), CloseCode::protocol_error); // continues from nothing
    fault(client_frame(0x01, "x") + client_frame(0x81, "y"), CloseCode::protocol_error);
    fault(client_frame(0x81, std::string(max_client_message + 1, 'x')), CloseCode::too_big);
    fault(client_frame(0x01, std::string(max_client_message, 'x')) + client_frame(0x80, "y"),
          CloseCode::too_big);
    fault("\x81\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF", CloseCode::too_big); // 2^64 - 1 bytes
  }

  TEST_CASE("the largest message is taken whole, and its bytes fit into what may wait") {
    const std::string frame = client_frame(0x81, std::string(max_client_message, 'x'));
    CHECK(frame.size() <= ClientReader::max_pending);
    CHECK(only_event(frame).payload.size() == max_client_message);
  }

  TEST_CASE("of any bytes come bounded payloads, and no more bytes than were given") {
    std::mt19937 random(7);
    for (int trial = 0; trial < 2000; ++trial) {
      std::string bytes;
      for (auto count = random() % 64; count > 0; --count)
        bytes += random() % 3 == 0 ? client_frame(random() % 256, std::string(random() % 9, 'x'))
                                   : std::string(1, static_cast<char>(random() % 256));
      std::size_t received = 0;
      for (const auto& event : events_of(bytes, 1 + random() % 40))
        received += event.payload.size();
      CHECK(received <= bytes.size());
    }
  }
}

} // namespace socket_frames_test
