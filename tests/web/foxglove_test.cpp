// Applications that use Foxglove's protocol, at a server: what they get is what the loop's frames
// have.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <ranges>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/hand/angle_sources.hpp>

#include "served.hpp"
#include "support/ros2msg.hpp"

namespace foxglove_test {

using namespace nendo;
using namespace nendo::web;
using nendo::test::client_frame;
using nendo::test::eventually;
using nendo::test::open_server;
using nendo::test::Served;
using nendo::test::StreamedLoop;
using nendo::test::WebClient;
using nlohmann::json;
using Leaf = test::Ros2Schema::Leaf;

namespace {

/// An application, connected, that decodes messages by the schemas that the server announced.
struct Application {
  WebClient client;
  std::map<std::string, json> channels; ///< index: topic
  json info;

  explicit Application(const Server& server, int receive_bytes = 0)
      : client(server, receive_bytes) {
    REQUIRE(client.open_foxglove() == 101);
    info = text();
    REQUIRE(info["op"] == "serverInfo");
    const json advertised = text();
    REQUIRE(advertised["op"] == "advertise");
    for (const json& channel : advertised["channels"])
      channels[channel["topic"]] = channel;
  }
  json text() {
    for (;;) {
      const auto frame = client.next();
      REQUIRE(frame);
      if (frame->opcode != 1) continue;
      return json::parse(
          std::string(reinterpret_cast<const char*>(frame->payload.data()), frame->payload.size()));
    }
  }
  /// The subscription gets the number of the channel and 1000.
  void subscribe(const std::string& topic) {
    const int id = channels.at(topic)["id"];
    client.send_text(
        json{{"op", "subscribe"}, {"subscriptions", {{{"id", 1000 + id}, {"channelId", id}}}}}
            .dump());
  }
  struct Message {
    std::string topic;
    std::uint64_t time_ns = 0;
    std::vector<Leaf> leaves;
  };
  std::optional<Message> next(int wait_ms = WebClient::patience_ms) {
    for (;;) {
      const auto frame = client.next(wait_ms);
      if (!frame || frame->opcode == 8) return std::nullopt;
      if (frame->opcode != 2) continue;
      REQUIRE(frame->payload.size() > 13);
      REQUIRE(frame->payload[0] == std::byte{1});
      std::uint32_t subscription = 0;
      Message message;
      std::memcpy(&subscription, &frame->payload[1], 4);
      std::memcpy(&message.time_ns, &frame->payload[5], 8);
      for (const auto& [topic, channel] : channels) {
        if (channel["id"].get<std::uint32_t>() + 1000 != subscription) continue;
        message.topic = topic;
        message.leaves =
            test::Ros2Schema(channel["schemaName"], channel["schema"].get<std::string>())
                .decode(std::span(frame->payload).subspan(13));
      }
      REQUIRE_FALSE(message.topic.empty());
      return message;
    }
  }
};

/// A server with a loop that the test ticks.
struct Ticked {
  StreamedLoop streamed{flow::Mode::type1};
  std::unique_ptr<Server> server = open_server();

