// What an emulated FASTRAK sends, byte for byte, as the manual's tables have it. Poses are worked
// out by hand from the description of the motions.

#include "units/fastrak_unit.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/unit_bench.hpp"

namespace fastrak_unit_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::emulator;
using driver::WristMotion;
using fastrak::FastrakUnit;
using fastrak::FastrakUnitOptions;
using nendo::test::Bytes;

namespace {

FastrakUnitOptions with_stations(unsigned count, WristMotion motion = WristMotion::rest) {
  FastrakUnitOptions options;
  for (unsigned k = 0; k < 4; ++k)
    options.plugged[k] = k < count;
  options.motion = motion;
  return options;
}

/// A bench whose line has time to carry the answers.
struct Bench : test::AdvancedBench<FastrakUnit, FastrakUnitOptions> {
  using AdvancedBench::AdvancedBench;
  std::string say(std::string_view text) {
    send(Bytes(text.begin(), text.end()));
    return test::text_of(after(50ms));
  }
  /// Advances to this time since the unit was switched on.
  std::string at(EmulatedUnit::Time time) { return test::text_of(after(1h + time - now)); }
  /// Sends P, and returns what comes.
  std::string poll() { return say("P"); }
};

double float_at(std::string_view bytes, std::size_t at) {
  std::uint32_t bits = 0;
  for (std::size_t k = 0; k < 4; ++k)
    bits |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + k])) << (8 * k);
  return static_cast<double>(std::bit_cast<float>(bits));
}

/// The station of each record of a stream of records of this length.
std::string stations_of(std::string_view stream, std::size_t length) {
  std::string stations;
  for (std::size_t at = 0; at + length <= stream.size(); at += length)
    stations += stream[at + 1];
  return stations;
}

constexpr std::string_view identification = "FASTRAK emulated by Nendo       ";
std::string status(std::string_view flags, std::string_view error, char map) {
  std::string text = "21S";
  text.append(flags).append(error).append(" F3").append(1, map).append("  02.014");
  return text.append(identification).append("\r\n");
}

std::string error(std::string_view command, std::string_view code, std::string_view where) {
  std::string text = "2 E*ERROR*";
  text.append(command).append("*ERROR* EC ").append(code).append(" ").append(where);
  return text.append("\r\n");
}

} // namespace

