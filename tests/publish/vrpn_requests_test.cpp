#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "publish/vrpn_messages.hpp"
#include "publish/vrpn_requests.hpp"

namespace vrpn_requests_test {

using namespace nendo;
using namespace nendo::publish::vrpn;

namespace {

// Written here from VRPN's description, and not by the encoder of the driver.

std::string number(std::uint32_t value) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U})
    bytes += static_cast<char>(value >> shift & 0xFFU);
  return bytes;
}

std::string message(int sender, int type, const std::string& payload = "") {
  return number(static_cast<std::uint32_t>(24 + payload.size())) + number(0) + number(0) +
         number(static_cast<std::uint32_t>(sender)) + number(static_cast<std::uint32_t>(type)) +
         number(0) + payload + std::string((8 - payload.size() % 8) % 8, '\0');
}

std::string name(int type, int of, const std::string& text) {
  return message(of, type,
                 number(static_cast<std::uint32_t>(text.size() + 1)) + text + std::string(1, '\0'));
}

std::string cookie(const std::string& version = "vrpn: ver. 07.35") {
  return (version + "  0" + std::string(24, '\0')).substr(0, 24);
}

struct Answer {
  std::vector<std::size_t> pinged;
  bool is_readable = true;
};

/// Pushes the bytes in pieces of this length.
Answer answer_to(Requests& requests, const std::string& bytes, std::size_t piece = 1 << 20) {
  Answer answer;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    const std::string part = bytes.substr(at, piece);
    answer.is_readable = requests.push(std::as_bytes(std::span(part)), answer.pinged);
    CHECK(requests.held_bytes() < Requests::max_held_bytes);
  }
  return answer;
}

Answer answer_to(const std::string& bytes, std::size_t piece = 1 << 20) {
  Requests requests;
  return answer_to(requests, bytes, piece);
}

} // namespace

TEST_SUITE("vrpn_requests") {
  TEST_CASE("pings are found in a stream that is cut anywhere, by the client's own numbers") {
    const std::string bytes = cookie() + name(-2, 1999, "vrpn_Base ping_message") +
                              name(-1, 0, "Hand1") + name(-1, 7, "Glove0") +
                              name(-1, 8, "Tracker0") + message(0, 1999) + message(8, 1999) +
                              message(7, 5) + message(7, 1999, "payload");
    for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
      const Answer answer = answer_to(bytes, piece);
      CHECK(answer.is_readable);
      REQUIRE(answer.pinged.size() == 2);
      CHECK(sender_names[answer.pinged[0]] == "Hand1");
      CHECK(sender_names[answer.pinged[1]] == "Glove0");
    }
  }

  TEST_CASE("the last name of a number counts") {
    const std::string bytes = cookie() + name(-2, 1, "vrpn_Base ping_message") +
                              name(-1, 2, "Hand0") + name(-1, 2, "Other") + message(2, 1) +
                              name(-1, 2, "Glove1") + message(2, 1) + name(-2, 1, "other") +
                              message(2, 1);
    const Answer answer = answer_to(bytes);
    REQUIRE(answer.pinged.size() == 1);
    CHECK(sender_names[answer.pinged[0]] == "Glove1");
  }

  TEST_CASE("what is no VRPN 7 cannot be read, nor can a message of a wrong length") {
    CHECK_FALSE(answer_to(cookie("vrpn: ver. 08.01")).is_readable);
    CHECK_FALSE(answer_to("GET / HTTP/1.1\r\nHost: x\r\n").is_readable);
    CHECK(answer_to(cookie("vrpn: ver. 07.99")).is_readable);
    for (const std::uint32_t length : {0U, 23U, 65537U, 0xFFFFFFFFU}) {
      Requests requests;
      CHECK_FALSE(
          answer_to(requests, cookie() + number(length) + std::string(20, '\0')).is_readable);
      CHECK_FALSE(answer_to(requests, message(0, 0)).is_readable); // and stays so
    }
  }

  TEST_CASE("long messages are skipped, and names and numbers that cannot be are ignored") {
    std::string bytes = cookie() + name(-2, 1, "vrpn_Base ping_message") + name(-1, 2, "Hand0");
    bytes += message(2, 900, std::string(65512, 'x')) + name(-1, 2, std::string(60000, 'n'));
    for (const int wrong : {-1, 2000, 1 << 30, -(1 << 30)})
      bytes += name(-1, wrong, "Hand1") + name(-2, wrong, "vrpn_Base ping_message") +
               message(wrong, 1) + message(2, wrong == -1 ? -3 : wrong);
    bytes += message(3, -1) + message(2, -1, number(0xFFFFFFFF) + "Hand0");
    bytes += name(-1, 2, "Hand0") + message(2, 1);
    for (const std::size_t piece : {std::size_t{1}, std::size_t{1000}, bytes.size()}) {
      const Answer answer = answer_to(bytes, piece);
      CHECK(answer.is_readable);
      CHECK(answer.pinged.size() == 1);
    }
  }
}

} // namespace vrpn_requests_test
