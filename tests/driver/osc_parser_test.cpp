#include "osc/osc_parser.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"
#include "support/parser_laws.hpp"

namespace osc_parser_test {

using namespace std::chrono_literals;
using namespace nendo::driver::osc;
using nendo::HostTime;
using nendo::driver::BadRecord;
using nendo::driver::FindingSink;
using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;

namespace {

Bytes number_bytes(std::uint64_t number, unsigned count) {
  Bytes bytes;
  for (unsigned at = count; at-- > 0;)
    bytes.push_back(static_cast<std::byte>(at < sizeof number ? number >> (8 * at) : 0));
  return bytes;
}

Bytes padded(std::string_view text) {
  Bytes bytes = bytes_of(text);
  do {
    bytes.push_back(std::byte{0});
  } while (bytes.size() % 4 != 0);
  return bytes;
}

Bytes message(std::string_view address, const std::vector<double>& numbers, char type = 'f') {
  Bytes bytes = joined({padded(address), padded("," + std::string(numbers.size(), type))});
  for (const double number : numbers)
    bytes = joined(
        {bytes, type == 'd'
                    ? number_bytes(std::bit_cast<std::uint64_t>(number), 8)
                    : number_bytes(std::bit_cast<std::uint32_t>(static_cast<float>(number)), 4)});
  return bytes;
}

Bytes bundle(std::uint64_t tag, std::initializer_list<Bytes> elements) {
  Bytes bytes = joined({padded("#bundle"), number_bytes(tag, 8)});
  for (const Bytes& element : elements)
    bytes = joined({bytes, number_bytes(element.size(), 4), element});
  return bytes;
}

Bytes left(double x) {
  return message("/nendo/wrist/left", {x, 1, -2, 0, 0.6, 0, 0.8});
}
Bytes position(double x) {
  return message("/phone/position", {x, 0, 0});
}
Bytes rotation() {
  return message("/phone/rotation", {0, 0, 0, 1});
}
PairAddresses phone() {
  return {"/phone/position", "/phone/rotation", right_station};
}

/// A parser, and what it found.
struct Inlet {
  Parser parser;
  std::vector<Pose> poses;
  std::vector<std::string> unknown;
  std::size_t bad = 0;
  std::size_t input = 0;

  explicit Inlet(PairAddresses pair = {}) : parser(std::move(pair)) {}

