#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "publish/target.hpp"

namespace target_test {

using namespace nendo;
using namespace nendo::publish;

TEST_SUITE("target") {
  TEST_CASE("segments have names, and may have a group") {
    for (const auto& [text, name] : {std::pair{"shm", "run"}, {"shm:left_1-a.b", "left_1-a.b"}}) {
      const auto target = parse_target(text);
      REQUIRE(target);
      const auto& segment = std::get<SegmentTarget>(*target);
      CHECK(segment.name == name);
      CHECK_FALSE(segment.group);
    }
    const auto of_root = parse_target("shm:x?group=root");
    REQUIRE(of_root);
    CHECK(std::get<SegmentTarget>(*of_root).group == 0U);
    const auto by_number = parse_target("shm?group=1234");
    REQUIRE(by_number);
    CHECK(std::get<SegmentTarget>(*by_number).group == 1234U);
  }

  TEST_CASE("OSC goes to this machine, or to an address that is named") {
    for (const auto& [text, expected] : {std::pair{"osc:9000", "127.0.0.1:9000"},
                                         {"vmc:192.0.2.7:65535", "192.0.2.7:65535"},
                                         {"osc:[::1]:1?rate=30", "[::1]:1"},
                                         {"osc:[2001:db8::7]:9000", "[2001:db8::7]:9000"}}) {
      const auto target = parse_target(text);
      REQUIRE(target);
      CHECK(std::get<OscTarget>(*target).endpoint.authority() == expected);
      const bool is_vmc = std::string(text).starts_with("vmc");
      CHECK((std::get<OscTarget>(*target).format == OscFormat::vmc) == is_vmc);
    }
    CHECK(std::get<OscTarget>(*parse_target("vmc:1?rate=30")).rate_hz == 30.0);
    CHECK_FALSE(std::get<OscTarget>(*parse_target("vmc:1")).rate_hz);
  }

  TEST_CASE("a VRPN server listens at VRPN's port of this machine, or where the target says") {
    for (const auto& [text, expected] : {std::pair{"vrpn", "127.0.0.1:3883"},
                                         {"vrpn?rate=30", "127.0.0.1:3883"},
                                         {"vrpn:4000", "127.0.0.1:4000"},
                                         {"vrpn:0.0.0.0:3883?rate=30", "0.0.0.0:3883"}}) {
      const auto target = parse_target(text);
      REQUIRE(target);
      const auto& vrpn = std::get<VrpnTarget>(*target);
      CHECK(vrpn.endpoint.authority() == expected);
      CHECK(vrpn.rate_hz.has_value() == (std::string(text).find("rate") != std::string::npos));
    }
  }

  TEST_CASE("places are the same however they are written, with any other readers") {
    const std::vector<std::vector<std::string>> places{
        {"shm", "shm:run", "shm:run?group=0"},
        {"shm:Run"},
        {"osc:9000", "osc:127.0.0.1:9000", "vmc:9000?rate=5"},
        {"osc:9001"},
        {"osc:127.0.0.2:9000"},
        {"osc:[::1]:9000", "osc:[0:0::1]:9000"},
        {"osc:[::2]:9000"},
        {"vrpn", "vrpn:3883", "vrpn:127.0.0.1:3883?rate=9"},
        {"vrpn:9000"}};
    for (std::size_t one = 0; one < places.size(); ++one)
      for (std::size_t other = 0; other < places.size(); ++other)
        for (const auto& first : places[one])
          for (const auto& second : places[other]) {
            CAPTURE(first);
            CAPTURE(second);
            CHECK(is_same_place(*parse_target(first), *parse_target(second)) == (one == other));
          }
  }

  TEST_CASE("anything else is wrong usage, in one line that names it") {
    for (const std::string text : {"",
                                   "shm:",
                                   "shm:?group=root",
                                   "shm:../x",
                                   "shm:a/b",
                                   "shm:a b",
                                   "shmem",
                                   "shm:x?user=a",
                                   "shm:x?group=",
                                   "shm:x?group=no-such-group",
                                   "udp:9000",
                                   "osc",
                                   "osc:",
                                   "osc:9000?rate=0",
                                   "osc:9000?rate=nan",
                                   "osc:9000?rate=30&rate=40",
                                   "vmc:9000?group=a",
                                   "osc:0",
                                   "osc:65536",
                                   "osc:-1",
                                   "osc:9000x",
                                   "osc:localhost:9000",
                                   "osc:1.2.3:x",
                                   "osc:::1:9000",
                                   "osc:[::1]",
                                   "osc:[]:9000",
                                   "osc:[127.0.0.1]:9000",
                                   "osc:256.0.0.1:9000",
                                   "vrpn:",
                                   "vrpn:0",
                                   "vrpn:?rate=30",
                                   "vrpn?rate=0",
                                   "vrpn:localhost:3883",
                                   "vrpns",
                                   "tcp:9000"}) {
      CAPTURE(text);
      const auto target = parse_target(text);
      REQUIRE_FALSE(target);
      CHECK(target.error().code == Errc::usage);
      CHECK(target.error().message.starts_with(text + ": "));
      CHECK(target.error().message.find('\n') == std::string::npos);
    }
    CHECK_FALSE(parse_target("shm:" + std::string(65, 'x')));
    CHECK_FALSE(parse_target("osc:" + std::string(5000, '9')));
  }
}

} // namespace target_test
