#include "serve/request.hpp"

#include <string>

#include <doctest/doctest.h>

namespace request_test {

using namespace nendo;
using serve::changed;
using serve::Watch;

TEST_SUITE("serve_request") {
  TEST_CASE("each key changes one choice, and a missing one leaves it") {
    const auto after = [](const Watch& watch, const char* request) {
      const auto result = changed(watch, request);
      REQUIRE_MESSAGE(result, result.error().message);
      return *result;
    };
    CHECK(after({}, R"({"class":"WATCH"})") == Watch{});
    CHECK(after({}, R"({"class":"WATCH","samples":true})") == Watch{true, false, 30.0});
    CHECK(after({true, false, 5.0}, R"( {"hands" : true,"class":"WATCH"} )") ==
          Watch{true, true, 5.0});
    CHECK(after({true, true, 5.0}, R"({"class":"WATCH","samples":false,"rate_hz":1000})") ==
          Watch{false, true, 1000.0});
    CHECK(after({}, R"({"class":"WATCH","later":{"x":[1,null]},"rate_hz":0.1})").rate_hz == 0.1);
  }

  TEST_CASE("wrong requests are refused, in a line without their text") {
    for (const std::string& request :
         {std::string(), std::string("x"), std::string("[]"), std::string("{}"),
          std::string("{\"class\":\"watch\"}"), std::string("{\"class\":7}"),
          std::string(R"({"class":"WATCH","samples":1})"),
          std::string(R"({"class":"WATCH","hands":null})"),
          std::string(R"({"class":"WATCH","rate_hz":"30"})"),
          std::string(R"({"class":"WATCH","rate_hz":0})"),
          std::string(R"({"class":"WATCH","rate_hz":-1})"),
          std::string(R"({"class":"WATCH","rate_hz":1000.1})"),
          std::string(R"({"class":"WATCH","rate_hz":1e999})"),
          std::string(R"({"class":"WATCH","samples":true)"), std::string("\x01\x1B[2J\xFF"),
          std::string(4000, '['),
          "{\"class\":\"WATCH\",\"x\":" + std::string(9, '[') + std::string(9, ']') + "}"}) {
      CAPTURE(request);
      const auto result = changed({}, request);
      REQUIRE_FALSE(result);
      CHECK(result.error().code == Errc::bad_input);
      CHECK(result.error().message.find('\x1B') == std::string::npos);
      CHECK(result.error().message.size() < 100);
    }
  }
}

} // namespace request_test
