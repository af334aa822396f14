// The text messages of Foxglove's protocol, and what requests of clients lead to.

#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "web/foxglove_feed.hpp"
#include "web/foxglove_words.hpp"
#include "web/web_socket.hpp"

namespace foxglove_words_test {

using namespace nendo;
using namespace nendo::web;
using nlohmann::json;

TEST_SUITE("foxglove_words") {
  TEST_CASE("subscriptions and their ends are read") {
    const auto request = parse_foxglove(
        R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":4294967295,"channelId":2}]})");
    REQUIRE(request);
    CHECK(request->subscribe == std::vector<FoxgloveSubscription>{{0, 1}, {4294967295, 2}});
    CHECK(request->unsubscribe.empty());
    const auto ends = parse_foxglove(R"({"op":"unsubscribe","subscriptionIds":[3,0]})");
    REQUIRE(ends);
    CHECK(ends->unsubscribe == std::vector<std::uint32_t>{3, 0});
    CHECK(ends->subscribe.empty());
  }

  TEST_CASE("other operations ask for nothing") {
    for (const char* text : {R"({"op":"clientInfo","name":"an application"})",
                             R"({"op":"getParameters","parameterNames":[]})",
                             R"({"op":"advertise","channels":[{"id":1}]})"}) {
      const auto request = parse_foxglove(text);
      REQUIRE(request);
      CHECK(request->subscribe.empty());
      CHECK(request->unsubscribe.empty());
    }
  }

  TEST_CASE("a wrong text is refused, in a close frame's length") {
    for (const std::string& text : std::initializer_list<std::string>{
             "", "undo", "[]", "{}", "7", R"({"op":7})", R"({"op":"subscribe"})",
             R"({"op":"subscribe","subscriptions":{}})",
             R"({"op":"subscribe","subscriptions":[7]})",
             R"({"op":"subscribe","subscriptions":[{"id":1}]})",
             R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
             R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})",
             R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
             R"({"op":"unsubscribe","subscriptionIds":["1"]})",
             R"({"op":"subscribe","subscriptions":[]}x)", std::string(1000, '['),
             "{\"op\":\"\xFF\"}"}) {
      CAPTURE(text);
      const auto request = parse_foxglove(text);
      REQUIRE_FALSE(request);
      CHECK(request.error().code == Errc::bad_input);
      CHECK(request.error().message.size() <= max_close_reason);
    }
  }

  TEST_CASE("the server's text messages are those of the protocol") {
    const json info = json::parse(foxglove_server_info("Nendo \xFF", "a-1"));
    CHECK(info["op"] == "serverInfo");
    CHECK(info["sessionId"] == "a-1");
    CHECK(info["capabilities"] == json::array());
    const std::vector<FoxgloveChannel> channels{{3, "/a", "b/msg/C", "string \"d\"\n"}};
    const json advertised = json::parse(foxglove_advertisement(channels));
    CHECK(advertised["op"] == "advertise");
    REQUIRE(advertised["channels"].size() == 1);
    CHECK(advertised["channels"][0] == json{{"id", 3},
                                            {"topic", "/a"},
                                            {"encoding", "cdr"},
                                            {"schemaName", "b/msg/C"},
                                            {"schema", "string \"d\"\n"},
                                            {"schemaEncoding", "ros2msg"}});
    const json warning = json::parse(foxglove_warning("no"));
    CHECK(warning == json{{"op", "status"}, {"level", 1}, {"message", "no"}});
  }

  TEST_CASE("a feed takes possible subscriptions, and warns about each of the others") {
    const FoxgloveMessages messages; // without a model
    FoxgloveFeed feed;
    CHECK(feed.take({{{7, 1}, {8, 2}}, {}}, messages).empty());
    CHECK(feed.has(FoxgloveTopic::joint_states));
    CHECK(feed.has(FoxgloveTopic::tf));
    CHECK_FALSE(feed.has(FoxgloveTopic::tf_static));
    CHECK(feed.take({{{9, 0}, {9, 5}, {9, 4}, {7, 3}}, {}}, messages).size() == 4);
    CHECK_FALSE(feed.has(FoxgloveTopic::tf_static));
    CHECK(feed.take({{}, {7, 7, 99}}, messages).empty());
    CHECK_FALSE(feed.has(FoxgloveTopic::joint_states));
    FoxgloveRequest many;
    for (std::uint32_t id = 100; id < 200; ++id)
      many.subscribe.push_back({id, 3});
    CHECK(feed.take(many, messages).size() == 100 - (FoxgloveFeed::max_subscriptions - 1));
  }

  TEST_CASE("each subscription gets each newest message once") {
    FoxgloveMessages messages;
    FoxgloveFeed feed;
    feed.take({{{7, 1}, {8, 2}, {9, 1}}, {}}, messages);
    CHECK_FALSE(feed.next_due(messages, true));
    ros::HandState hand;
    for (int round = 0; round < 3; ++round) {
      messages.set_hands({&hand, 1}, round);
      std::vector<std::uint32_t> sent;
      while (const auto due = feed.next_due(messages, true))
        sent.push_back(due->subscription);
      CHECK(sent == std::vector<std::uint32_t>{7, 8, 9});
    }
    messages.set_hands({&hand, 1}, 5);
    messages.set_hands({&hand, 1}, 6); // the one before is not sent any more
    FoxgloveFeed late;
    late.take({{{1, 1}}, {}}, messages);
    CHECK_FALSE(late.next_due(messages, true)); // old hands
    CHECK(feed.next_due(messages, true));
    const auto message = messages.message(FoxgloveTopic::joint_states, 0x04030201);
    CHECK(message[0] == std::byte{1});
    CHECK(message[1] == std::byte{1});
    CHECK(message[4] == std::byte{4});
    CHECK(message[5] == std::byte{6}); // the time
  }
}

} // namespace foxglove_words_test
