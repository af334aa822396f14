#include <string>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/base/endpoint.hpp>

namespace endpoint_test {

using namespace nendo;

TEST_SUITE("endpoint") {
  TEST_CASE("a port alone is this machine's own, an address must be in figures") {
    const auto alone = parse_endpoint("8080");
    REQUIRE(alone);
    CHECK(alone->authority() == "127.0.0.1:8080");
    CHECK(parse_endpoint("0", 0)->port == 0);
    CHECK(parse_endpoint("0.0.0.0:80")->authority() == "0.0.0.0:80");
    CHECK(parse_endpoint("[::1]:65535")->authority() == "[::1]:65535");
    CHECK(parse_endpoint("[fe80::1]:1")->is_ipv6());
  }

  TEST_CASE("what is no endpoint is wrong usage, and the error says what would be one") {
    for (const std::string_view wrong : {"",
                                         ":",
                                         ":80",
                                         "0",
                                         "65536",
                                         "-1",
                                         "8080 ",
                                         "localhost:80",
                                         "box.local:80",
                                         "1.2.3:80",
                                         "127.0.0.1",
                                         "127.0.0.1:",
                                         "::1:80",
                                         "[::1]",
                                         "[::1]80",
                                         "[127.0.0.1]:80",
                                         "[::1:80",
                                         "[]:80",
                                         "127.0.0.1:80:80",
                                         "0x50",
                                         "256.0.0.1:80",
                                         "127.1:80",
                                         "2130706433:80"}) {
      CAPTURE(wrong);
      const auto parsed = parse_endpoint(wrong);
      REQUIRE_FALSE(parsed);
      CHECK(parsed.error().code == Errc::usage);
      CHECK(parsed.error().message == endpoint_rule);
    }
    CHECK_FALSE(parse_endpoint(std::string_view("127.0.0.1\0.evil.example:80", 26)));
  }

  TEST_CASE("the system's form of an endpoint is the same endpoint") {
    for (const std::string text :
         {"127.0.0.1:1", "255.255.255.255:65535", "[::1]:9000", "[2001:db8::7]:80"})
      CHECK(endpoint_of(parse_endpoint(text)->socket_address()).authority() == text);
    CHECK(Endpoint{"no address", 1}.socket_address().length == 0);
  }

  TEST_CASE("a stream and datagrams listen at a port that the system chose, and only once") {
    for (const int type : {SOCK_STREAM, SOCK_DGRAM}) {
      Endpoint endpoint;
      const auto socket = open_at(endpoint, type);
      REQUIRE(socket);
      CHECK(endpoint.port != 0);
      Endpoint same = endpoint;
      const auto second = open_at(same, type);
      REQUIRE_FALSE(second);
      CHECK(second.error().code == Errc::failed);
      CHECK(second.error().message.starts_with(endpoint.authority() + " is in use"));
    }
    Endpoint elsewhere{"192.0.2.1", 0}; // an address of documents, see RFC 5737
    const auto refused = open_at(elsewhere, SOCK_STREAM);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("is not of this machine") != std::string::npos);
  }

  TEST_CASE("connections come one by one, and nothing comes if none waits") {
    Endpoint endpoint;
    const auto listener = open_at(endpoint, SOCK_STREAM);
    REQUIRE(listener);
    CHECK_FALSE(accept_from(*listener, 4096));
    const UniqueFd client(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const SocketAddress to = endpoint.socket_address();
    REQUIRE(::connect(client.get(), &to.address.any, to.length) == 0);
    std::optional<UniqueFd> accepted;
    for (int turn = 0; turn < 1000 && !accepted; ++turn) {
      accepted = accept_from(*listener, 4096);
      if (!accepted) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    CHECK(accepted);
    CHECK_FALSE(accept_from(*listener, 4096));
  }
}

} // namespace endpoint_test
