#include "vrpn/vrpn_parser.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"
#include "support/parser_laws.hpp"

namespace vrpn_parser_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::driver::vrpn;

namespace {

using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;

constexpr std::size_t longest = 24 + 8 + 1024;

void append(Bytes& bytes, std::uint64_t number, int count) {
  for (int byte = count - 1; byte >= 0; --byte)
    bytes.push_back(static_cast<std::byte>(number >> (8 * byte) & 0xFFU));
}

Bytes number_of(std::uint64_t number, int count) {
  Bytes bytes;
  append(bytes, number, count);
  return bytes;
}

struct Envelope {
  std::int64_t sender = 0;
  std::int64_t type = 0;
  std::uint64_t seconds = 1'700'000'000;
  std::uint64_t microseconds = 250'000;
};

/// A message, whose length may be a lie.
Bytes message(const Envelope& envelope, const Bytes& payload, std::uint64_t length) {
  Bytes bytes;
  append(bytes, length, 4);
  append(bytes, envelope.seconds, 4);
  append(bytes, envelope.microseconds, 4);
  append(bytes, static_cast<std::uint64_t>(envelope.sender), 4);
  append(bytes, static_cast<std::uint64_t>(envelope.type), 4);
  append(bytes, 77, 4);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  while (bytes.size() % 8 != 0)
    bytes.push_back(std::byte{0});
  return bytes;
}

Bytes message(const Envelope& envelope, const Bytes& payload) {
  return message(envelope, payload, 24 + payload.size());
}

Bytes name_payload(std::string_view name) {
  return joined({number_of(name.size() + 1, 4), bytes_of(name), number_of(0, 1)});
}

Bytes sender_name(std::int64_t number, std::string_view name) {
  return message({number, -1}, name_payload(name));
}
Bytes type_name(std::int64_t number, std::string_view name) {
  return message({number, -2}, name_payload(name));
}

Bytes cookie_of(std::string_view version) {
  return joined({bytes_of(version), bytes_of("  0"), Bytes(5)});
}

/// A client sets the last number of a header, which no server reads, to 0.
Bytes without_sequence(Bytes bytes) {
  for (std::size_t at = 0; at + 24 <= bytes.size();) {
    const auto length = std::to_integer<std::size_t>(bytes[at + 3]);
    bytes[at + 23] = std::byte{0};
    at += (length + 7) / 8 * 8;
  }
  return bytes;
}

constexpr std::int64_t tracker = 3; ///< the server's number of Tracker0
constexpr std::int64_t other = 4;
constexpr std::int64_t pose_type = 11;
constexpr std::int64_t text_type = 12;
constexpr std::int64_t pong_type = 13;

Bytes beginning() {
  return joined({cookie_of("vrpn: ver. 07.35"), sender_name(0, "VRPN Control"),
                 sender_name(tracker, "Tracker0"), sender_name(other, "Tracker1"),
                 type_name(pose_type, "vrpn_Tracker Pos_Quat"),
                 type_name(text_type, "vrpn_Base text_message"),
                 type_name(pong_type, "vrpn_Base pong_message")});
}

Bytes pose_payload(int sensor, double x) {
  Bytes bytes;
  append(bytes, static_cast<std::uint64_t>(static_cast<std::int64_t>(sensor)), 4);
  append(bytes, 0xEEEEEEEE, 4); // unused
  for (const double value : {x, 2.0, -3.0, 0.5, -0.5, 0.5, 0.5})
    append(bytes, std::bit_cast<std::uint64_t>(value), 8);
  return bytes;
}

Bytes pose_of(int sensor, double x) {
  return message({tracker, pose_type}, pose_payload(sensor, x));
}

Bytes text_of(std::string_view text) {
  Bytes bytes = joined({number_of(1, 4), number_of(0, 4), bytes_of(text)});
  bytes.resize(8 + 1024);
  return message({tracker, text_type}, bytes);
}

Parser delivering(std::vector<std::uint16_t> sensors = {0}) {
  Parser parser("Tracker0", std::move(sensors));
  parser.deliver_poses(true);
  return parser;
}

using Outcome = test::Outcome<Pose>;

Outcome parse(const Bytes& input) {
  Outcome outcome = test::parse<Pose>(delivering(), input, longest);
  CHECK(outcome.counters.record_bytes == 88 * outcome.counters.records);
  return outcome;
}

using Places = std::vector<int>;

Places places_in(const Outcome& outcome) {
  Places places;
  for (const Pose& pose : outcome.records)
    places.push_back(static_cast<int>(pose.position_m[0]));
  return places;
}

/// What a parser finds, a word for each finding.
std::string found_in(Parser& parser, const Bytes& input) {
  std::string words;
  parser.push(
      input,
      FindingSink{
          [&](const Pose&) { words += "pose "; },
          [&](const Greeting& greeting) {
            words += (greeting.is_vrpn_7 ? "hello:" : "wrong:") + std::string(greeting.text) + " ";
          },
          [&](const SenderName& sender) { words += "name:" + std::string(sender.name) + " "; },
          [&](const OtherPose& pose) { words += "sensor:" + std::to_string(pose.sensor) + " "; },
          [&](Pong) { words += "pong "; },
          [&](const Text& text) {
            words += "text" + std::to_string(text.severity) + ":" + std::string(text.text) + " ";
          },
          [&](BadRecord) { words += "bad "; }});
  return words;
}

} // namespace

