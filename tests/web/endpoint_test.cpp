#include <doctest/doctest.h>

#include "web/endpoint.hpp"

namespace endpoint_test {

using namespace nendo;
using namespace nendo::web;

TEST_SUITE("endpoint") {
  TEST_CASE("a port alone is this machine's own, an address must be in figures") {
    const auto alone = parse_endpoint("8080");
    REQUIRE(alone);
    CHECK(alone->authority() == "127.0.0.1:8080");
    CHECK(parse_endpoint("0")->port == 0);
    CHECK(parse_endpoint("0.0.0.0:80")->authority() == "0.0.0.0:80");
    CHECK(parse_endpoint("[::1]:65535")->authority() == "[::1]:65535");
    CHECK(parse_endpoint("[fe80::1]:1")->is_ipv6());
  }

  TEST_CASE("what is no endpoint is wrong usage, and the error says what would be one") {
    for (const std::string_view wrong :
         {"", ":", ":80", "65536", "-1", "8080 ", "localhost:80", "box.local:80", "1.2.3:80",
          "127.0.0.1", "127.0.0.1:", "::1:80", "[::1]", "[::1]80", "[127.0.0.1]:80", "[::1:80",
          "127.0.0.1:80:80", "0x50", "256.0.0.1:80"}) {
      CAPTURE(wrong);
      const auto parsed = parse_endpoint(wrong);
      REQUIRE_FALSE(parsed);
      CHECK(parsed.error().code == Errc::usage);
      CHECK(parsed.error().message.find("ADDR:PORT") != std::string::npos);
      CHECK(parsed.error().message.find('\n') == std::string::npos);
    }
    CHECK_FALSE(parse_endpoint(std::string_view("127.0.0.1\0.evil.example:80", 26)));
  }

  TEST_CASE("a host is an address or localhost, and no name of anybody's") {
    for (const auto* fine : {"localhost", "localhost:1", "127.0.0.1:8080", "192.168.1.5", "[::1]",
                             "[::1]:9", "[fe80::1:2]:80"})
      CHECK(is_address_or_localhost(fine));
    for (const auto* wrong : {"", "evil.example", "evil.example:8080", "localhost.evil.example",
                              "127.0.0.1.evil.example", "[evil.example]", "::1", "localhost:",
                              "localhost:99999", "[::1]x", "[localhost]", "2130706433", "127.1"}) {
      CAPTURE(wrong);
      CHECK_FALSE(is_address_or_localhost(wrong));
    }
  }
}

} // namespace endpoint_test
