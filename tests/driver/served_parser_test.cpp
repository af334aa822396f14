#include "served/served_parser.hpp"

#include <array>
#include <chrono>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"
#include "support/parser_laws.hpp"

namespace served_parser_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::driver::served;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t longest = 65'536;

// Written from PROTOCOL.md.
const std::string follows = R"({"class":"WATCH","samples":true,"hands":false,"rate_hz":30.0})"
                            "\n";
const std::string no_more = R"({"class":"WATCH","samples":false,"hands":false,"rate_hz":30.0})"
                            "\n";

std::string sample_text(int number, int glove = 0, const std::string& more = "") {
  return R"({"class":"SAMPLE","glove":)" + std::to_string(glove) + R"(,"sequence":)" +
         std::to_string(number) +
         R"(,"arrival_ns":5000000000,"measured_ns":4999000000,"hand":"left","switch":"on",)" +
         R"("raw":{"thumb_roll":)" + std::to_string(number) + R"(,"wrist_yaw":65535},)" + more +
         R"("sampled_too_fast":true,"dropped":2})" + "\n";
}

std::string pose_text(const std::string& position = "[0.25,-1e-3,7]",
                      const std::string& error = "null") {
  return R"({"class":"POSE","tracker":1,"sequence":9,"arrival_ns":5,"measured_ns":4,)"
         R"("device_time_ns":-7,"station":3,"position_m":)" +
         position + R"(,"turn_xyzw":[0.5,-0.5,0.5,-0.5],"error":)" + error + R"(,"dropped":0})" +
         "\n";
}

const std::string glove_text =
    R"({"class":"GLOVE","index":1,"side":"left","source":"serial:/dev/ttyS0","model":"CyberGlove",)"
    R"("hand":"right","sensors":["thumb_roll","toe"],"angles":{},"rate_hz":90.5,)"
    R"("counts":{"most":4095,"whole_range":true},"abilities":{"wrist_switch":true,"light":true,)"
    R"("vibration":true,"resistance":true},"facts":{"z":"1","serial":"A\u0007B","a":"3"},)"
    R"("kind":"recorded","recording":"/takes/one.nendo"})"
    "\n";

const std::string tracker_text =
    R"({"class":"TRACKER","index":0,"side":"right","station":2,"source":"vrpn:T@h","model":"VRPN",)"
    R"("stations":[1,2],"rate_hz":240,"filtered":true,"stage_from_tracker_xyzw":[0.6,0,0,0.8],)"
    R"("facts":{},"kind":"device"})"
    "\n";

Parser of_glove(std::uint32_t index = 0) {
  Parser parser;
  parser.want({WantedDevice::Kind::glove, index});
  return parser;
}

test::Outcome<GloveSample> parse(std::string_view text, const Parser& fresh = of_glove()) {
  return test::parse<GloveSample>(fresh, test::bytes_of(text), longest);
}

template <class Kind>
Kind decoded(const std::string& text) {
  const auto line = decode_line(std::string_view(text).substr(0, text.size() - 1));
  REQUIRE(line);
  const Kind* const kind = std::get_if<Kind>(&*line);
  REQUIRE(kind != nullptr);
  return *kind;
}

bool is_bad(const std::string& text) {
  return !decode_line(text);
}

} // namespace

