// What an emulated CyberGlove can beyond asking and streaming: calibration, vibration, external
// sync, the third model's commands, and a glove that is pulled or swapped.

#include "units/cyberglove_unit.hpp"

#include <algorithm>
#include <chrono>
#include <string>

#include <doctest/doctest.h>

#include "support/unit_bench.hpp"

namespace cyberglove_unit_commands_test {

using namespace std::chrono_literals;
using nendo::Side;
using nendo::driver::Motion;
using namespace nendo::emulator;
using namespace nendo::test;
using Bench = nendo::test::UnitBench<CyberGloveUnit, UnitOptions>;

TEST_SUITE("cyberglove_unit_commands") {
  namespace {
  UnitOptions model(unsigned number) {
    UnitOptions options;
    options.model = number;
    options.motion = Motion::rest;
    return options;
  }
  } // namespace

  TEST_CASE("vibrators are set one by one or all at once, if there are any") {
    UnitOptions options;
    CHECK(Bench(options).ask("?A") == Bytes{'e', '?', 0});
    options.touch = true;
    Bench bench(options);
    CHECK(bench.ask("?A") == Bytes{'?', 'A', 0, 0, 0, 0, 0, 0, 0});
    CHECK(bench.ask(Bytes{'A', 2, 0, 10, 5, 60}) == Bytes{'A', 0});
    CHECK(bench.ask("?A") == Bytes{'?', 'A', 10, 0, 0, 0, 0, 60, 0});
    CHECK(bench.ask(Bytes{'A', 0xFF, 1, 2, 3, 4, 5, 6}) == Bytes{'A', 0});
    CHECK(bench.ask("a 1 3 255\r") == Bytes{'a', '\r', '\n', 0});
    CHECK(bench.ask("?A") == Bytes{'?', 'A', 1, 2, 3, 255, 5, 6, 0});
    CHECK(bench.ask(Bytes{'A', 1, 6, 9}) == Bytes{'e', 'n', 0}); // there is no seventh
    CHECK(bench.ask(Bytes{'A', 7}) == Bytes{'e', 'n', 0});
    CHECK(bench.ask("?A") == Bytes{'?', 'A', 1, 2, 3, 255, 5, 6, 0});
    CHECK((bench.ask("?P")[4] & 0x02) != 0);
  }

  TEST_CASE(
      "the hardware calibration is set whole or one number at a time, and shapes Q's values") {
    Bench bench(model(1));
    Bytes all{'C', 'A'};
    all.insert(all.end(), 22, 100); // offsets
    all.insert(all.end(), 22, 64);  // gains: 1
    CHECK(bench.ask(all) == Bytes{'C', 'A', 0});
    CHECK(bench.ask(Bytes{'C', 'O', 21, 7}) == Bytes{'C', 'O', 0});
    CHECK(bench.ask(Bytes{'C', 'G', 0, 9}) == Bytes{'C', 'G', 0});
    CHECK(bench.ask(Bytes{'C', 'G', 22, 9}) == Bytes{'e', 'n', 0});
    CHECK(bench.ask(Bytes{'C', 'X'}) == Bytes{'e', 'n', 0});
    const Bytes set = bench.ask("?C");
    REQUIRE(set.size() == 2 + 44 + 1);
    CHECK(set[2] == 100);
    CHECK(set[2 + 21] == 7);
    CHECK(set[2 + 22] == 9);
    CHECK(set[2 + 43] == 64);
    CHECK(bench.ask("co 0 0\r") == Bytes{'c', 'o', '\r', '\n', 0});
    CHECK(bench.ask("cg 0 64\r") == Bytes{'c', 'g', '\r', '\n', 0});
    const std::string lines = text_of(bench.ask("?c"));
    CHECK(std::count(lines.begin(), lines.end(), '\n') == 4); // the first is empty

    Bench quantised(model(1));
    quantised.ask(all);
    quantised.ask("q 1\r");
    Bench plain(model(1));
    const Bytes raw = plain.ask("G");
    const Bytes scaled = quantised.ask("G");
    for (std::size_t k = 1; k <= 22; ++k)
      CHECK(scaled[k] == std::clamp(raw[k] - 99, 1, 255));
  }

  TEST_CASE("by default the quantised values of a moving hand use much of 1 to 255") {
    UnitOptions options;
    options.motion = Motion::grasp;
    Bench bench(options);
    bench.ask("q 1\r");
    int least = 255;
    int most = 1;
    for (int n = 0; n < 200; ++n) {
      const Bytes record = bench.ask("G");
      REQUIRE(record.size() == 24);
      REQUIRE(std::find(record.begin(), record.end(), 0) == record.end() - 1);
      least = std::min<int>(least, record[6]); // index PIP
      most = std::max<int>(most, record[6]);
      bench.now += 50ms;
    }
    CHECK(most - least > 80);
  }

  TEST_CASE("external sync gives records with its own letter, and the unit still listens") {
    for (const bool text : {false, true}) {
      Bench bench;
      CHECK(bench.ask(text ? Bytes{'y', ' ', '1', '\r'} : Bytes{'Y', 1}) ==
            (text ? Bytes{'y', '\r', '\n', 0} : Bytes{'Y', 0}));
      const auto records = split(bench.after(100ms));
      CHECK(records.size() == 9);
      for (const Bytes& record : records)
        CHECK(record[0] == (text ? 'y' : 'Y'));
      CHECK((bench.ask("?P")[3] & 0x03) == (text ? 2 : 1));
      CHECK(bench.ask(text ? Bytes{'y', ' ', '0', '\r'} : Bytes{'Y', 0}).size() == (text ? 4 : 2));
      CHECK(bench.after(1s).empty());
      bench.ask(Bytes{'Y', 1});
      CHECK(bench.ask(Bytes{0x03}) == Bytes{0x03, 0});
      CHECK(bench.after(1s).empty());
      CHECK((bench.ask("?P")[3] & 0x03) == 0);
    }
    UnitOptions options;
    options.rate_hz = 200; // the filter allows 112
    Bench fast(options);
    CHECK(fast.ask(Bytes{'Y', 1}) == Bytes{'e', 'y', 0});
    CHECK(fast.after(1s).empty());
  }

  TEST_CASE("without a glove records end in eg, and the unit says so") {
    Bench bench;
    bench.ask("u 1\r");
    bench.unit.inject({Incident::Kind::glove_out}, bench.now);
    CHECK(bench.ask("?G") == Bytes{'?', 'G', 1, 0});
    CHECK((bench.ask("?P")[2] & 1) == 0);
    const Bytes record = bench.ask("G");
    REQUIRE(record.size() == 1 + 22 + 1 + 3);
    CHECK(record[23] == 0x80); // status: always, but not plugged in
    CHECK(Bytes(record.end() - 3, record.end()) == Bytes{'e', 'g', 0});
    bench.ask("t 576 1\r");
    bench.ask("S");
    for (const Bytes& both : split(bench.after(50ms)))
      CHECK(Bytes(both.end() - 5, both.end()) == Bytes{'e', 'g', 'e', 's', 0});
    bench.ask(Bytes{0x03});
    bench.unit.inject({Incident::Kind::glove_in}, bench.now);
    CHECK(bench.ask("?G") == Bytes{'?', 'G', 3, 0});
    CHECK(bench.ask("G").size() == 1 + 22 + 1 + 1);
  }

  TEST_CASE("another glove is known only after 0x09 or a restart") {
    for (const bool restart : {false, true}) {
      Bench bench;
      bench.unit.inject({Incident::Kind::glove_out}, bench.now);
      bench.unit.inject({Incident::Kind::glove_in, 18, Side::left}, bench.now);
      CHECK(bench.ask("?S") == Bytes{'?', 'S', 22, 0});
      CHECK(bench.ask("G").size() == 24);
      CHECK(bench.ask(Bytes{static_cast<std::uint8_t>(restart ? 0x12 : 0x09)}).size() ==
            (restart ? 0 : 2));
      bench.after(2s);
      CHECK(bench.ask("?S") == Bytes{'?', 'S', 18, 0});
      CHECK(bench.ask("?R") == Bytes{'?', 'R', 0, 0});
      CHECK(bench.ask("?N") == Bytes{'?', 'N', 18, 0});
      CHECK(bench.ask("G").size() == 20);
    }
  }

  TEST_CASE("a power cycle ends the stream without a word and undoes every setting") {
    UnitOptions options;
    options.restart_s = 1.75;
    Bench bench(options);
    bench.ask("d 1\r");
    bench.ask("S");
    bench.unit.inject({Incident::Kind::power_cycle}, bench.now);
    CHECK(bench.after(5s).empty());
    CHECK(bench.ask("?D") == Bytes{'?', 'D', 0, 0});
    bench.ask("d 1\r");
    const Bytes record = bench.ask("G");
    REQUIRE(record.size() == 29);
    // 3.25 s after it was up again: 374400 ticks, 0x0005B680.
    CHECK(Bytes(record.begin() + 23, record.end()) == Bytes{0x88, 0x80, 0xB6, 0x05, 0x01, 0});
  }

  TEST_CASE("options change what sources disagree about") {
    UnitOptions options;
    options.reply_bytes = 3;
    options.period_low_first = true;
    options.stamp_bit7 = false;
    Bench bench(options);
    CHECK(bench.ask(Bytes{'F', 0}).size() == 3);
    CHECK(text_of(bench.ask("f 0\r")) == std::string("f\r\n\0", 4)); // a text is a line anyway
    CHECK(bench.ask("?T") == Bytes{'?', 'T', 0x00, 0x05, 0x01, 0x00, 0});
    bench.ask(Bytes{'T', 0x80, 0x04, 0x01, 0x00});
    bench.ask("S");
    CHECK(*bench.unit.next_due() - bench.now == 10ms);
    bench.ask(Bytes{0x03});
    bench.ask("t 1536 2\r");
    CHECK(bench.ask("?T") == Bytes{'?', 'T', 0x00, 0x06, 0x02, 0x00, 0});
    bench.ask("d 1\r");
    bench.now = 1s; // 0x0001C200: bytes 0 and 3 are replaced
    Bench early(options);
    early.now = 1s;
    early.ask("d 1\r");
    CHECK(early.ask("G")[23] == 0x09);
    early.now = 200s; // 0x015F9000 has one zero byte
    CHECK(early.ask("G")[23] == 0x01);
    early.now += 21ms; // 0x015F9973 has none: NUL must not get into a record
    CHECK(early.ask("G")[23] == 0x80);
  }

  TEST_CASE("an old glove is its mask, and a stream can be on from the start") {
    UnitOptions options;
    options.hardware_mask = 0x6333B7; // 14 sensors, one of them in slot 7
    options.streaming = true;
    Bench bench(options);
    bench.now = 0s;
    const auto records = split(bench.after(1s));
    CHECK(records.size() == 90);
    for (const Bytes& record : records)
      REQUIRE(record.size() == 16);
    bench.ask(Bytes{0x03});
    CHECK(bench.ask("?S") == Bytes{'?', 'S', 14, 0});
    CHECK(bench.ask("?K") == Bytes{'?', 'K', 0xB7, 0x33, 0x63, 0});
  }

  TEST_CASE("captured records are sent in turn, with the letter that was asked for") {
    UnitOptions options;
    options.capture = {{'S', 1, 2, 3, 0}, {'S', 4, 5, 6, 0}};
    Bench bench(options);
    CHECK(bench.ask("G") == Bytes{'G', 1, 2, 3, 0});
    bench.ask("S");
    CHECK(bench.after(35ms) == Bytes{'S', 4, 5, 6, 0, 'S', 1, 2, 3, 0, 'S', 4, 5, 6, 0});
  }

  TEST_CASE("time stamps of a stream are exactly a period apart") {
    Bench bench;
    bench.ask("d 1\r");
    bench.ask("t 1281 1\r"); // no whole number of nanoseconds
    bench.ask("S");
    std::uint32_t last = 0;
    for (int n = 0; n < 2000; ++n) {
      bench.now = *bench.unit.next_due();
      const Bytes record = bench.after(0s);
      REQUIRE(record.size() == 29);
      std::uint32_t ticks = 0;
      for (unsigned k = 0; k < 4; ++k) {
        if (((record[23] >> k) & 1) == 0) ticks |= std::uint32_t{record[24 + k]} << (8 * k);
      }
      if (n > 0) REQUIRE(ticks - last == 1281);
      last = ticks;
    }
  }

  TEST_CASE("there is a help text, of which only its end is known") {
    const Bytes help = Bench().ask("??");
    CHECK(text_of(help).substr(0, 2) == "??");
    CHECK(std::find(help.begin(), help.end(), 0) == help.end() - 1);
  }

  TEST_CASE("only the third model knows the commands that begin with 1, and echoes them") {
    CHECK(Bench(model(2)).ask("1") == Bytes{'e', '?', 0});
    Bench bench(model(3));
    CHECK(text_of(bench.ask("1eu")) == std::string("1eu\0", 4));
    CHECK(text_of(bench.ask("1dw")) == std::string("1dw\0", 4));
    CHECK(bench.ask(Bytes{'1', 'm', 3}) == Bytes{'1', 'm', 3, 0});
    CHECK(bench.ask(Bytes{'1', 'm', 9}) == Bytes{'e', 'n', 0});
    CHECK(bench.ask(Bytes{'1', 'u', 0}) == Bytes{'e', 'n', 0});
    CHECK(bench.ask("1ex") == Bytes{'e', '?', 0});
    CHECK(bench.ask("1q") == Bytes{'e', '?', 0});
    CHECK(text_of(bench.ask(std::string_view("1E4010111\0", 10))) ==
          std::string("1E4010111\0", 10));
    CHECK(bench.ask("?S").size() == 4);
  }

  TEST_CASE("12-bit records have a time of day, 22 big-endian values and their three-byte end") {
    Bench bench(model(3));
    bench.now = 3661s; // 01:01:01
    bench.ask(Bytes{'1', 'm', 4});
    CHECK(text_of(bench.ask("1S")) == "1S"); // no NUL before the records
    Bytes second;
    for (int part = 0; part < 10; ++part) {
      const Bytes more = bench.after(100ms);
      second.insert(second.end(), more.begin(), more.end());
    }
    REQUIRE(second.size() == 120 * 61);
    CHECK(text_of(Bytes(second.begin(), second.begin() + 14)) == "01:01:01:01:1S");
    CHECK(text_of(Bytes(second.end() - 61, second.end() - 47)) == "01:01:02:01:0S");
    Bench plain(model(3));
    const Bytes coarse = plain.ask("G");
    for (std::size_t n = 0; n < 120; ++n) {
      const auto record = second.begin() + static_cast<std::ptrdiff_t>(61 * n);
      CHECK(Bytes(record + 58, record + 61) == Bytes{'\r', '\n', 0});
      for (int k = 0; k < 22; ++k) {
        const int value = record[14 + 2 * k] * 256 + record[15 + 2 * k];
        REQUIRE(value >= 1);
        REQUIRE(value <= 4095);
        CHECK(std::abs(value / 16 - coarse[static_cast<std::size_t>(1 + k)]) < 12); // at rest
      }
    }
    CHECK(bench.ask("?S").empty());
    CHECK(bench.ask(Bytes{0x03}) == Bytes{0x03});
    CHECK(bench.ask(Bytes{0x03}) == Bytes{0x03, 0}); // there is no such stream any more
    bench.ask("1du");
    bench.ask("1S");
    CHECK(bench.after(1s).empty()); // its USB side is off
  }

  TEST_CASE(
      "12-bit streams count sub-frames from 0, and as a variant from 1 and end answers in NUL") {
    for (const bool hardware : {true, false}) {
      CAPTURE(hardware);
      UnitOptions options = model(3);
      options.hires_terminated = !hardware;
      Bench bench(options);
      bench.ask(Bytes{'1', 'm', 3});
      CHECK(bench.ask("1S") == (hardware ? Bytes{'1', 'S'} : Bytes{'1', 'S', 0}));
      std::string seen;
      const Bytes stream = bench.after(500ms);
      REQUIRE(stream.size() == 45 * 61);
      for (std::size_t n = 0; n < 45; ++n) {
        const char sub_frame = static_cast<char>(stream[61 * n + 12]);
        if (seen.find(sub_frame) == std::string::npos) seen += sub_frame;
      }
      std::sort(seen.begin(), seen.end());
      CHECK(seen == (hardware ? "012" : "123"));
      CHECK(bench.ask(Bytes{0x03}) == (hardware ? Bytes{0x03} : Bytes{0x03, 0}));
      // Streams of 8 bits, which all models have, are not concerned.
      bench.ask("S");
      CHECK(bench.ask(Bytes{0x03}) == Bytes{0x03, 0});
    }
  }
}

} // namespace cyberglove_unit_commands_test