TEST_SUITE("vrpn_parser") {
  TEST_CASE("empty input yields no pose") {
    CHECK(parse({}).records.empty());
  }

  TEST_CASE("a pose is delivered as it was sent") {
    const Outcome outcome = parse(joined({beginning(), pose_of(0, 1.25)}));
    REQUIRE(outcome.records.size() == 1);
    const Pose& pose = outcome.records.front();
    CHECK(pose.sensor == 0);
    CHECK(pose.position_m == std::array{1.25, 2.0, -3.0});
    CHECK(pose.turn_xyzw == std::array{0.5, -0.5, 0.5, 0.5});
    CHECK(pose.stamp == std::chrono::nanoseconds(1'700'000'000'250'000'000));
    CHECK(outcome.counters.bad_records == 0);
    CHECK(outcome.counters.discarded_bytes == beginning().size());
    CHECK(outcome.pending == 0);
  }

  TEST_CASE("two poses in a row are two") {
    CHECK(places_in(parse(joined({beginning(), pose_of(0, 9), pose_of(0, 50)}))) == Places{9, 50});
  }

  TEST_CASE("what is before the cookie, or another cookie, ends the stream") {
    for (const Bytes& first :
         {bytes_of("x"), bytes_of({0}), cookie_of("vrpn: ver. 06.35"),
          cookie_of("vrpn: ver. 07x35"), bytes_of("SSH-2.0-OpenSSH_9.2p1 Debian\r\n")}) {
      const Bytes stream = joined({first, beginning(), pose_of(0, 9)});
      const Outcome outcome = parse(stream);
      CHECK(outcome.records.empty());
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == stream.size());
    }
  }

  TEST_CASE("another minor version is read") {
    Bytes stream = joined({beginning(), pose_of(0, 9)});
    stream[14] = std::byte{'0'};
    stream[15] = std::byte{'1'};
    CHECK(places_in(parse(stream)) == Places{9});
    Parser parser = delivering();
    CHECK(found_in(parser, cookie_of("vrpn: ver. 07.01")) == "hello:vrpn: ver. 07.01 ");
    CHECK_FALSE(parser.is_broken());
  }

  TEST_CASE("a truncated pose is held back") {
    const Bytes whole = pose_of(0, 9);
    for (std::size_t length = 1; length < whole.size(); ++length) {
      Bytes half = whole;
      half.resize(length);
      const Outcome outcome = parse(joined({beginning(), half}));
      CHECK(outcome.records.empty());
      CHECK(outcome.pending == length);
    }
  }

  TEST_CASE("a message shorter than its header or longer than 64 kB ends the stream") {
    for (const std::uint64_t length : {std::uint64_t{0}, std::uint64_t{23}, std::uint64_t{65'537},
                                       std::uint64_t{0x80000000}, std::uint64_t{0xFFFFFFFF}}) {
      CAPTURE(length);
      Parser parser = delivering();
      CHECK(found_in(parser, joined({beginning(), pose_of(0, 9)})).ends_with("pose "));
      CHECK_FALSE(parser.is_broken());
      CHECK(found_in(parser, joined({message({tracker, pose_type}, {}, length), pose_of(0, 10)})) ==
            "bad ");
      CHECK(parser.is_broken());
      test::check_accounted(parser, parser.counters().bytes, longest);
      parser.reset();
      CHECK_FALSE(parser.is_broken());
      CHECK(found_in(parser, joined({beginning(), pose_of(0, 9)})).ends_with("pose "));
    }
  }

  TEST_CASE("messages of unknown types, senders and any allowed length are skipped") {
    Bytes others;
    for (const std::int64_t type :
         {std::int64_t{-3}, std::int64_t{-4}, std::int64_t{-2147483648}, std::int64_t{99},
          std::int64_t{2000}, std::int64_t{2147483647}}) {
      for (const std::size_t length : {0U, 1U, 7U, 8U, 64U, 1033U, 65'512U})
        others = joined({others, message({tracker, type}, Bytes(length, std::byte{0xA5}))});
    }
    for (const std::int64_t sender :
         {std::int64_t{-1}, other, std::int64_t{2000}, std::int64_t{2147483647}})
      others = joined({others, message({sender, pose_type}, pose_payload(0, 77)),
                       message({sender, pong_type}, {}), message({sender, text_type}, Bytes(9))});
    const Outcome outcome = parse(joined({beginning(), pose_of(0, 9), others, pose_of(0, 50)}));
    CHECK(places_in(outcome) == Places{9, 50});
    CHECK(outcome.counters.bad_records == 0);
    CHECK(outcome.counters.discarded_bytes == beginning().size() + others.size());
  }

  TEST_CASE("a pose or a text of the wrong length is bad, and dropped alone") {
    for (const std::size_t length : {0U, 4U, 63U, 65U, 72U, 2000U}) {
      CAPTURE(length);
      const Outcome outcome = parse(
          joined({beginning(), pose_of(0, 9),
                  message({tracker, pose_type}, Bytes(length, std::byte{1})), pose_of(0, 50)}));
      CHECK(places_in(outcome) == Places{9, 50});
      CHECK(outcome.counters.bad_records == 1);
    }
    for (const std::size_t length : {0U, 3U, 7U, 1033U}) {
      CAPTURE(length);
      const Outcome outcome = parse(
          joined({beginning(), message({tracker, text_type}, Bytes(length)), pose_of(0, 50)}));
      CHECK(places_in(outcome) == Places{50});
      CHECK(outcome.counters.bad_records == 1);
    }
  }

  TEST_CASE("names and numbers out of range are bad, and change nothing") {
    Bytes names;
    std::uint64_t count = 0;
    const auto add = [&](const Bytes& name) { names = joined({names, name}), ++count; };
    for (const std::int64_t number : {std::int64_t{-1}, std::int64_t{2000},
                                      std::int64_t{2147483647}, std::int64_t{-2147483648}}) {
      add(sender_name(number, "Tracker0"));
      add(type_name(number, "vrpn_Tracker Pos_Quat"));
    }
    add(message({tracker, -1}, {}));
    add(message({tracker, -1}, number_of(9, 3)));
    add(message({tracker, -1}, joined({number_of(0, 4), bytes_of("Other")})));
    add(message({tracker, -1}, joined({number_of(10, 4), bytes_of("Tracker0"), number_of(0, 1)})));
    add(message({tracker, -1}, joined({number_of(0xFFFFFFFF, 4), bytes_of("Other")})));
    add(sender_name(tracker, std::string(100, 'n')));
    add(sender_name(tracker, std::string(60'000, 'n')));
    add(type_name(pose_type, std::string(100, 'n')));
    const Outcome outcome = parse(joined({beginning(), names, pose_of(0, 50)}));
    CHECK(places_in(outcome) == Places{50});
    CHECK(outcome.counters.bad_records == count);
  }

  TEST_CASE("the last name of a number counts, and a name may have several numbers") {
    const Bytes pose_of_7 = message({7, pose_type}, pose_payload(0, 7));
    const Outcome outcome = parse(joined(
        {beginning(), pose_of_7, sender_name(7, "Tracker0"), pose_of_7, pose_of(0, 9),
         sender_name(7, "Tracker"), pose_of_7, sender_name(7, "tracker0"), pose_of_7,
         sender_name(7, "Tracker00"), pose_of_7, sender_name(7, "vrpn_Tracker Pos_Quat"), pose_of_7,
         type_name(7, "Tracker0"), pose_of(0, 10), type_name(pose_type, "vrpn_Tracker Velocity"),
         pose_of(0, 11), type_name(20, "vrpn_Tracker Pos_Quat"),
         message({tracker, 20}, pose_payload(0, 12))}));
    CHECK(places_in(outcome) == Places{7, 9, 10, 12});
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("a longest name is taken, and a name ends with its NUL") {
    const std::string name(99, 'T');
    Parser parser(name, {0});
    CHECK(found_in(parser, joined({beginning(), sender_name(5, name)})).ends_with(name + " "));
    CHECK(parser.knows_tracker());
    Parser short_name = delivering();
    CHECK_FALSE(short_name.knows_tracker());
    found_in(short_name, cookie_of("vrpn: ver. 07.35"));
    CHECK(found_in(short_name, sender_name(5, std::string("Tracker0\0junk", 13))) ==
          "name:Tracker0 ");
    CHECK(short_name.knows_tracker());
  }

  TEST_CASE("poses of other sensors, and all while none are wanted, are findings") {
    Parser parser("Tracker0", {2, 5});
    CHECK(found_in(parser, beginning()) ==
          "hello:vrpn: ver. 07.35 name:VRPN Control name:Tracker0 name:Tracker1 ");
    const Bytes poses =
        joined({pose_of(0, 1), pose_of(2, 1), pose_of(5, 1), pose_of(-1, 1), pose_of(65'538, 1)});
    CHECK(found_in(parser, poses) == "sensor:0 sensor:2 sensor:5 sensor:-1 sensor:65538 ");
    parser.deliver_poses(true);
    CHECK(found_in(parser, poses) == "sensor:0 pose pose sensor:-1 sensor:65538 ");
    CHECK(parser.counters().records == 2);
  }

  TEST_CASE("pongs and strings of the tracker are findings") {
    Parser parser = delivering();
    found_in(parser, beginning());
    CHECK(found_in(parser, joined({message({tracker, pong_type}, {}), text_of("no marker"),
                                   pose_of(0, 1)})) == "pong text1:no marker pose ");
    const Bytes unended = joined({number_of(2, 4), number_of(0, 4), bytes_of("oh")});
    CHECK(found_in(parser, message({tracker, text_type}, unended)) == "text2:oh ");
    CHECK(parser.counters().bad_records == 0);
  }

  TEST_CASE("a pose without a valid time is delivered without one") {
    for (const auto& [seconds, microseconds] :
         {std::pair<std::uint64_t, std::uint64_t>{0, 5}, {17, 1'000'000}, {17, 0xFFFFFFFF}}) {
      const Outcome outcome = parse(joined(
          {beginning(), message({tracker, pose_type, seconds, microseconds}, pose_payload(0, 9))}));
      REQUIRE(outcome.records.size() == 1);
      CHECK_FALSE(outcome.records[0].stamp);
    }
    const Outcome latest = parse(joined(
        {beginning(), message({tracker, pose_type, 0xFFFFFFFF, 999'999}, pose_payload(0, 9))}));
    REQUIRE(latest.records.size() == 1);
    CHECK(latest.records[0].stamp ==
          std::chrono::seconds(0xFFFFFFFF) + std::chrono::microseconds(999'999));
  }

  TEST_CASE("numbers that are not finite pass, for the hand to refuse") {
    const Outcome outcome =
        parse(joined({beginning(), pose_of(0, std::numeric_limits<double>::infinity()),
                      pose_of(0, std::numeric_limits<double>::quiet_NaN())}));
    REQUIRE(outcome.records.size() == 2);
    CHECK(std::isinf(outcome.records[0].position_m[0]));
    CHECK(std::isnan(outcome.records[1].position_m[0]));
  }

  TEST_CASE("where a VRPN stream is cut makes no difference") {
    const Bytes stream = joined(
        {beginning(), pose_of(0, 1), message({tracker, 99}, Bytes(33)), message({tracker, 99}, {}),
         pose_of(0, 2), sender_name(-7, "Tracker0"), message({tracker, pose_type}, Bytes(65)),
         message({tracker, pong_type}, {}), pose_of(1, 3), text_of("x"), pose_of(0, 4),
         message({0, 0}, {}, 23), pose_of(0, 5)});
    const auto value_of = [](const Pose& pose) { return static_cast<int>(pose.position_m[0]); };
    CHECK(test::values_however_cut<Pose>(delivering(), {stream, longest}, value_of) ==
          Places{1, 2, 4});
  }

  TEST_CASE("every byte of a VRPN stream is accounted for, however it is mutilated") {
    std::mt19937 random(5);
    for (int round = 0; round < 400; ++round) {
      Bytes stream = beginning();
      for (int k = 0; k < 30; ++k)
        stream = joined({stream, k % 5 == 4 ? text_of("x") : pose_of(0, k)});
      test::mutilate(stream, random() % 10, random);
      parse(stream);
    }
  }

  TEST_CASE("a reset drops the unfinished message, the names and the numbers") {
    Parser parser = delivering();
    const Bytes half = pose_of(0, 9);
    found_in(parser, joined({beginning(), {half.begin(), half.begin() + 40}}));
    CHECK(parser.pending() == 40);
    parser.reset();
    CHECK(parser.pending() == 0);
    CHECK_FALSE(parser.knows_tracker());
    CHECK(found_in(parser, joined({cookie_of("vrpn: ver. 07.35"), pose_of(0, 9)})) ==
          "hello:vrpn: ver. 07.35 ");
    test::check_accounted(parser, parser.counters().bytes, longest);
  }

  TEST_CASE("a client's messages have the layout of the protocol") {
    CHECK(greeting() == cookie_of("vrpn: ver. 07.35"));
    Bytes described = joined({message({0, -1, 0, 0}, name_payload("Tracker0")),
                              message({0, -2, 0, 0}, name_payload("vrpn_Base ping_message"))});
    CHECK(describe_ping("Tracker0") == without_sequence(described));
    CHECK(ping() == without_sequence(message({0, 0, 0, 0}, {})));
  }

  TEST_CASE("a file of messages yields what was worked out for it by hand") {
    test::reads_as_expected<Pose>(
        delivering({0, 3}), {"vrpn_stream.bin", longest}, [](const Pose& pose) {
          std::string line = "sensor " + std::to_string(pose.sensor);
          for (const double value : pose.position_m)
            line += " " + std::to_string(value);
          for (const double value : pose.turn_xyzw)
            line += " " + std::to_string(value);
          return line + " at " + (pose.stamp ? std::to_string(pose.stamp->count()) : "no time");
        });
  }
}

} // namespace vrpn_parser_test