TEST_SUITE("served_parser") {
  TEST_CASE("no bytes from a server are no sample and no fault") {
    CHECK(parse("").records.empty());
  }

  TEST_CASE("samples of the wanted glove are records from the server's answer on") {
    const auto outcome = parse(sample_text(1) + follows + sample_text(2) + sample_text(3, 1) +
                               sample_text(4) + no_more + sample_text(5));
    REQUIRE(outcome.records.size() == 2);
    CHECK(outcome.records[0][Sensor::thumb_roll] == RawCount{2});
    CHECK(outcome.records[1][Sensor::thumb_roll] == RawCount{4});
    CHECK(outcome.counters.record_bytes == sample_text(2).size() + sample_text(4).size());
    CHECK(outcome.counters.missed == 4);
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("a sample has the server's times, counts and switch") {
    const auto line = decoded<SampleLine>(sample_text(
        7, 3, R"("device_time_ns":-2,"recorded_arrival_ns":11,"recorded_measured_ns":10,)"));
    CHECK(line.glove == 3);
    CHECK(line.dropped == 2);
    const GloveSample& sample = line.sample;
    CHECK(sample.arrival == HostTime(5s));
    CHECK(sample.measured == HostTime(4999ms));
    CHECK(sample.has_device_time);
    CHECK(sample.device_time == -2ns);
    CHECK(sample.sequence == 7);
    SensorMask both;
    both.add(Sensor::thumb_roll);
    both.add(Sensor::wrist_yaw);
    CHECK(sample.present == both);
    CHECK(sample[Sensor::thumb_roll] == RawCount{7});
    CHECK(sample[Sensor::wrist_yaw] == RawCount{65535});
    CHECK(sample.side == Side::left);
    CHECK(sample.wrist_switch == WristSwitch::on);
    CHECK(sample.sampled_too_fast);
    CHECK(sample.is_replayed);
    CHECK(sample.recorded_arrival == HostTime(11ns));
    CHECK(sample.recorded_measured == HostTime(10ns));
    const auto plain = decoded<SampleLine>(sample_text(7));
    CHECK_FALSE(plain.sample.has_device_time);
    CHECK_FALSE(plain.sample.is_replayed);
  }

  TEST_CASE("a pose has the server's place, turn and error letter") {
    const auto line = decoded<PoseLine>(pose_text("[0.25,-1e-3,7]", "\"B\""));
    CHECK(line.tracker == 1);
    CHECK(line.pose.position_m == std::array{0.25, -0.001, 7.0});
    CHECK(line.pose.turn_xyzw == std::array{0.5, -0.5, 0.5, -0.5});
    CHECK(line.pose.device_time == -7ns);
    CHECK(line.pose.station == 3);
    CHECK(line.pose.error == 'B');
    CHECK(decoded<PoseLine>(pose_text()).pose.error == ' ');
    // JSON has no infinite numbers.
    for (const char* wrong :
         {"[null,0,0]", "[0,0]", "[0,0,0,0]", "[\"1\",0,0]", "[1e999,0,0]", "7"})
      CHECK_MESSAGE(is_bad(pose_text(wrong)), wrong);
    for (const char* wrong : {"\"\"", "\"AB\"", "1"})
      CHECK_MESSAGE(is_bad(pose_text("[0,0,0]", wrong)), wrong);
  }

  TEST_CASE("a glove is as the server has it, without feedback") {
    const auto [index, side, info] = decoded<GloveLine>(glove_text);
    CHECK(index == 1);
    CHECK(side == Side::left);
    CHECK(info.source == "serial:/dev/ttyS0");
    CHECK(info.model == "CyberGlove");
    CHECK(info.side == Side::right);
    CHECK(info.sensors == SensorMask{1}); // no hand has a toe
    CHECK(info.rate_hz == 90.5);
    CHECK(info.counts == CountScale{4095, true});
    CHECK(info.abilities.wrist_switch);
    CHECK_FALSE(info.abilities.light);
    CHECK_FALSE(info.abilities.vibration);
    CHECK_FALSE(info.abilities.resistance);
    REQUIRE(info.facts.size() == 3);
    CHECK(info.facts[0].name == "z");
    CHECK(info.facts[1].value == "A?B");
    CHECK(info.facts[2].name == "a");
    CHECK(info.kind == SourceKind::recorded);
    CHECK(info.recording == "/takes/one.nendo");
  }

  TEST_CASE("a tracker is as the server has it") {
    const auto [index, side, station, info] = decoded<TrackerLine>(tracker_text);
    CHECK(index == 0);
    CHECK(side == Side::right);
    CHECK(station == 2);
    CHECK(info.stations == std::vector<std::uint16_t>{1, 2});
    CHECK(info.rate_hz == 240.0);
    CHECK(info.is_filtered);
    CHECK(info.stage_from_tracker_xyzw == std::array{0.6, 0.0, 0.0, 0.8});
    std::string no_turn = tracker_text;
    no_turn.replace(no_turn.find("0.6"), 3, "0.0");
    CHECK(is_bad(no_turn));
  }

  TEST_CASE("a line without a key that it needs, or with a value of a wrong type, is bad") {
    for (const std::string& good : {sample_text(1), pose_text(), glove_text, tracker_text}) {
      CAPTURE(good);
      REQUIRE_FALSE(is_bad(good));
      int needed = 0;
      // Each key in turn gets another name; not all are needed.
      for (std::size_t at = good.find("\":"); at != std::string::npos;
           at = good.find("\":", at + 1)) {
        std::string renamed = good;
        renamed.insert(at, "_");
        needed += is_bad(renamed) ? 1 : 0;
      }
      CHECK(needed >= 6);
    }
    for (const auto& [good, wrong] : {std::pair("\"glove\":0", "\"glove\":-1"),
                                      {"\"glove\":0", "\"glove\":256"},
                                      {"\"glove\":0", "\"glove\":0.5"},
                                      {"\"hand\":\"left\"", "\"hand\":\"foot\""},
                                      {"\"on\"", "true"},
                                      {"65535}", "65536}"},
                                      {"65535}", "-1}"},
                                      {"65535}", "1.0}"},
                                      {"\"raw\":{", "\"raw\":{\"toe\":\"\","},
                                      {"5000000000", "\"5\""},
                                      {"5000000000", "1e3"},
                                      {"5000000000", "4611686018427387904"},
                                      {"5000000000", "18446744073709551616"},
                                      {"\"dropped\":2", "\"dropped\":-2"},
                                      {"SAMPLE", "\\ud800"}}) {
      std::string text = sample_text(1);
      text.replace(text.find(good), std::string_view(good).size(), wrong);
      CHECK_MESSAGE(is_bad(text), text);
    }
  }

  TEST_CASE("lines of other classes, keys and sensors are no fault") {
    const std::string more = R"({"class":"HANDS","hands":[{"joints":{"palm":{"position_m":[0]}}}]})"
                             "\n"
                             R"({"class":"OF_TOMORROW"})"
                             "\n";
    const auto outcome = parse(follows + more + sample_text(1, 0, R"("later":[{"x":null}],)"));
    CHECK(outcome.records.size() == 1);
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("what is no object with a class is bad, and costs no other line") {
    for (const std::string& garbage :
         {std::string("\n"), std::string("}\n"), std::string("null\n"), std::string("[]\n"),
          std::string("{}\n"), std::string("{\"class\":1}\n"),
          std::string("{\"class\":\"SAMPLE\"}\n"), std::string("{\"class\":\"X\"} {}\n"),
          std::string("\xFF\xFE\n"), std::string("\0\n", 2), std::string("{\"class\":\"\xC3\"}\n"),
          std::string(40'000, '[') + "\n",
          "{\"class\":\"X\",\"deep\":" + std::string(17, '[') + std::string(17, ']') + "}\n",
          "{\"class\":\"X\",\"long\":[" +
              [] {
                std::string zeros = "0";
                for (int at = 0; at < 5000; ++at)
                  zeros += ",0";
                return zeros;
              }() +
              "]}\n"}) {
      CAPTURE(garbage.substr(0, 40));
      const auto outcome = parse(follows + sample_text(1) + garbage + sample_text(2));
      CHECK(outcome.records.size() == 2);
      CHECK(outcome.counters.bad_records == 1);
    }
  }

  TEST_CASE("a line of 65536 bytes is read, and a longer one is bad once") {
    const std::string good = sample_text(1);
    const std::string padded = good.substr(0, good.size() - 2) + R"(,"pad":")";
    const std::string fits = padded + std::string(longest - padded.size() - 3, 'x') + "\"}\n";
    REQUIRE(fits.size() == longest);
    CHECK(parse(follows + fits).records.size() == 1);
    for (const std::size_t more : {1U, 2U, 70'000U, 200'000U}) {
      std::string overlong = fits;
      overlong.insert(overlong.size() - 3, more, 'x');
      const auto outcome = parse(follows + overlong + sample_text(2));
      CHECK(outcome.records.size() == 1);
      CHECK(outcome.counters.bad_records == 1);
    }
  }

  TEST_CASE("a truncated line is held, and dropped with its connection") {
    Parser parser = of_glove();
    const std::string cut = follows + sample_text(1).substr(0, 100);
    int records = 0;
    const auto count = [&](const GloveSample&) { ++records; };
    parser.push(std::as_bytes(std::span(cut)), count);
    CHECK(parser.pending() == 100);
    parser.reset();
    test::check_accounted(parser, cut.size(), longest);
    const std::string next = sample_text(2) + follows + sample_text(3);
    parser.push(std::as_bytes(std::span(next)), count);
    CHECK(records == 1);
    CHECK(parser.counters().bad_records == 0);
  }

  TEST_CASE("samples of another time are bad") {
    Parser parser = of_glove();
    const auto outcome_at = [&](HostTime now) {
      Parser fresh = parser;
      fresh.set_arrival(now);
      return parse(follows + sample_text(1), fresh);
    };
    CHECK(outcome_at(HostTime(5s)).records.size() == 1);
    CHECK(outcome_at(HostTime(5s + 1h)).records.size() == 1);
    for (const HostTime now : {HostTime(5s - 1ns), HostTime(5s + 1h + 1ns)}) {
      const auto outcome = outcome_at(now);
      CHECK(outcome.records.empty());
      CHECK(outcome.counters.implausible == 1);
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.missed == 0);
    }
    std::string text = sample_text(1);
    text.replace(text.find("4999000000"), 10, "1");
    CHECK(parse(follows + text).records.size() == 1);
    text.replace(text.find(":1,\"hand"), 2, ":4000000000000");
    CHECK(parse(follows + text).records.empty());
  }

  TEST_CASE("a stream yields the same, however it is cut") {
    const std::string text =
        follows + sample_text(1) + "x\n" + sample_text(2, 1) + sample_text(3) + no_more;
    const auto values = test::values_however_cut<GloveSample>(
        of_glove(), {test::bytes_of(text), longest},
        [](const GloveSample& sample) { return sample[Sensor::thumb_roll].value; });
    CHECK(values == std::vector<int>{1, 3});
  }

  TEST_CASE("every byte of a mutilated stream is accounted for") {
    std::mt19937 random(5);
    std::string good = follows;
    for (int number = 0; number < 40; ++number)
      good += sample_text(number);
    std::size_t records = 0;
    for (int turn = 0; turn < 60; ++turn) {
      test::StreamBytes stream = test::bytes_of(good);
      test::mutilate(stream, static_cast<std::uint64_t>(turn % 20), random);
      const auto outcome = test::parse<GloveSample>(of_glove(), stream, longest);
      records += outcome.records.size();
      CHECK(outcome.records.size() <= 41);
    }
    CHECK(records > 1000);
  }

  TEST_CASE("a written stream means what was worked out by hand") {
    Parser parser;
    parser.want({WantedDevice::Kind::tracker, 1});
    test::reads_as_expected<PoseSample>(parser, {"served_stream.jsonl", longest},
                                        [](const PoseSample& pose) {
                                          std::ostringstream text;
                                          text << pose.station << ' ' << pose.error;
                                          for (const double number : pose.position_m)
                                            text << ' ' << number;
                                          for (const double number : pose.turn_xyzw)
                                            text << ' ' << number;
                                          return text.str();
                                        });
  }
}

} // namespace served_parser_test
