#include <string>

#include <doctest/doctest.h>

#include "web/http_request.hpp"

namespace http_request_test {

using namespace nendo::web;

namespace {

int status_of(std::string_view bytes) {
  return parse_head(bytes).status;
}

} // namespace

TEST_SUITE("http_request") {
  TEST_CASE("a head is complete when its empty line is there, and not a byte before") {
    const std::string request = "GET /ws?token=ab&x=1 HTTP/1.1\r\nHost: 127.0.0.1:80\r\n"
                                "CONNECTION:keep-alive , Upgrade\r\n\r\n";
    for (std::size_t count = 0; count < request.size(); ++count)
      CHECK(status_of(request.substr(0, count)) == 0);
    const std::string bytes = request + "more";
    const HttpHead head = parse_head(bytes);
    REQUIRE(head.status == 200);
    CHECK(head.bytes == request.size());
    CHECK(head.request.method == "GET");
    CHECK(head.request.path == "/ws");
    CHECK(head.request.parameter("token") == "ab");
    CHECK(head.request.parameter("x") == "1");
    CHECK_FALSE(head.request.parameter("toke"));
    CHECK(head.request.header("host") == "127.0.0.1:80");
    CHECK(head.request.lists("Connection", "upgrade"));
    CHECK(head.request.lists("connection", "KEEP-ALIVE"));
    CHECK_FALSE(head.request.lists("Connection", "keep"));
    CHECK_FALSE(head.request.header("Origin"));
  }

  TEST_CASE("a header that is there twice is none") {
    const HttpHead head = parse_head("GET / HTTP/1.1\r\nHost: a\r\nhost: b\r\n\r\n");
    REQUIRE(head.status == 200);
    CHECK_FALSE(head.request.header("Host"));
    CHECK(head.request.count("Host") == 2);
  }

  TEST_CASE("what is not exactly a request is refused") {
    for (const auto* wrong :
         {"\r\n\r\n", "GET\r\n\r\n", "GET /\r\n\r\n", "GET / HTTP/1.1 \r\n\r\n",
          "GET  / HTTP/1.1\r\n\r\n", "GET http://a/ HTTP/1.1\r\n\r\n", "G\x01T / HTTP/1.1\r\n\r\n",
          "GET / HTTP/1.1\r\nHost\r\n\r\n", "GET / HTTP/1.1\r\nHost : a\r\n\r\n",
          "GET / HTTP/1.1\r\nHost: a\r\n b\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\nb: c\r\n\r\n",
          "GET / HTTP/1.1\r\nHost: a\x7F\r\n\r\n", "GET /\x80 HTTP/1.1\r\n\r\n"}) {
      CAPTURE(wrong);
      CHECK(status_of(wrong) == 400);
    }
    CHECK(status_of("GET / HTTP/1.0\r\n\r\n") == 505);
    CHECK(status_of("GET / HTTP/2\r\n\r\n") == 505);
  }

  TEST_CASE("a body is refused, for its end would be a matter of opinion") {
    CHECK(status_of("GET / HTTP/1.1\r\nContent-Length: 5\r\n\r\n") == 413);
    CHECK(status_of("GET / HTTP/1.1\r\nContent-Length: 0\r\n\r\n") == 200);
    CHECK(status_of("GET / HTTP/1.1\r\nContent-Length: 0\r\nContent-Length: 0\r\n\r\n") == 413);
    CHECK(status_of("GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n") == 413);
  }

  TEST_CASE("a POST has a body of one length, which has a limit") {
    const auto length_of = [](const std::string& lines) {
      const HttpHead head = parse_head("POST /open HTTP/1.1\r\n" + lines + "\r\n");
      return head.status == 200 ? static_cast<int>(head.body_bytes) : -head.status;
    };
    CHECK(length_of("") == 0);
    CHECK(length_of("Content-Length: 5\r\n") == 5);
    CHECK(length_of("Content-Length: 134217728\r\n") == 134217728);
    CHECK(length_of("Content-Length: 134217729\r\n") == -413);
    CHECK(length_of("Content-Length: 99999999999999999999\r\n") == -400);
    CHECK(length_of("Content-Length: 5\r\nContent-Length: 6\r\n") == -400);
    for (const auto* wrong : {"-5", "+5", "0x5", "5,5", "5 5", ""})
      CHECK(length_of("Content-Length: " + std::string(wrong) + "\r\n") == -400);
    CHECK(length_of("Transfer-Encoding: chunked\r\n") == -413);
  }

  TEST_CASE("the name of a file has no path") {
    CHECK(file_name_in("my%20scan.obj") == "my scan.obj");
    CHECK(file_name_in("gr%C3%BCn.ply") == "gr\xC3\xBCn.ply");
    for (const auto* wrong :
         {"", ".obj", "..", "a/b.obj", "a%2fb.obj", "a%00.obj", "a%0A.obj", "a%", "a%2", "a%zz"}) {
      CAPTURE(wrong);
      CHECK_FALSE(file_name_in(wrong));
    }
    CHECK(file_name_in(std::string(100, 'a')));
    CHECK_FALSE(file_name_in(std::string(101, 'a')));
  }

  TEST_CASE("length and number of headers have limits") {
    std::string many = "GET / HTTP/1.1\r\n";
    for (std::size_t n = 0; n < max_headers; ++n)
      many += "a: b\r\n";
    CHECK(status_of(many + "\r\n") == 200);
    CHECK(status_of(many + "a: b\r\n\r\n") == 431);
    const std::string endless(max_head_bytes, 'a');
    CHECK(status_of(endless.substr(1)) == 0);
    CHECK(status_of(endless) == 431);
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

} // namespace http_request_test