TEST_SUITE("fastrak_unit") {
  TEST_CASE("it says nothing by itself, and its status has 55 bytes") {
    Bench bench(with_stations(2));
    CHECK(bench.at(10s).empty());
    CHECK_FALSE(bench.unit.next_due());
    CHECK(bench.say("S") == status("3F0", "   ", '3'));
    CHECK(bench.say("fuS") == status("3F3", "   ", '3'));
    CHECK(status("3F3", "   ", '3').size() == 55);
    CHECK(bench.say("UF\rS") == status("3F0", "   ", '3'));
    bench.say("C");
    CHECK(bench.say("S").find(status("3F8", "   ", '3')) != std::string::npos);
  }

  // At 1 s the solution is 3.75 ms old. The receiver is 6 cm behind the wrist and 2.5 cm below, and
  // the tremor of 0.3 mm is at sin(2 pi 8.3 * 0.99625 + 0.7 + 1.3) = -0.521.
  TEST_CASE("a record in text has the station, the error, and fields of seven characters") {
    Bench bench(with_stations(1));
    bench.at(1s);
    CHECK(bench.say("uP") == "01   33.98 -20.00 -12.51   0.00   0.00   0.00\r\n");
    bench.at(2s);
    Bench inches(with_stations(1));
    inches.at(1s);
    CHECK(inches.poll() == "01   13.38  -7.87  -4.92   0.00   0.00   0.00\r\n");
  }

  // After 3.5 s less 3.75 ms the orbit has turned by 30 degrees * 2.99625 = 89.8875 degrees.
  TEST_CASE("each item has its place in the list") {
    struct Case {
      std::string_view items, text;
    };
    for (const Case& c :
         {Case{"0", " "}, Case{"50", " "}, Case{"1", "\r\n"}, Case{"51", "\r\n"},
          Case{"2", "  79.99  -6.06 -12.50"}, Case{"4", "  89.89   0.00   0.00"},
          Case{"5", " 0.0020 1.0000 0.0000"}, Case{"6", "-1.0000 0.0020 0.0000"},
          Case{"7", " 0.0000 0.0000 1.0000"}, Case{"11", " 0.7078 0.0000 0.0000 0.7064"},
          Case{"16", " 0"}, Case{"66", " 0"}, Case{"52", " 7.99882E+01 -6.05889E+00 -1.25000E+01 "},
          Case{"54", " 8.98875E+01  0.00000E+00  0.00000E+00 "},
          Case{"55", " 1.96349E-03  9.99998E-01  0.00000E+00 "},
          Case{"56", "-9.99998E-01  1.96349E-03  0.00000E+00 "},
          Case{"57", " 0.00000E+00  0.00000E+00  1.00000E+00 "},
          Case{"61", " 7.07801E-01  0.00000E+00  0.00000E+00  7.06412E-01 "},
          Case{"16,2,1", " 0  79.99  -6.06 -12.50\r\n"}}) {
      CAPTURE(c.items);
      Bench bench(with_stations(1, WristMotion::orbit));
      bench.send({'u'});
      bench.say("O1," + std::string(c.items) + "\r");
      bench.at(3500ms);
      CHECK(bench.poll() == "01 " + std::string(c.text));
    }
  }

  TEST_CASE("binary items have floats, low byte first, and the same marks") {
    Bench bench(with_stations(1));
    bench.say("ufO1,2,11,1\r");
    bench.at(1s);
    const std::string record = bench.poll();
    REQUIRE(record.size() == 33);
    CHECK(record.substr(0, 3) == "01 ");
    CHECK(float_at(record, 3) == doctest::Approx(33.9844).epsilon(1e-6));
    CHECK(record.substr(7, 4) == std::string("\x00\x00\xA0\xC1", 4)); // -20
    CHECK(float_at(record, 11) == doctest::Approx(-12.50937).epsilon(1e-6));
    CHECK(record.substr(15) == std::string("\x00\x00\x80\x3F", 4) + std::string(12, '\0') + "\r\n");
    for (const auto& [list, bytes] : {std::pair<std::string, std::size_t>{"0", 1},
                                      {"1", 2},
                                      {"2", 12},
                                      {"4", 12},
                                      {"5", 12},
                                      {"6", 12},
                                      {"7", 12},
                                      {"11", 16},
                                      {"16", 2},
                                      {"52", 12},
                                      {"61", 16},
                                      {"66", 2},
                                      {"2,11,0", 29}}) {
      const std::string items = list; // doctest captures no structured binding
      CAPTURE(items);
      bench.say("O1," + items + "\r");
      CHECK(bench.poll().size() == 3 + bytes);
    }
  }

  TEST_CASE("the stations share 120 records per second, in their order") {
    for (unsigned count = 1; count <= 4; ++count) {
      CAPTURE(count);
      Bench bench(with_stations(count));
      bench.say("fC");
      for (unsigned k = 0; k < 4; ++k)
        bench.say("O" + std::to_string(k + 1) + ",2,11,1\r");
      bench.receive();
      const std::string stations = stations_of(test::text_of(bench.after(1s)), 33);
      CHECK(stations.size() == 120);
      for (std::size_t n = 1; n < stations.size(); ++n)
        REQUIRE(stations[n] ==
                (stations[n - 1] == static_cast<char>('0' + count) ? '1' : stations[n - 1] + 1));
      bench.say("c");
      bench.after(1s);
      CHECK(bench.after(10s).empty());
      CHECK_FALSE(bench.unit.next_due());
    }
  }

  TEST_CASE("a record arrives when its last byte has passed the line") {
    Bench bench(with_stations(1));
    bench.say("fO1,2,11,1\r");
    bench.at(1s);
    bench.send({'C'});
    CHECK(bench.at(1s + 8'333'333ns + 2'864'582ns).empty()); // 330 bits at 115200 baud
    CHECK(bench.at(1s + 8'333'333ns + 2'864'583ns).size() == 33);
  }

  TEST_CASE("a line that is too slow costs whole solutions, and the order is kept") {
    struct Case {
      unsigned baud, stations;
      std::string_view set;
      std::size_t length, records;
      std::string_view order;
    };
    for (const Case& c :
         {Case{57600, 1, "F", 47, 120, "1111"}, Case{115200, 1, "FO1,52,61,1\r", 96, 120, "1111"},
          Case{57600, 1, "FO1,52,61,1\r", 96, 60, "1111"},
          Case{57600, 1, "fO1,2,11,1\r", 33, 120, "1111"},
          Case{38400, 1, "fO1,2,11,1\r", 33, 60, "1111"},
          // 8.6 ms a record: station 2 must wait for its next turn, then 1.
          Case{38400, 2, "fO1,2,11,1\rO2,2,11,1\r", 33, 40, "12121"}}) {
      CAPTURE(c.baud);
      CAPTURE(c.set);
      FastrakUnitOptions options = with_stations(c.stations);
      options.baud = c.baud;
      Bench bench(options);
      bench.say(c.set);
      bench.send({'C'});
      std::string stream;
      for (int quarter = 0; quarter < 4; ++quarter)
        stream += test::text_of(bench.after(250ms));
      const std::string stations = stations_of(stream, c.length);
      CHECK(stations.starts_with(c.order));
      CHECK(stations.size() >= c.records - 1);
      CHECK(stations.size() <= c.records);
    }
  }

  TEST_CASE("stations are switched and read back") {
    Bench bench(with_stations(3));
    CHECK(bench.say("l1\r") == "21l1110\r\n");
    CHECK(bench.say("l2,0\rl3\r") == "23l1010\r\n");
    CHECK(bench.say("l4,1\rl4\r") == "24l1010\r\n"); // there is no receiver
    CHECK(stations_of(bench.poll(), 47) == "13");
    CHECK(bench.say("l2,1.0E+00\rl1\r") == "21l1110\r\n");
    CHECK(bench.say("l1,0\rl2,0\rl3,0\rP").empty());
    CHECK(bench.say("C").empty());
  }

  TEST_CASE("the output list is read back in two columns an item") {
    Bench bench(with_stations(1));
    CHECK(bench.say("O1\r") == "21O 2 4 1\r\n");
    CHECK(bench.say("O1,2,11,1\rO1\r") == "21O 211 1\r\n");
    CHECK(bench.say("O4\r") == "24O 2 4 1\r\n");
  }

  TEST_CASE("numbers that are left out keep their values, and all can be read back") {
    Bench bench(with_stations(1));
    CHECK(bench.say("H1\r") == "21H   1.00   0.00   0.00\r\n");
    CHECK(bench.say("H1,,2.5\rH1\r") == "21H   1.00   2.50   0.00\r\n");
    CHECK(bench.say("x0.2,0.2,0.8,0.8\rx,,.9\rx\r") == "2 x   0.20   0.20   0.90   0.80\r\n");
    CHECK(bench.say("v0.1\rv\r") == "2 v   0.10   0.20   0.80   0.80\r\n");
    CHECK(bench.say("uI1,2\rI1\rUI1\r") == "21I   2.00\r\n21I   0.79\r\n");
    CHECK(bench.say("e1,0\re1\ry1\ry\r") == "21e 0\r\n2 y 1\r\n");
    CHECK(bench.say("A1\r").size() == 3 + 9 * 7 + 2);
  }

  TEST_CASE("a wrong command is answered with its code and its place") {
    Bench bench(with_stations(2));
    CHECK(bench.say("?") == error("?", "-99", "*PS 0 *FL 0 *ST 0"));
    CHECK(bench.say("l\r") == error("l", "-1", "*PS 1 *FL 0 *ST 0"));
    CHECK(bench.say("O1,2,,1\r") == error("O1,2,,1", "-1", "*PS 5 *FL 2 *ST 0"));
    CHECK(bench.say("H2,a,0,0\r") == error("H2,a,0,0", "-2", "*PS 3 *FL 1 *ST 1"));
    CHECK(bench.say("Hx,1,0,0\r") == error("Hx,1,0,0", "-2", "*PS 1 *FL 0 *ST 0"));
    CHECK(bench.say("l5,1\r") == error("l5,1", "-3", "*PS 1 *FL 0 *ST 0"));
    CHECK(bench.say("l2,7\r") == error("l2,7", "-3", "*PS 3 *FL 1 *ST 1"));
    CHECK(bench.say("O1,2,18\r") == error("O1,2,18", "-3", "*PS 5 *FL 2 *ST 0"));
    CHECK(bench.say("y3\r") == error("y3", "-3", "*PS 1 *FL 0 *ST 0"));
    CHECK(bench.say("H1,1,0,0,0\r") == error("H1,1,0,0,0", "-5", "*PS 9 *FL 4 *ST 0"));
    CHECK(bench.say("H1,nan,0,0\r") == error("H1,nan,0,0", "-2", "*PS 3 *FL 1 *ST 0"));
    std::string many = "O1";
    for (int k = 0; k < 33; ++k)
      many += ",0";
    CHECK(bench.say(many + "\r") == error(many, "-5", "*PS 67 *FL 33 *ST 0"));
    CHECK(bench.say("O1,61,61,61,61,61\r") == // 3 + 5 * 52 bytes
          error("O1,61,61,61,61,61", "-5", "*PS 15 *FL 5 *ST 0"));
    CHECK(bench.say("O1\rH1\r") == "21O 2 4 1\r\n21H   1.00   0.00   0.00\r\n");
    CHECK(bench.say("l" + std::string(1000, '1') + "\rl1\r").find("*ERROR* EC -5 *PS 160") !=
          std::string::npos);
  }

  // The receiver goes from x = 24 cm to -36 cm and back in 4 s, at y = -25 cm.
  TEST_CASE("a receiver that crosses the hemisphere appears at -p, unless it is tracked") {
    for (const std::string set : {"", "H1,0,0,0\r", "H1,-1,0,0\r", "H1,0,-1,0\r"}) {
      CAPTURE(set);
      Bench bench(with_stations(1, WristMotion::cross));
      bench.say("ufO1,2,11,1\r" + set);
      unsigned crossed = 0;
      for (auto time = 500ms; time < 6s; time += 100ms) {
        bench.at(time);
        const std::string record = bench.poll();
        REQUIRE(record.size() == 33);
        const double x = float_at(record, 3);
        const double y = float_at(record, 7);
        if (set.empty()) CHECK(x >= 0.0);
        if (set == "H1,-1,0,0\r") CHECK(x <= 0.0);
        if (set == "H1,0,0,0\r" || set == "H1,0,-1,0\r") CHECK(y == doctest::Approx(-25.0));
        CHECK(std::abs(y) == doctest::Approx(25.0));
        if (y > 0.0) ++crossed;
        CHECK(float_at(record, 15) == 1.0); // the attitude stays
      }
      const bool crosses = set.empty() || set == "H1,-1,0,0\r";
      CHECK((crossed > 10) == crosses);
    }
  }

  TEST_CASE("a tracked hemisphere keeps the side on which it began") {
    Bench bench(with_stations(1));
    bench.say("uO1,2\rH1,-1,0,0\r");
    CHECK(bench.poll().substr(10, 7) == "  20.00");
    bench.say("H1,0,0,0\r");
    CHECK(bench.poll().substr(10, 7) == "  20.00");
  }

  TEST_CASE("the frames of alignment, mounting, boresight and tip") {
    Bench bench(with_stations(1));
    const auto numbers = [&](std::string_view set) {
      bench.say(set);
      const std::string text = bench.poll();
      REQUIRE(text.size() == 3 + 42);
      std::vector<double> values;
      for (std::size_t k = 0; k < 6; ++k)
        values.push_back(std::stod(text.substr(3 + 7 * k, 7)));
      return values;
    };
    const auto is = [](const std::vector<double>& got, const std::vector<double>& wanted) {
      for (std::size_t k = 0; k < 6; ++k) {
        CAPTURE(k);
        CHECK(std::abs(got[k] - wanted[k]) < 0.06); // tremor and two decimals
      }
    };
    is(numbers("uO1,2,4\r"), {34, -20, -12.5, 0, 0, 0});
    // The origin at (10, 20, 0), the new x along the old y, the new y against the old x.
    is(numbers("A1,10,20,0,10,50,0,-20,20,0\r"), {-40, -24, -12.5, -90, 0, 0});
    is(numbers("R1\r"), {34, -20, -12.5, 0, 0, 0});
    is(numbers("r1,90,0,0\r"), {20, 34, -12.5, 90, 0, 0});
    is(numbers("B1\r"), {20, 34, -12.5, 0, 0, 0});
    is(numbers("G1,10,20,30\r"), {20, 34, -12.5, 0, 0, 0});
    is(numbers("B1\r"), {20, 34, -12.5, 10, 20, 30});
    is(numbers("b1\r"), {20, 34, -12.5, 90, 0, 0});
    is(numbers("N1,1,2,3\r"), {18, 35, -9.5, 90, 0, 0});
    is(numbers("N1,0,0,0\rr1,0\r"), {34, -20, -12.5, 0, 0, 0});
  }

  TEST_CASE("with an increment only a movement makes a record") {
    Bench still(with_stations(1));
    still.say("uI1,1\r");
    still.send({'C'});
    CHECK(still.after(1s).size() == 47); // the first one
    Bench moving(with_stations(1, WristMotion::orbit));
    moving.at(5s);
    moving.say("uI1,1\r");
    moving.send({'C'});
    // 16 cm/s and more: 0.3 m, and the 6 cm on the forearm, at 30 degrees per second.
    const std::size_t records = moving.after(2s).size() / 47;
    CHECK(records >= 28);
    CHECK(records <= 33);
    CHECK(moving.say("I1,0\r").size() > 4 * 47);
  }

  TEST_CASE("the stylus' button is an item, and without e1,0 it starts and stops the stream") {
    Bench bench(with_stations(2));
    bench.say("O1,16,1\rO2,16,1\r");
    bench.unit.inject({Incident::Kind::switch_on}, bench.now);
    CHECK(bench.after(100ms).size() > 50);
    bench.unit.inject({Incident::Kind::switch_off}, bench.now);
    CHECK(bench.after(100ms).size() > 50);
    bench.unit.inject({Incident::Kind::switch_on}, bench.now);
    bench.after(100ms);
    CHECK(bench.after(100ms).empty());
    CHECK(bench.poll() == "01  1\r\n02  0\r\n");
    bench.unit.inject({Incident::Kind::switch_off}, bench.now);
    CHECK(bench.poll() == "01  0\r\n02  0\r\n");
    bench.say("e1,0\r");
    bench.unit.inject({Incident::Kind::switch_on}, bench.now);
    CHECK(bench.after(100ms).empty());
  }

  TEST_CASE("an error letter stays until the test, and receivers without a signal cause one") {
    Bench bench(with_stations(2));
    bench.say("O1,1\rO2,1\r");
    CHECK(bench.say("T") == "2 T000 PASSED\r\n");
    Incident incident{Incident::Kind::tracker_error};
    incident.letter = 'x';
    incident.station = 2;
    bench.unit.inject(incident, bench.now);
    CHECK(bench.say("PPS") == "01 \r\n02x\r\n01 \r\n02x\r\n" + status("3F0", "x  ", '3'));
    CHECK(bench.say("TP") == "2 T001 CLEARED 2x\r\n01 \r\n02 \r\n");
    incident.station = 0;
    bench.unit.inject(incident, bench.now);
    CHECK(bench.say("PT") == "01x\r\n02x\r\n2 T001 CLEARED 1x 2x\r\n");
    bench.say("C");
    bench.unit.inject({Incident::Kind::glove_out}, bench.now);
    bench.after(100ms);
    CHECK(bench.say("").find("02k") != std::string::npos);
    bench.unit.inject({Incident::Kind::glove_in}, bench.now);
    bench.say("T");
    bench.after(100ms);
    CHECK(bench.say("").find("02 ") != std::string::npos);
    bench.say("y2\r");
    bench.after(100ms);
    CHECK(bench.say("").find("01v") != std::string::npos);
  }

  TEST_CASE("^Y takes a while, and only what ^K has written outlasts it") {
    FastrakUnitOptions options = with_stations(1);
    options.restart_s = 10.0;
    Bench bench(options);
    bench.say("ufO1,0\ry1\r\x0B");
    bench.say("O1,1\rUFCl1,0\r");
    CHECK(bench.say("\x19S").empty());
    bench.after(9s);
    CHECK(bench.say("S").empty());
    bench.after(1s);
    CHECK(bench.say("S") == status("3F3", "   ", '1'));
    CHECK(bench.say("O1\rl1\ry\r") == "21O 0\r\n21l1000\r\n2 y 0\r\n");
    CHECK(bench.say("WSO1\r") == status("3F0", "   ", '1') + "21O 2 4 1\r\n");
    bench.unit.inject({Incident::Kind::power_cycle}, bench.now);
    bench.after(11s);
    CHECK(bench.say("S") == status("3F3", "   ", '1'));
  }

  TEST_CASE("the line stops at XOFF, and continues at XON") {
    Bench bench(with_stations(1));
    CHECK(bench.say("\x13S").empty());
    CHECK(bench.say("\x11") == status("3F0", "   ", '1'));
    bench.say("C\x13");
    bench.after(1s);
    CHECK(bench.after(1s).empty());
    CHECK(bench.say("\x11").size() >= 2 * 47);
  }

  TEST_CASE("noise has the size that the maker states, and none is there by default") {
    FastrakUnitOptions options = with_stations(1, WristMotion::orbit);
    options.noise = true;
    Bench noisy(options);
    options.noise = false;
    Bench exact(options);
    double squares_cm = 0.0;
    double squares_deg = 0.0;
    constexpr int records = 2000;
    for (Bench* bench : {&noisy, &exact})
      bench->say("ufO1,2,4,1\r");
    for (int n = 0; n < records; ++n) {
      const std::string a = noisy.poll();
      const std::string b = exact.poll();
      for (std::size_t k = 0; k < 3; ++k)
        squares_cm += std::pow(float_at(a, 3 + 4 * k) - float_at(b, 3 + 4 * k), 2);
      const double degrees =
          std::remainder(float_at(a, 15) - float_at(b, 15), 360.0); // azimuth's noise is that of z
      squares_deg += degrees * degrees;
    }
    CHECK(std::sqrt(squares_cm / (3 * records)) == doctest::Approx(0.08).epsilon(0.05));
    CHECK(std::sqrt(squares_deg / records) == doctest::Approx(0.15).epsilon(0.06));
  }

  TEST_CASE("any bytes are survived, and what no host reads is refused and counted") {
    Bench bench(with_stations(4));
    std::mt19937 random(7);
    constexpr std::string_view commands = "PCcFfUuSlOHxveARBbGrNIyT0123456789,,..\r\r\r";
    const Bytes likely(commands.begin(), commands.end());
    for (int turn = 0; turn < 20'000; ++turn) {
      Bytes bytes(random() % 40);
      for (std::uint8_t& byte : bytes)
        byte = static_cast<std::uint8_t>(random() % 8 == 0 ? random()
                                                           : likely[random() % likely.size()]);
      bench.send(bytes);
      CHECK(bench.after(10ms).size() <= EmulatedUnit::output_capacity);
    }
    Bench unread(with_stations(1));
    unread.say("C");
    const std::size_t kept = unread.after(1min).size();
    CHECK(kept <= EmulatedUnit::output_capacity);
    CHECK(unread.unit.counters().bytes_refused > 7000 * 47 - kept);
  }
}

} // namespace fastrak_unit_test
