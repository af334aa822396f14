// Which network DDS uses, by the environment.

#include <string>

#include <doctest/doctest.h>

#include "ros2/dds_network.hpp"
#include "support/required.hpp"

namespace dds_network_test {

using namespace nendo;

namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

ros2::Environment with(std::string ros2::Environment::* variable, const std::string& value) {
  ros2::Environment environment;
  environment.*variable = value;
  return environment;
}

} // namespace

TEST_SUITE("dds_network") {
  TEST_CASE("without variables, DDS stays on this machine, in domain 0") {
    for (const bool has_multicast : {false, true}) {
      const auto network = test::required(ros2::network_of({}, has_multicast));
      CHECK(network.domain_id == 0);
      CHECK(network.is_this_machine_only);
      CHECK(has(network.config, "<Peer address=\"127.0.0.1\"/>"));
      CHECK(has(network.config, "<MulticastTimeToLive>0<") == has_multicast);
      CHECK(has(network.config, "<NetworkInterface address=\"127.0.0.1\"/>") == !has_multicast);
    }
  }

  TEST_CASE("domains are those of ROS") {
    const auto domain = &ros2::Environment::domain_id;
    for (const int id : {0, 1, 42, 101, 232})
      CHECK(test::required(ros2::network_of(with(domain, std::to_string(id)), true)).domain_id ==
            static_cast<std::uint32_t>(id));
    for (const std::string wrong : {"233", "-1", "+1", " 1", "1 ", "1.0", "0x1", "1e1",
                                    "18446744073709551616", "nan", "</Id>", "\x1b[2J"}) {
      CAPTURE(wrong);
      const auto network = ros2::network_of(with(domain, wrong), true);
      REQUIRE_FALSE(network);
      CHECK(network.error().code == Errc::usage);
      CHECK(has(network.error().message, "ROS_DOMAIN_ID"));
      CHECK(has(network.error().message, "0 to 232"));
      CHECK_FALSE(has(network.error().message, "\x1b"));
    }
  }

  TEST_CASE("only SUBNET, SYSTEM_DEFAULT and peers let DDS leave this machine") {
    const auto range = &ros2::Environment::discovery_range;
    CHECK(test::required(ros2::network_of(with(range, "LOCALHOST"), true)).is_this_machine_only);
    for (const std::string value : {"SUBNET", "SYSTEM_DEFAULT"}) {
      const auto network = test::required(ros2::network_of(with(range, value), true));
      CHECK_FALSE(network.is_this_machine_only);
      CHECK_FALSE(has(network.config, "AllowMulticast"));
      CHECK_FALSE(has(network.config, "<Peer "));
    }
    for (const std::string wrong : {"OFF", "subnet", "ALL", "1"}) {
      const auto network = ros2::network_of(with(range, wrong), true);
      REQUIRE_FALSE(network);
      CHECK(network.error().code == Errc::usage);
      CHECK(has(network.error().message, "ROS_AUTOMATIC_DISCOVERY_RANGE"));
    }
    const auto peers = test::required(ros2::network_of(
        with(&ros2::Environment::static_peers, "robot.local;192.0.2.7;;fe80::1"), true));
    CHECK_FALSE(peers.is_this_machine_only);
    CHECK(has(peers.config, "<AllowMulticast>false<"));
    for (const std::string peer : {"robot.local", "192.0.2.7", "fe80::1", "127.0.0.1"})
      CHECK(has(peers.config, "<Peer address=\"" + peer + "\"/>"));
  }

  TEST_CASE("ROS_LOCALHOST_ONLY prevails, as in ROS") {
    ros2::Environment environment;
    environment.localhost_only = "1";
    environment.discovery_range = "SUBNET";
    environment.static_peers = "192.0.2.7";
    const auto network = test::required(ros2::network_of(environment, true));
    CHECK(network.is_this_machine_only);
    CHECK(has(network.config, "<NetworkInterface address=\"127.0.0.1\"/>"));
    CHECK_FALSE(has(network.config, "192.0.2.7"));
    environment.localhost_only = "0";
    CHECK_FALSE(test::required(ros2::network_of(environment, true)).is_this_machine_only);
    environment.localhost_only = "yes";
    REQUIRE_FALSE(ros2::network_of(environment, true));
  }

  TEST_CASE("peers cannot change the configuration, nor be without number") {
    const auto peers = &ros2::Environment::static_peers;
    std::string many = "a";
    for (int at = 0; at < 40; ++at)
      many += ";a";
    for (const std::string& wrong :
         {std::string("\"/><Transport>tcp</Transport>"), std::string("a b"), std::string("a,b"),
          std::string("${HOME}"), std::string(300, 'a'), many}) {
      CAPTURE(wrong);
      const auto network = ros2::network_of(with(peers, wrong), true);
      REQUIRE_FALSE(network);
      CHECK(network.error().code == Errc::usage);
      CHECK(has(network.error().message, "ROS_STATIC_PEERS"));
    }
  }

  TEST_CASE("CYCLONEDDS_URI prevails, but not about leaving this machine") {
    const std::string uri = "<CycloneDDS/>";
    const auto network =
        test::required(ros2::network_of(with(&ros2::Environment::cyclonedds_uri, uri), true));
    CHECK(network.config.ends_with("," + uri));
    CHECK(network.is_this_machine_only);
  }
}

} // namespace dds_network_test