  void push(const Bytes& packet, std::chrono::microseconds at = 1s) {
    parser.push(packet, HostTime(at),
                FindingSink{[this](const Pose& pose) { poses.push_back(pose); },
                            [this](const UnknownAddress& a) { unknown.emplace_back(a.address); },
                            [this](BadRecord) { ++bad; }});
    input += packet.size();
    nendo::test::check_accounted(parser, input, longest_record);
    CHECK(parser.counters().records == poses.size());
    CHECK(parser.counters().bad_records == bad);
  }
};

} // namespace

TEST_SUITE("osc_parser") {
  TEST_CASE("OSC packets that were put together by hand read as their author meant them") {
    nendo::test::reports_read_as_meant("osc_packets.txt", 8, [](const Bytes& bytes) {
      Inlet inlet(phone());
      inlet.push(bytes);
      if (inlet.poses.empty()) return std::string(inlet.bad > 0 ? "bad" : "none");
      std::string text;
      for (const Pose& pose : inlet.poses) {
        std::array<char, 160> line{};
        const auto& [x, y, z] = pose.position_m;
        const auto& q = pose.turn_xyzw;
        std::snprintf(line.data(), line.size(), "%s%d: %g %g %g, %g %g %g %g%s",
                      text.empty() ? "" : "; ", int{pose.station}, x, y, z, q[0], q[1], q[2], q[3],
                      pose.time ? (" at " + std::to_string(pose.time->count())).c_str() : "");
        text += line.data();
      }
      return text;
    });
  }

  TEST_CASE("a pose has seven numbers of any of three types") {
    for (const char type : {'f', 'd'}) {
      Inlet inlet;
      inlet.push(message("/nendo/wrist/right", {0.25, 1, -2, 0.5, -0.5, 0.5, -0.5}, type));
      REQUIRE(inlet.poses.size() == 1);
      CHECK(inlet.poses[0].station == right_station);
      CHECK(inlet.poses[0].position_m == std::array{0.25, 1.0, -2.0});
      CHECK(inlet.poses[0].turn_xyzw == std::array{0.5, -0.5, 0.5, -0.5});
      CHECK_FALSE(inlet.poses[0].time);
    }
    Inlet inlet; // as scripts send whole numbers
    inlet.push(
        joined({padded("/nendo/wrist/left"), padded(",ififfff"), number_bytes(1, 4),
                number_bytes(std::bit_cast<std::uint32_t>(0.5F), 4), number_bytes(0xFFFF'FFFF, 4),
                number_bytes(0, 12), number_bytes(std::bit_cast<std::uint32_t>(1.0F), 4)}));
    REQUIRE(inlet.poses.size() == 1);
    CHECK(inlet.poses[0].position_m == std::array{1.0, 0.5, -1.0});
  }

  TEST_CASE("a message with other arguments, or with numbers that are no pose, is bad") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinite = std::numeric_limits<double>::infinity();
    const std::string_view address = "/nendo/wrist/left";
    for (const auto& numbers :
         std::initializer_list<std::vector<double>>{{},
                                                    {1, 2, 3, 0, 0, 0},
                                                    {1, 2, 3, 0, 0, 0, 1, 0},
                                                    {nan, 2, 3, 0, 0, 0, 1},
                                                    {1, infinite, 3, 0, 0, 0, 1},
                                                    {1, 2, -infinite, 0, 0, 0, 1},
                                                    {0, 0, 10.001, 0, 0, 0, 1},
                                                    {6, 6, 6, 0, 0, 0, 1},
                                                    {1, 2, 3, 0, 0, 0, 0},
                                                    {1, 2, 3, 0, 0, 0, 1.003},
                                                    {1, 2, 3, 0, 0, 0, 0.997},
                                                    {1, 2, 3, nan, 0, 0, 1},
                                                    {1, 2, 3, infinite, 0, 0, 0}}) {
      for (const char type : {'f', 'd'}) {
        Inlet inlet;
        inlet.push(message(address, numbers, type));
        CHECK(inlet.poses.empty());
        CHECK(inlet.bad == 1);
      }
    }
    Inlet inlet;
    inlet.push(joined({padded(address), padded(",sffffff"), Bytes(28)}));
    inlet.push(joined({padded(address), padded(",fffffff"), Bytes(24)}));
    inlet.push(joined({left(1), Bytes(4)}));
    CHECK(inlet.bad == 3);
    inlet.push(message(address, {0, 0, 9.999, 0, 0, 0, -0.999}));
    CHECK(inlet.poses.size() == 1);
  }

  TEST_CASE("what violates the format is bad as a whole, and gives no pose") {
    const Bytes good = bundle(1, {left(1), left(2)});
    for (std::size_t length = 1; length < good.size(); ++length) {
      CAPTURE(length);
      const std::size_t whole = 16 + 4 + left(1).size();
      Inlet inlet;
      inlet.push({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)});
      // A bundle may end after any of its elements, and have none.
      CHECK(inlet.poses.size() == (length == whole ? 1 : 0));
      CHECK(inlet.bad == (length == whole || length == 16 ? 0 : 1));
    }
    for (const std::uint64_t size : {3U, 4U, 0x7FFF'FFFFU, 0xFFFF'FFFCU, 0x8000'0000U}) {
      Bytes packet = good;
      const Bytes wrong = number_bytes(size, 4);
      std::copy(wrong.begin(), wrong.end(), packet.begin() + 16);
      Inlet inlet;
      inlet.push(packet);
      CHECK(inlet.poses.empty());
      CHECK(inlet.bad == 1);
    }
    Inlet inlet;
    for (const char* text : {"x", "nendo", "/nendo/wrist/left", ",fffffff"})
      inlet.push(padded(text));
    inlet.push(joined({padded("/nendo/wrist/left"), padded("fffffff"), Bytes(28)}));
    inlet.push(Bytes(64));
    CHECK(inlet.bad == 6);
    CHECK(inlet.poses.empty());
  }

  TEST_CASE("bundles in bundles are read to a depth, and packets to a length") {
    Bytes packet = left(1);
    for (std::size_t depth = 1; depth <= 2 * max_nesting; ++depth) {
      packet = bundle(1, {packet});
      Inlet inlet;
      inlet.push(packet);
      CHECK(inlet.poses.size() == (depth <= max_nesting ? 1 : 0));
      CHECK(inlet.bad == (depth <= max_nesting ? 0 : 1));
    }
    Bytes longest = joined({padded("/other"), padded(",b")});
    longest.resize(max_packet_bytes);
    Inlet inlet;
    inlet.push(longest);
    CHECK(inlet.bad == 0);
    longest.resize(max_packet_bytes + 4);
    inlet.push(longest);
    CHECK(inlet.bad == 1);
  }

  TEST_CASE("messages to other addresses are reported, and are not bad") {
    Inlet inlet(phone());
    inlet.push(bundle(1, {message("/a", {1}), left(1), message("/nendo/wrist", {})}));
    inlet.push(message("/nendo/wrist/lef", {1, 2, 3, 0, 0, 0, 1}));
    inlet.push(message("/nendo/wrist/*", {1, 2, 3, 0, 0, 0, 1}));
    inlet.push(message("/phone/position/", {1, 2, 3}));
    CHECK(inlet.unknown == std::vector<std::string>{"/a", "/nendo/wrist", "/nendo/wrist/lef",
                                                    "/nendo/wrist/*", "/phone/position/"});
    CHECK(inlet.poses.size() == 1);
    CHECK(inlet.bad == 0);
  }

  TEST_CASE("a time tag is the nearest time to 2020, and 'immediately' is none") {
    constexpr std::uint64_t second = std::uint64_t{1} << 32U;
    constexpr std::uint64_t begin_of_2020 = 3'786'825'600 * second;
    constexpr std::uint64_t era = (std::uint64_t{1} << 32U) - 3'786'825'600; // ends in 2036
    struct Case {
      std::uint64_t tag;
      std::chrono::nanoseconds time;
    };
    for (const Case& tagged :
         {Case{begin_of_2020, 0s}, Case{begin_of_2020 + second / 2, 500ms},
          Case{begin_of_2020 - second, -1s}, Case{second, std::chrono::seconds(era) + 1s}}) {
      Inlet inlet;
      inlet.push(bundle(tagged.tag, {left(1)}));
      REQUIRE(inlet.poses.size() == 1);
      REQUIRE(inlet.poses[0].time);
      CHECK(*inlet.poses[0].time == tagged.time);
    }
    Inlet inlet;
    inlet.push(bundle(1, {left(1), bundle(begin_of_2020, {left(2)}), left(3)}));
    inlet.push(bundle(begin_of_2020, {bundle(1, {left(4)})}));
    inlet.push(bundle(0, {left(5)}));
    REQUIRE(inlet.poses.size() == 5);
    CHECK_FALSE(inlet.poses[0].time);
    CHECK(inlet.poses[1].time);
    CHECK_FALSE(inlet.poses[2].time);
    CHECK(inlet.poses[3].time); // as the outer bundle says
    CHECK_FALSE(inlet.poses[4].time);
  }

  TEST_CASE("two messages of another program are one pose in one packet, and soon after another") {
    for (const bool rotation_first : {false, true}) {
      CAPTURE(rotation_first);
      const Bytes first = rotation_first ? rotation() : position(3);
      const Bytes second = rotation_first ? position(3) : rotation();
      Inlet inlet(phone());
      inlet.push(bundle(1, {first, message("/phone/info", {}), second}));
      REQUIRE(inlet.poses.size() == 1);
      CHECK(inlet.poses[0].station == right_station);
      CHECK(inlet.poses[0].position_m == std::array{3.0, 0.0, 0.0});
      CHECK(inlet.parser.pending() == 0);
      inlet.push(first, 2s);
      CHECK(inlet.parser.pending() == first.size());
      CHECK(inlet.poses.size() == 1);
      inlet.push(second, 2s + 5ms);
      CHECK(inlet.poses.size() == 2);
      CHECK(inlet.parser.pending() == 0);
      CHECK(inlet.parser.counters().discarded_bytes == 0);
      CHECK(inlet.bad == 0);
    }
  }

  TEST_CASE("a part of a pose without the other part is bad, and moves nothing") {
    Inlet inlet(phone());
    inlet.push(position(1), 1s);
    inlet.push(rotation(), 1s + 5ms + 1us); // too late: it waits for the next position
    CHECK(inlet.bad == 1);
    CHECK(inlet.poses.empty());
    inlet.push(rotation(), 1s + 8ms);
    CHECK(inlet.bad == 2);
    inlet.push(position(2), 1s + 9ms);
    REQUIRE(inlet.poses.size() == 1);
    CHECK(inlet.poses[0].position_m[0] == 2.0);
    inlet.push(position(3), 2s);
    inlet.push({}, 2s + 5ms);
    CHECK(inlet.parser.pending() > 0);
    inlet.push({}, 2s + 100ms); // nothing came
    CHECK(inlet.parser.pending() == 0);
    CHECK(inlet.bad == 3);
    inlet.push(message("/phone/position", {1, 2}), 3s);
    inlet.push(message("/phone/rotation", {0, 0, 0, 2}), 3s);
    CHECK(inlet.bad == 5);
    CHECK(inlet.parser.pending() == 0);
    inlet.push(bundle(1, {position(4), position(5), rotation(), rotation()}), 4s);
    REQUIRE(inlet.poses.size() == 2);
    CHECK(inlet.poses[1].position_m[0] == 5.0);
  }

  TEST_CASE("whatever is sent, each byte is accounted for, and each pose is one") {
    std::mt19937 random(11);
    Inlet inlet(phone());
    std::chrono::microseconds now = 1s;
    for (int round = 0; round < 3000; ++round) {
      Bytes packet = bundle(random() % 3, {left(1), bundle(2, {position(2), rotation()}), left(3)});
      if (random() % 3 == 0) packet = random() % 2 == 0 ? position(1) : rotation();
      nendo::test::mutilate(packet, random() % 4, random);
      now += std::chrono::microseconds(random() % 8000);
      inlet.push(packet, now);
    }
    CHECK(inlet.poses.size() > 500);
    CHECK(inlet.bad > 500);
    for (const Pose& pose : inlet.poses) {
      const auto& [x, y, z] = pose.position_m;
      CHECK(std::hypot(x, y, z) <= max_distance_m);
      const auto& q = pose.turn_xyzw;
      CHECK(std::abs(std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) - 1.0) < 0.0021);
    }
  }
}

} // namespace osc_parser_test
