#include "units/cyberglove_unit.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/unit_bench.hpp"

namespace cyberglove_unit_test {

using namespace std::chrono_literals;
using nendo::Side;
using nendo::driver::Motion;
using namespace nendo::emulator;
using namespace nendo::test;
using Bench = nendo::test::UnitBench<CyberGloveUnit, UnitOptions>;

TEST_SUITE("cyberglove_unit") {
  namespace {
  UnitOptions with_sensors(unsigned sensors) {
    UnitOptions options;
    options.sensors = sensors;
    return options;
  }
  } // namespace

  TEST_CASE("queries get the reference replies") {
    Bench right;
    CHECK(right.ask("?S") == Bytes{0x3F, 0x53, 0x16, 0x00});
    CHECK(right.ask("?G") == Bytes{0x3F, 0x47, 0x03, 0x00});
    CHECK(right.ask("?K") == Bytes{0x3F, 0x4B, 0x7F, 0xFF, 0x7F, 0x00});
    CHECK(right.ask("?W") == Bytes{0x3F, 0x57, 0x00, 0x00});
    CHECK(right.ask("?R") == Bytes{0x3F, 0x52, 0x01, 0x00});
    CHECK(right.ask("?N") == Bytes{0x3F, 0x4E, 0x16, 0x00});
    CHECK(right.ask("?M") == Bytes{0x3F, 0x4D, 0xFF, 0xFF, 0xFF, 0x00});
    CHECK(right.ask("?V").size() == 7);
    CHECK(right.ask("?B") == Bytes{0x3F, 0x42, 0x00, 0x00});

    UnitOptions options = with_sensors(18);
    options.side = Side::left;
    Bench left(options);
    CHECK(left.ask("?S") == Bytes{0x3F, 0x53, 0x12, 0x00});
    CHECK(left.ask("?K") == Bytes{0x3F, 0x4B, 0x3F, 0xBB, 0x7B, 0x00});
    CHECK(left.ask("?R") == Bytes{0x3F, 0x52, 0x00, 0x00});
  }

  TEST_CASE("at power-up the filter is on and the switch drives the light, nothing else") {
    Bench bench;
    // Byte 1: plugged in, always. Byte 2: switch controls light, filter, right hand, valid.
    CHECK(bench.ask("?P") == Bytes{0x3F, 0x50, 0x81, 0xD8, 0x00, 0x00});
    for (const char letter : std::string_view("DLQUW")) {
      CHECK(bench.ask(std::string("?") + letter)[2] == 0);
    }
    CHECK(bench.ask("?F")[2] == 1);
    CHECK(bench.ask("?J")[2] == 1);
    // 90 records per second: 1280 ticks, once; high byte first.
    CHECK(bench.ask("?T") == Bytes{0x3F, 0x54, 0x05, 0x00, 0x00, 0x01, 0x00});
  }

  TEST_CASE("the information text starts as one known host expects, and names the glove") {
    const auto text = [](Side side) {
      UnitOptions options;
      options.side = side;
      const Bytes bytes = Bench(options).ask("?i");
      CHECK(std::count(bytes.begin(), bytes.end(), 0) == 1);
      CHECK(bytes.back() == 0);
      return std::string(bytes.begin(), bytes.end());
    };
    CHECK(text(Side::right).substr(0, 7) == "?i \r\nCG");
    CHECK(text(Side::left).substr(0, 7) != "?i \r\nCG");
    CHECK(text(Side::left).find("CyberGlove") != std::string::npos);
  }

  TEST_CASE("set commands answer with their letter, in the binary and in the text form") {
    Bench bench;
    CHECK(bench.ask(Bytes{0x46, 0x00}) == Bytes{0x46, 0x00});
    CHECK(bench.ask("?F")[2] == 0);
    CHECK(bench.ask(Bytes{0x55, 0x01}) == Bytes{0x55, 0x00});
    CHECK(bench.ask("?U")[2] == 1);
    CHECK(bench.ask("u 0\r") == Bytes{'u', '\r', '\n', 0x00});
    CHECK(bench.ask("?U")[2] == 0);
    CHECK(bench.ask("d 1\r") == Bytes{'d', '\r', '\n', 0x00});
    CHECK(bench.ask("?D")[2] == 1);
    CHECK(bench.ask(Bytes{'M', 0x03, 0x00, 0x40}) == Bytes{'M', 0x00}); // 0x03 is data here
    CHECK(bench.ask("?M") == Bytes{0x3F, 0x4D, 0x03, 0x00, 0x40, 0x00});
    CHECK(bench.ask(Bytes{'T', 0x04, 0x80, 0x00, 0x01}) == Bytes{'T', 0x00});
    CHECK(bench.ask("?T") == Bytes{0x3F, 0x54, 0x04, 0x80, 0x00, 0x01, 0x00});
    CHECK(bench.ask("t 1536 2\r") == Bytes{'t', '\r', '\n', 0x00});
    CHECK(bench.ask("?T") == Bytes{0x3F, 0x54, 0x06, 0x00, 0x00, 0x02, 0x00});
    CHECK(bench.ask(Bytes{'F', '0'}) == Bytes{'F', 0x00}); // a digit in the binary form means on
    CHECK(bench.ask("?F")[2] == 1);
  }

  TEST_CASE("the switch drives the light as long as it is set to") {
    Bench bench;
    bench.ask("w 1\r");
    CHECK(bench.ask("?L")[2] == 1);
    bench.ask(Bytes{'J', 0});
    bench.ask("w 0\r");
    CHECK(bench.ask("?L")[2] == 1);
    bench.ask("l 0\r");
    CHECK(bench.ask("?L")[2] == 0);
  }

  TEST_CASE("a sensor that is stuck stays, and the others move on") {
    for (const bool with_count : {true, false}) {
      Bench bench;
      constexpr std::size_t slot = 5; // index_pip; before it no slot is missing
      const Bytes before = bench.ask("G");
      Incident stuck{Incident::Kind::sensor_stuck};
      stuck.sensor = nendo::Sensor::index_pip;
      if (with_count) stuck.count = 255;
      bench.unit.inject(stuck, bench.now);
      std::vector<Bytes> records;
      for (int n = 0; n < 100; ++n) {
        bench.after(50ms);
        records.push_back(bench.ask("G"));
      }
      int others = 0;
      for (const Bytes& record : records) {
        REQUIRE(record.size() == before.size());
        CHECK(record[1 + slot] == (with_count ? 255 : records.front()[1 + slot]));
        if (record[slot] != before[slot]) ++others;
      }
      CHECK(others > 50);
      stuck.kind = Incident::Kind::sensor_free;
      bench.unit.inject(stuck, bench.now);
      bool moves = false;
      for (int n = 0; n < 100; ++n) {
        bench.after(50ms);
        moves = moves || bench.ask("G")[1 + slot] != records.front()[1 + slot];
      }
      CHECK(moves);
    }
  }

  TEST_CASE("a motion from outside is what the records show") {
    UnitOptions options;
    options.played = [](double) {
      nendo::driver::JointAngles angles{};
      angles[5] = 1.0;
      return angles;
    };
    Bench bench(options);
    const Bytes record = bench.ask("G");
    CHECK(static_cast<int>(record[1 + 5]) == doctest::Approx(60 + 1.0 / 0.0125).epsilon(0.03));
    CHECK(static_cast<int>(record[1 + 4]) == doctest::Approx(60).epsilon(0.05));
  }

  TEST_CASE("small letters ask for the same numbers in text, one line each") {
    UnitOptions options = with_sensors(18);
    options.side = Side::left;
    options.touch = true;
    Bench bench(options);
    bench.ask("m 3 0 64\r");
    bench.ask("t 1536 2\r");
    bench.ask("a 1 3 255\r");
    bench.ask("b 32\r");
    // As many numbers as the driver names that asks a real unit so, masks lowest byte first.
    struct Case {
      char letter;
      std::string numbers;
    };
    for (const Case& c :
         {Case{'r', "0"}, Case{'s', "18"}, Case{'g', "3"}, Case{'k', "63 187 123"},
          Case{'m', "3 0 64"}, Case{'n', "18"}, Case{'p', "129 152 2"}, Case{'t', "1536 2"},
          Case{'b', "32"}, Case{'u', "0"}, Case{'v', "2 1"}, Case{'d', "0"}, Case{'f', "1"},
          Case{'j', "1"}, Case{'l', "0"}, Case{'q', "0"}, Case{'w', "0"}, Case{'y', "0"},
          Case{'a', "0 0 0 255 0 0"}}) {
      CAPTURE(c.letter);
      const std::string question = std::string("?") + c.letter;
      CHECK(text_of(bench.ask(question)) == question + " " + c.numbers + std::string("\r\n\0", 3));
    }
    CHECK(bench.ask("?x") == Bytes{'e', '?', 0});
    // One program takes what follows the third byte for the number of sensors.
    CHECK(std::stoi(text_of(bench.ask("?n")).substr(3)) == 18);
  }

  TEST_CASE("a program that asks in text until it is answered gets through") {
    Bench bench;
    for (const char letter : std::string_view("irbgmn")) {
      const Bytes reply = bench.ask(std::string("?") + letter);
      REQUIRE(reply.size() > 3);
      CHECK(reply[1] == letter);
    }
    const Bytes done = bench.ask("u 1\r");
    CHECK(std::find(done.begin(), done.end(), 0) - done.begin() >
          1); // else it asks again, for ever
    CHECK(text_of(bench.ask("?u")) == std::string("?u 1\r\n\0", 7));
    CHECK(text_of(bench.ask("g")).starts_with("g "));
  }

  TEST_CASE("parameter flags set all switches at once and cannot change what is read-only") {
    Bench bench;
    CHECK(bench.ask(Bytes{'P', 0x00, 0x24, 0x01}) == Bytes{'P', 0x00});
    CHECK(bench.ask("?P") == Bytes{0x3F, 0x50, 0x81, 0xE4, 0x01, 0x00});
    CHECK(bench.ask("?D")[2] == 1);
    CHECK(bench.ask("?U")[2] == 1);
    CHECK(bench.ask("?F")[2] == 0);
    CHECK(bench.ask("?Q")[2] == 1);
  }

  TEST_CASE("what it does not know or cannot read it answers with an error pair") {
    Bench bench;
    CHECK(bench.ask("X") == Bytes{'e', '?', 0});
    CHECK(bench.ask("?X") == Bytes{'e', '?', 0});
    CHECK(bench.ask("t 1152\r") == Bytes{'e', 'n', 0});
    CHECK(bench.ask("t 1152 1 1\r") == Bytes{'e', 'n', 0});
    CHECK(bench.ask("t 65536 1\r") == Bytes{'e', 'n', 0});
    CHECK(bench.ask("u on\r") == Bytes{'e', 'n', 0});
    CHECK(bench.ask("n 256\r") == Bytes{'e', 'n', 0});
    CHECK(bench.ask("u " + std::string(5000, '1') + "\r") == Bytes{'e', 'n', 0});
    CHECK(bench.ask("?S").size() == 4);
  }

  TEST_CASE("a command that stays incomplete is forgotten") {
    Bench bench;
    CHECK(bench.ask("AT\r") == Bytes{'e', '?', 0}); // a modem probe; T waits for three more bytes
    bench.after(1100ms);
    CHECK(bench.ask("?S").size() == 4);
    bench.ask("t 11");
    CHECK(bench.ask(Bytes{0x03}) == Bytes{0x03, 0x00});
    CHECK(bench.ask("?S").size() == 4);
  }

  TEST_CASE("a record is its header, a value above 0 for every sensor, and NUL") {
    for (const unsigned sensors : {18U, 22U}) {
      Bench bench(with_sensors(sensors));
      for (int n = 0; n < 200; ++n) {
        const Bytes record = bench.ask("G");
        REQUIRE(record.size() == sensors + 2);
        CHECK(record[0] == 'G');
        CHECK(std::find(record.begin(), record.end(), 0) == record.end() - 1);
        bench.now += 50ms;
      }
    }
  }

  TEST_CASE("time stamp and status follow the values as in the reference record") {
    Bench bench;
    bench.now = 0s;
    bench.ask(
        Bytes{'P', 0x06, 0x24, 0x00}); // switch and light on; status and time stamp in records
    // 0x00010002 ticks of 1/115200 s, rounded up to the next nanosecond.
    bench.now = CyberGloveUnit::Time((0x00010002LL * 78125 + 8) / 9);
    const Bytes record = bench.ask("G");
    REQUIRE(record.size() == 30);
    CHECK(Bytes(record.begin() + 23, record.end()) ==
          Bytes{0x8A, 0x02, 0x01, 0x01, 0x01, 0x87, 0x00});
  }

  TEST_CASE(
      "the time stamp, its zero bytes restored, counts 115200 per second and wraps after 2^32") {
    Bench bench;
    bench.now = 0s;
    bench.ask(Bytes{'D', 0x01});
    for (const auto seconds : {0s, 1s, 3600s, 37282s, 37283s, 100000s}) {
      bench.now = seconds;
      const Bytes record = bench.ask("G");
      REQUIRE(record.size() == 29);
      std::uint32_t ticks = 0;
      for (unsigned k = 0; k < 4; ++k) {
        const bool was_zero = ((record[23] >> k) & 1) != 0;
        if (was_zero) CHECK(record[24 + k] == 1);
        ticks |= static_cast<std::uint32_t>(was_zero ? 0 : record[24 + k]) << (8 * k);
      }
      CHECK(record[23] >= 0x80);
      CHECK(ticks ==
            static_cast<std::uint32_t>(static_cast<std::uint64_t>(seconds.count()) * 115200));
    }
  }

  TEST_CASE("the software mask and the count choose which values a record holds") {
    UnitOptions options;
    options.motion = Motion::rest;
    Bench whole(options);
    Bench masked(options);
    masked.ask(Bytes{'M', 0x71, 0xFF, 0xFF}); // thumb roll, index MCP, PIP, DIP and all later ones
    masked.ask(Bytes{'N', 5});
    const Bytes all = whole.ask("G");
    const Bytes some = masked.ask("G");
    CHECK(some == Bytes{'G', all[1], all[5], all[6], all[7], all[8], 0});
    masked.now += 20ms;
    masked.ask(Bytes{'N', 255});
    CHECK(masked.ask("G").size() == 19 + 2);
    masked.now += 20ms;
    masked.ask(Bytes{'M', 0x80, 0, 0}); // a sensor that the glove does not have
    CHECK(masked.ask("G") == Bytes{'G', 0});
  }

  TEST_CASE("the text form of a record holds the numbers of the binary form") {
    UnitOptions options;
    options.motion = Motion::rest;
    const Bytes binary = Bench(options).ask("G");
    const Bytes text = Bench(options).ask("g");
    std::string expected = "g";
    for (std::size_t k = 1; k + 1 < binary.size(); ++k)
      expected += " " + std::to_string(binary[k]);
    expected += std::string("\r\n\0", 3);
    CHECK(std::string(text.begin(), text.end()) == expected);
  }

  TEST_CASE("a stream has the period that T sets, to the record") {
    Bench bench;
    bench.ask("t 1152 1\r");
    CHECK(bench.ask("S").empty());
    REQUIRE(bench.unit.next_due());
    CHECK(*bench.unit.next_due() - bench.now == 10ms);
    std::size_t records = 0;
    for (int n = 0; n < 1000; ++n)
      records += split(bench.after(7ms)).size();
    CHECK(records == 700);
    CHECK(bench.unit.counters().records == 700);
    CHECK(bench.unit.counters().bytes_refused == 0);
    CHECK(bench.ask(Bytes{0x03}) == Bytes{0x03, 0x00});
    CHECK(bench.after(1s).empty());
    CHECK_FALSE(bench.unit.next_due());
  }

  TEST_CASE(
      "a period too short for the device gives its best rate and the error pair in every record") {
    Bench bench;
    bench.ask("t 576 1\r"); // 200 per second; with the filter it manages 112
    bench.ask("S");
    for (const Bytes& record : split(bench.after(100ms))) {
      REQUIRE(record.size() == 26);
      CHECK(Bytes(record.end() - 3, record.end()) == Bytes{'e', 's', 0});
    }
    CHECK(bench.unit.counters().records == 11);
    bench.ask(Bytes{0x03});
    bench.ask(Bytes{'T', 0, 0, 0, 0}); // as fast as possible is never too fast
    bench.ask("S");
    for (const Bytes& record : split(bench.after(100ms)))
      CHECK(record.size() == 24);
    CHECK(bench.unit.counters().records == 22);
  }

  TEST_CASE("no host that has set no rate hears that it is too fast") {
    for (const unsigned model : {1U, 2U, 3U}) {
      for (const double rate_hz : {1.0, 90.0, 100.0, 480.0}) {
        UnitOptions options;
        options.model = model;
        options.rate_hz = rate_hz;
        Bench bench(options);
        bench.ask("f 1\r");
        bench.ask("S");
        for (const Bytes& record : split(bench.after(3s)))
          REQUIRE(record.size() == 24);
        bench.ask(Bytes{0x03});
        bench.now += 1s;
        CHECK(bench.ask("G").size() == 24);
      }
    }
  }

  TEST_CASE("a unit whose own period is too short for it says so until another is set") {
    UnitOptions options;
    options.overrun = true;
    Bench bench(options);
    bench.ask("S");
    const auto records = split(bench.after(1s));
    CHECK(records.size() == 90);
    for (const Bytes& record : records)
      CHECK(Bytes(record.end() - 3, record.end()) == Bytes{'e', 's', 0});
    bench.ask(Bytes{0x03});
    bench.ask("t 1280 1\r");
    bench.ask("S");
    for (const Bytes& record : split(bench.after(1s)))
      CHECK(record.size() == 24);
  }

  TEST_CASE("records that are asked for one by one come at most some 90 times a second") {
    for (const char letter : {'G', 'g'}) {
      Bench bench;
      std::size_t records = 0;
      bench.send({static_cast<std::uint8_t>(letter)});
      for (int n = 0; n < 10'000; ++n) { // a second of a host that asks as soon as it is answered
        const auto received = split(bench.after(100us));
        records += received.size();
        if (!received.empty()) bench.send({static_cast<std::uint8_t>(letter)});
      }
      CHECK(records >= 88);
      CHECK(records <= 91);
    }
    UnitOptions options;
    options.rate_hz = 400; // it was asked to be a faster one
    Bench fast(options);
    fast.ask("GG");
    CHECK(*fast.unit.next_due() - fast.now == 2500us);
  }

  TEST_CASE("what is said while a record is taken is answered after it, in order") {
    Bench bench;
    bench.now = 1s;
    bench.ask("d 1\r");
    CHECK(bench.ask("G").size() == 29);
    CHECK(bench.ask("G?S").empty());
    CHECK(bench.ask("G?R").empty());
    CHECK(bench.after(11ms).empty());
    const Bytes second = bench.after(1ms);
    REQUIRE(second.size() == 29 + 4);
    // It was taken when it was due: 1/90 s after the first one, whose stamp is 115200 ticks.
    CHECK(Bytes(second.begin() + 23, second.begin() + 28) == Bytes{0x89, 0x01, 0xC7, 0x01, 0x01});
    CHECK(Bytes(second.begin() + 29, second.end()) == Bytes{'?', 'S', 22, 0});
    const Bytes third = bench.after(11ms);
    REQUIRE(third.size() == 29 + 4);
    CHECK(third[30] == 'R');
    // It hears only so much.
    bench.ask(std::string(10'000, 'G'));
    CHECK(split(bench.after(1h)).size() < 100);
    // A restart forgets all of it.
    bench.ask("GG");
    bench.unit.inject({Incident::Kind::power_cycle}, bench.now);
    bench.receive();
    CHECK(bench.after(10s).empty());
  }

  TEST_CASE("a streaming unit handles only 0x03") {
    Bench bench;
    bench.ask("S");
    Bytes all;
    for (unsigned byte = 0; byte < 256; ++byte) {
      if (byte != 0x03) all.push_back(static_cast<std::uint8_t>(byte));
    }
    CHECK(bench.ask(all).empty());
    for (const Bytes& record : split(bench.after(100ms))) {
      CHECK(record.size() == 24);
      CHECK(record[0] == 'S');
    }
    CHECK(bench.ask(Bytes{0x03}) == Bytes{0x03, 0x00});
    CHECK(bench.ask("?P") == Bytes{0x3F, 0x50, 0x81, 0xD8, 0x00, 0x00});
  }

  TEST_CASE("a restart takes 0.2 s, during which it is deaf, and undoes every setting") {
    Bench bench;
    bench.ask(Bytes{'U', 1});
    bench.ask("t 11520 1\r");
    CHECK(bench.ask(Bytes{0x12}).empty());
    CHECK(bench.ask("?S").empty());
    CHECK(bench.after(199ms).empty());
    CHECK(bench.after(1ms) == Bytes{0x12, 0x0D, 0x0A, 0x00});
    CHECK(bench.ask("?U")[2] == 0);
    CHECK(bench.ask("?T")[3] == 0);
    CHECK(bench.ask(Bytes{0x09}) == Bytes{0x09, 0x00});
  }

  TEST_CASE("a client with the delays of the maker's library reads the restart's answer") {
    Bench bench;
    CHECK(bench.ask(Bytes{0x12}).empty());
    CHECK(bench.after(250ms) == Bytes{0x12, 0x0D, 0x0A, 0x00});
  }

  TEST_CASE("?i names the maker, the model and the hand") {
    for (const unsigned model : {1U, 2U, 3U}) {
      UnitOptions options;
      options.model = model;
      Bench bench(options);
      std::string text;
      for (const auto byte : bench.ask("?i"))
        text.push_back(static_cast<char>(byte));
      CAPTURE(text);
      CHECK(text.starts_with("?i \r\nCG"));
      CHECK(text.ends_with(std::string("\r\n\0", 3)));
      CHECK(text.find("CyberGlove") != std::string::npos);
      CHECK(text.find(model == 1 ? "Virtual Technologies" : "CyberGlove Systems") !=
            std::string::npos);
    }
  }

  TEST_CASE("a restart takes as long as it is set to") {
    for (const auto time : {0ms, 250ms, 5000ms}) {
      UnitOptions options;
      options.restart_s = nendo::to_seconds(time);
      Bench bench(options);
      bench.ask(Bytes{'U', 1});
      bench.ask(Bytes{0x12});
      if (time > 0ms) CHECK(bench.after(time - 1ms).empty());
      CHECK(bench.after(1ms) == Bytes{0x12, 0x0D, 0x0A, 0x00});
      CHECK(bench.ask("?U")[2] == 0);
    }
  }

  TEST_CASE("the motion begins with the first record, whenever that is") {
    Bench early;
    Bench late;
    late.after(5min);
    CHECK(early.ask("S").empty());
    CHECK(late.ask("S").empty());
    CHECK(early.after(400ms) == late.after(400ms));
  }

  TEST_CASE("a host that does not read costs whole records, all of them counted") {
    Bench bench;
    bench.send({'S'});
    bench.now += 100s;
    bench.unit.advance(bench.now);
    CHECK(bench.unit.output().size() <= CyberGloveUnit::output_capacity);
    const auto counters = bench.unit.counters();
    CHECK(counters.records * 24 + counters.bytes_refused == 9000 * 24);
    for (const Bytes& record : split(bench.receive()))
      CHECK(record.size() == 24);
    CHECK(split(bench.after(100ms)).size() == 9);
    // After any pause, there is no work to catch up with.
    bench.after(24h * 365);
    CHECK(bench.unit.counters().records * 24 + bench.unit.counters().bytes_refused >
          60'000'000'000);
  }

  TEST_CASE("no bytes whatever make it crash or say more than its output holds") {
    std::mt19937 random(4);
    for (int round = 0; round < 200; ++round) {
      Bench bench;
      for (int n = 0; n < 200; ++n) {
        Bytes bytes(random() % 40);
        for (auto& byte : bytes)
          byte = static_cast<std::uint8_t>(random());
        bench.send(bytes);
        bench.now += std::chrono::milliseconds(random() % 500);
        bench.unit.advance(bench.now);
        REQUIRE(bench.unit.output().size() <= CyberGloveUnit::output_capacity);
        if (random() % 4 == 0) bench.unit.take(random() % 2000);
      }
      // After all commands, the usual recovery works: stop, wait out records that were asked for,
      // a half command and a restart, ask.
      bench.send({0x03});
      bench.after(4s);
      bench.ask(Bytes{0x03});
      CHECK(bench.ask("?S") == Bytes{0x3F, 0x53, 0x16, 0x00});
    }
  }
}

} // namespace cyberglove_unit_test
