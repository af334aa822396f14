#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "web/http_request.hpp"

namespace admission_test {

using namespace nendo::web;

namespace {

constexpr const char* token = "00112233445566778899aabbccddeeff";

struct Asked {
  std::string path = "/ws";
  std::string host = "127.0.0.1:8080";
  std::string origin = "http://127.0.0.1:8080";
  std::string token_given = token;
  std::string method = "GET";
  std::string version = "13";
  std::string upgrade = "websocket";
  std::string key = "dGhlIHNhbXBsZSBub25jZQ==";
};

Admission answer(const Asked& asked) {
  std::string bytes = asked.method + " " + asked.path + "?token=" + asked.token_given +
                      " HTTP/1.1\r\nHost: " + asked.host +
                      "\r\nConnection: Upgrade\r\nUpgrade: " + asked.upgrade +
                      "\r\nSec-WebSocket-Version: " + asked.version +
                      "\r\nSec-WebSocket-Key: " + asked.key + "\r\n";
  if (!asked.origin.empty()) bytes += "Origin: " + asked.origin + "\r\n";
  bytes += "\r\n";
  const HttpHead head = parse_head(bytes);
  REQUIRE(head.status == 200);
  Admission admission = admit(head.request, token);
  admission.why = admission.why.empty() ? "" : "said"; // not of `bytes`
  return admission;
}

} // namespace

TEST_SUITE("admission") {
  TEST_CASE("who has the token and comes from this host's page gets in, by any of its addresses") {
    CHECK(answer({}).status == 200);
    CHECK(answer({}).resource == Resource::socket);
    CHECK(answer({.path = "/model"}).resource == Resource::model);
    CHECK(answer({.path = "/picture"}).resource == Resource::picture);
    CHECK(answer({.path = "/skin"}).resource == Resource::skin);
    CHECK(answer({.path = "/open", .method = "POST"}).resource == Resource::file);
    CHECK(answer({.host = "localhost:9", .origin = "http://localhost:9"}).status == 200);
    CHECK(answer({.host = "[::1]:9", .origin = "http://[::1]:9"}).status == 200);
    CHECK(answer({.origin = ""}).status == 200); // no browser says none for a WebSocket
  }

  TEST_CASE("the page needs no token, for there is nothing in it") {
    const Admission page = answer({.path = "/", .token_given = "x"});
    CHECK(page.status == 200);
    CHECK(page.resource == Resource::page);
  }

  TEST_CASE("another page's origin is refused for whatever it asks") {
    for (const auto* path : {"/", "/model", "/picture", "/skin", "/ws"})
      for (const auto* origin :
           {"http://evil.example", "null", "https://127.0.0.1:8080", "http://127.0.0.1:8081",
            "http://127.0.0.1", "http://127.0.0.1:8080.evil.example", "http://localhost:8080"}) {
        CAPTURE(origin);
        CHECK(answer({.path = path, .origin = origin}).status == 403);
      }
  }

  TEST_CASE("a name for this host is refused, even where the origin agrees: DNS rebinding") {
    for (const auto* path : {"/", "/model", "/picture", "/skin", "/ws"})
      CHECK(
          answer({.path = path, .host = "evil.example:8080", .origin = "http://evil.example:8080"})
              .status == 403);
  }

  TEST_CASE("without the token, a client gets neither model nor socket") {
    for (const auto* path : {"/model", "/picture", "/skin", "/ws"})
      for (const auto& given : {std::string(), std::string("x"), std::string(token) + "0",
                                std::string(token).substr(1), std::string(32, '0')})
        CHECK(answer({.path = path, .token_given = given}).status == 403);
  }

  TEST_CASE("a refusal has its own number and says why") {
    CHECK(answer({.method = "POST"}).status == 405);
    CHECK(answer({.path = "/open"}).status == 405);
    CHECK(answer({.path = "/open", .token_given = "x", .method = "POST"}).status == 403);
    CHECK(answer({.path = "/open", .origin = "http://evil.example", .method = "POST"}).status ==
          403);
    CHECK(answer({.path = "/etc/passwd"}).status == 404);
    CHECK(answer({.path = "/../ws"}).status == 404);
    CHECK(answer({.path = "/picture/0"}).status == 404);
    CHECK(answer({.path = "/pictures"}).status == 404);
    CHECK(answer({.version = "8"}).status == 426);
    CHECK(answer({.upgrade = "h2c"}).status == 426);
    CHECK(answer({.key = "short"}).status == 400);
    CHECK(answer({.key = "short"}).why == "said");
    const HttpHead head = parse_head("GET / HTTP/1.1\r\n\r\n");
    CHECK(admit(head.request, token).status == 400); // no Host
  }

  TEST_CASE("secrets are the same or not") {
    CHECK(equal_in_constant_time("", ""));
    CHECK(equal_in_constant_time("ab", "ab"));
    CHECK_FALSE(equal_in_constant_time("ab", "aB"));
    CHECK_FALSE(equal_in_constant_time("ab", "abc"));
    CHECK_FALSE(equal_in_constant_time("b", "a"));
  }
}

} // namespace admission_test