  Ticked() {
    server->present(streamed.stream, streamed.model);
    REQUIRE(eventually([&] {
      return WebClient(*server).get(WebClient(*server).with_token("/model")).status == 200;
    }));
  }
  /// Ticks until the application gets such a message. Others may be of earlier ticks.
  template <class IsIt>
  bool gets(Application& application, int bent, const IsIt& is_it) {
    for (int attempt = 0; attempt < 1000; ++attempt) {
      streamed.tick(bent);
      while (const auto message = application.next(20))
        if (is_it(*message)) return true;
    }
    return false;
  }
  const flow::Frame& frame() { return streamed.test.loop->frames().front(); }
};

std::vector<double> numbers_at(const std::vector<Leaf>& leaves, const std::string& path) {
  std::vector<double> numbers;
  for (const Leaf& leaf : leaves)
    if (leaf.path.starts_with(path)) numbers.push_back(leaf.number);
  return numbers;
}

std::map<std::string, double> joints_of(const std::vector<Leaf>& leaves) {
  const auto angles = numbers_at(leaves, "position[");
  std::map<std::string, double> joints;
  std::size_t at = 0;
  for (const Leaf& leaf : leaves)
    if (leaf.path.starts_with("name[")) joints[leaf.text] = angles.at(at++);
  return joints;
}

std::map<std::string, double> measured_in(const flow::Frame& frame) {
  std::map<std::string, double> joints;
  for (const Side side : {Side::left, Side::right}) {
    const auto& hand = frame.hands[flow::Placement::index_of(side)];
    const auto sources = hand::angle_sources(hand.sensors, hand.left_out);
    for (std::size_t at = 0; at < hand::angle_count; ++at)
      if (sources[at] == hand::AngleSource::measured)
        joints[std::string(name_of(side)) + "_" + std::string(hand::angle_names[at])] =
            hand.angles[hand::angle_at(at)];
  }
  REQUIRE(joints.size() > 30);
  return joints;
}

/// The positions of the forearms' frames, by their names.
std::map<std::string, Eigen::Vector3d> forearms_of(const std::vector<Leaf>& leaves) {
  std::map<std::string, Eigen::Vector3d> places;
  for (std::size_t at = 3; at + 3 < leaves.size(); at += 11) // leaves of a transform
    if (leaves[at].text.ends_with("_forearm"))
      places[leaves[at].text] =
          Eigen::Vector3d(leaves[at + 1].number, leaves[at + 2].number, leaves[at + 3].number);
  return places;
}

/// The greatest distance between these points, in the axes of ROS, and the vertices of the newest
/// frame; infinite if there are not as many.
double farthest_m(const std::vector<double>& numbers, Ticked& ticked) {
  const auto& order = ticked.streamed.test.loop->changes().layout().order();
  const deform::Points vertices = ticked.streamed.test.vertices_of(ticked.frame());
  if (numbers.size() != 3 * order.size()) return std::numeric_limits<double>::infinity();
  double worst_m = 0.0;
  for (std::size_t at = 0; at < order.size(); ++at) {
    const Eigen::Vector3d own_m =
        vertices.col(order[at]) / ticked.streamed.test.placement.units_per_metre;
    const Eigen::Vector3d found_m(numbers[3 * at], numbers[3 * at + 1], numbers[3 * at + 2]);
    worst_m =
        std::max(worst_m, (found_m - Eigen::Vector3d(-own_m.z(), -own_m.x(), own_m.y())).norm());
  }
  return worst_m;
}

} // namespace

TEST_SUITE("foxglove") {
  TEST_CASE("both subprotocols are accepted, the newer one first, and none is not") {
    const Ticked ticked;
    const auto opened = [&](const std::string& protocols, const std::string& headers = {}) {
      WebClient client(*ticked.server);
      const int status = client.open_foxglove(protocols, headers);
      return std::to_string(status) + " " + client.protocol;
    };
    CHECK(opened("foxglove.sdk.v1") == "101 foxglove.sdk.v1");
    CHECK(opened("foxglove.websocket.v1") == "101 foxglove.websocket.v1");
    CHECK(opened("foxglove.websocket.v1, foxglove.sdk.v1") == "101 foxglove.sdk.v1");
    CHECK(opened("x, foxglove.websocket.v1") == "101 foxglove.websocket.v1");
    CHECK(opened("foxglove.sdk.v2") == "400 ");
    CHECK(WebClient(*ticked.server).open_socket_at("/foxglove", "") == 400);
    CHECK(WebClient(*ticked.server).get("/foxglove").status == 403);
    CHECK(
        WebClient(*ticked.server).get("/foxglove?token=00000000000000000000000000000000").status ==
        403);
    const std::string other_page = "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"
                                   "Origin: https://app.foxglove.dev\r\n";
    CHECK(WebClient(*ticked.server).open_socket_at("/ws", other_page) == 403); // takes commands
    WebClient page(*ticked.server);
    CHECK(page.get(page.with_token("/foxglove")).status == 426);
    WebClient named(*ticked.server);
    CHECK(named.get(named.with_token("/foxglove"), {}, "evil.example:80").status == 403);
    CHECK(ticked.server->foxglove_url() == "ws://" + ticked.server->endpoint().authority() +
                                               "/foxglove?token=" + ticked.server->token());
  }

  TEST_CASE("angles, transforms and the model are those of the loop's frames") {
    Ticked ticked;
    Application application(*ticked.server);
    CHECK(application.channels.size() == 4);
    for (const char* topic : {"/joint_states", "/tf", "/tf_static", "/nendo/model"})
      application.subscribe(topic);
    const auto fixed = application.next();
    REQUIRE(fixed);
    CHECK(fixed->topic == "/tf_static");
    for (const int bent : {0, 10, 25}) {
      CHECK(ticked.gets(application, bent, [&](const auto& message) {
        return message.topic == "/joint_states" &&
               joints_of(message.leaves) == measured_in(ticked.frame()) &&
               message.leaves[0].number == static_cast<double>(message.time_ns / 1'000'000'000);
      }));
      CHECK(ticked.gets(application, bent, [&](const auto& message) {
        if (message.topic != "/tf") return false;
        const auto places = forearms_of(message.leaves);
        return places.size() == 2 &&
               std::ranges::all_of(std::array{Side::left, Side::right}, [&](Side side) {
                 const auto& hand = ticked.frame().hands[flow::Placement::index_of(side)];
                 const Eigen::Vector3d own_m = hand.T_stage_wrist.translation();
                 return places.at(std::string(name_of(side)) + "_forearm") ==
                        Eigen::Vector3d(-own_m.z(), -own_m.x(), own_m.y());
               });
      }));
    }
  }

  TEST_CASE("the model has the vertices of a frame, on the stage in the axes of ROS") {
    Ticked ticked;
    Application application(*ticked.server);
    application.subscribe("/nendo/model");
    std::vector<double> numbers, corners;
    CHECK(ticked.gets(application, 12, [&](const auto& message) {
      numbers = numbers_at(message.leaves, "entities[0].triangles[0].points[");
      corners = numbers_at(message.leaves, "entities[0].triangles[0].indices[");
      return farthest_m(numbers, ticked) < 1e-6;
    }));
    std::uint32_t triangles = 0;
    std::memcpy(&triangles, &ticked.streamed.model[16], sizeof triangles);
    REQUIRE(corners.size() == 3 * std::size_t{triangles});
    double volume_m3 = 0.0; // positive if all triangles are seen from outside
    const auto point = [&](std::size_t corner) {
      return Eigen::Map<const Eigen::Vector3d>(
          &numbers[3 * static_cast<std::size_t>(corners[corner])]);
    };
    for (std::size_t at = 0; at < corners.size(); at += 3)
      volume_m3 += point(at).dot(point(at + 1).cross(point(at + 2))) / 6.0;
    const double diagonal_m = deform::diagonal_of(ticked.streamed.test.model.vertices) /
                              ticked.streamed.test.placement.units_per_metre;
    CHECK(volume_m3 > 0.1 * std::pow(diagonal_m, 3) / 6.0);
  }

  TEST_CASE("an application that asks for nothing gets nothing, and one that ends a subscription") {
    Ticked ticked;
    Application application(*ticked.server);
    for (int bent = 0; bent < 10; ++bent)
      ticked.streamed.tick(bent);
    CHECK_FALSE(application.next(100));
    application.subscribe("/tf");
    CHECK(ticked.gets(application, 3, [](const auto& message) { return message.topic == "/tf"; }));
    application.client.send_text(R"({"op":"unsubscribe","subscriptionIds":[1002]})");
    application.client.send_text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":77}]})");
    CHECK(application.text()["op"] == "status"); // the server has read both
    for (int bent = 0; bent < 10; ++bent)
      ticked.streamed.tick(bent);
    CHECK_FALSE(application.next(100));
  }

  TEST_CASE("hostile messages end the connection, and reach no run") {
    Ticked ticked;
    const auto code_after = [&](const std::string& frame) {
      Application application(*ticked.server);
      application.client.send(frame);
      return application.client.close_code();
    };
    CHECK(code_after(client_frame(0x81, "undo")) == 1008);
    CHECK(code_after(client_frame(0x81, R"({"op":"subscribe"})")) == 1008);
    CHECK(code_after(client_frame(0x81, std::string(1025, ' '))) == 1009);
    CHECK(code_after(client_frame(0x82, "\x01\x02")) == 1003);
    CHECK(code_after(client_frame(0x81, "{}", false)) == 1002);
    CHECK_FALSE(ticked.server->next_command());
    Application flood(*ticked.server);
    std::string many;
    for (int at = 0; at < 600; ++at)
      many += client_frame(0x81, R"({"op":"clientInfo"})");
    flood.client.send(many);
    CHECK(flood.client.close_code() == 1008);
  }

  TEST_CASE("an application that does not read misses messages, and is closed in the end") {
    ServerLimits limits;
    limits.send_buffer_bytes = 4096;
    limits.max_queued_bytes = 65536;
    limits.stall_timeout = std::chrono::milliseconds(300);
    Served served(flow::Mode::type1, limits);
    Application stalled(*served.server, 4096);
    Application other(*served.server);
    for (Application* const one : {&stalled, &other}) {
      one->subscribe("/tf");
      one->subscribe("/nendo/model");
    }
    served.begin();
    std::uint64_t before_ns = 0;
    int received = 0;
    CHECK(eventually([&] {
      if (const auto message = other.next(100); message && message->topic == "/tf") {
        CHECK(message->time_ns > before_ns);
        before_ns = message->time_ns;
        ++received;
      }
      return served.server->counters().dropped == 1;
    }));
    CHECK(received > 5);
    CHECK(served.server->counters().clients == 1);
    served.end();
    CHECK(served.counts.allocations == 0);
  }

  TEST_CASE("another loop ends the connection, and the next one is another session") {
    Ticked ticked;
    Application first(*ticked.server);
    StreamedLoop next(flow::Mode::type1);
    ticked.server->present(next.stream, next.model);
    CHECK(first.client.close_code() == 1012);
    const Application second(*ticked.server);
    CHECK(first.info["sessionId"] != second.info["sessionId"]);
  }
}

} // namespace foxglove_test
