#include "gloves/monitor_screen.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

namespace monitor_screen_test {

using namespace nendo;
using namespace nendo::gloves;

namespace {

/// A picture of a glove with these sensors.
struct Glove {
  driver::GloveInfo info;
  GloveSample sample;
  SeenCounts seen;
  hand::Calibration calibration = hand::default_calibration();
  MonitorPicture picture;

  explicit Glove(SensorMask sensors = sensors_22) {
    info.source = "serial:/dev/ttyUSB0";
    info.model = "CyberGlove, 22 sensors";
    sample.present = sensors;
    sample.raw.fill(RawCount{100});
    seen.add(sample);
    picture.info = &info;
    picture.sample = &sample;
    picture.seen = &seen;
    picture.calibration = &calibration;
    picture.age_s = 0.011;
    picture.keys = true;
  }
  std::vector<std::string> lines(int columns = 80, int rows = 24) const {
    return monitor_lines(picture, {columns, rows});
  }
};

bool is_printable(const std::string& line) {
  return std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

} // namespace

TEST_SUITE("monitor_screen") {
  TEST_CASE("whatever the window, no line is too long and none too many") {
    for (const std::uint32_t sensors : {0x0U, 0x1U, 0x11U, 0x7BBB3FU, 0x7FFF7FU, 0xFFFFFFU}) {
      Glove glove(SensorMask{sensors});
      glove.info.abilities.light = true;
      glove.picture.stats.bad_records = ~0ULL;
      glove.picture.stats.missed = 123456;
      glove.picture.stats.ring_refused = 1;
      glove.picture.age_s = 1e12;
      for (int columns = 1; columns <= 200; columns += columns < 90 ? 1 : 37) {
        for (const int rows : {1, 2, 3, 5, 13, 14, 23, 24, 25, 60}) {
          const auto lines = glove.lines(columns, rows);
          REQUIRE(static_cast<int>(lines.size()) <= rows);
          for (const auto& line : lines) {
            REQUIRE(static_cast<int>(line.size()) <= columns);
            REQUIRE(is_printable(line));
          }
        }
      }
    }
  }

  TEST_CASE("every sensor is shown, or counted among those that are not") {
    for (const int rows : {3, 5, 12, 13, 14, 24}) {
      for (const int columns : {40, 80}) {
        std::size_t shown = 0;
        int hidden = 0;
        for (const auto& line : Glove().lines(columns, rows)) {
          for (const auto name : sensor_names)
            shown += line.find(std::string(name) + " ") != std::string::npos ? 1U : 0U;
          if (line.starts_with("and ")) hidden = std::stoi(line.substr(4));
        }
        CHECK(shown + static_cast<std::size_t>(hidden) == 22);
      }
    }
  }

  TEST_CASE("the head shows the hand, rate, age, losses, switch and light") {
    Glove glove;
    CHECK(glove.lines()[0].find("serial:/dev/ttyUSB0: CyberGlove, 22 sensors") == 0);
    CHECK(glove.lines()[0].ends_with("right hand"));
    glove.picture.wearer = "anna";
    CHECK(glove.lines()[0].ends_with("right hand of anna"));
    glove.picture.wearer = std::string(200, 'a');
    CHECK(glove.lines()[0].ends_with("aaa~"));
    glove.picture.wearer.clear();
    glove.picture.stats.records = 359;
    CHECK(glove.lines()[1].find("359 delivered, losses on the line unknown") != std::string::npos);
    glove.picture.stats.counts_missed = true;
    CHECK(glove.lines()[1].find("11 ms old, 359 delivered, nothing lost") == 0);
    CHECK(glove.lines()[1].ends_with("q quit, r ranges"));
    glove.sample.wrist_switch = WristSwitch::on;
    glove.sample.side = Side::left;
    glove.info.abilities.light = true;
    glove.picture.stats.rate_hz = 89.96;
    glove.picture.stats.bad_records = 3;
    glove.picture.stats.missed = 4;
    glove.picture.stats.ring_refused = 5;
    glove.picture.stats.silences = 6;
    glove.picture.stats.reopened = 7;
    CHECK(glove.lines()[0].ends_with("left hand, switch on, light off"));
    CHECK(glove.lines(130)[1].find("90.0/s, 11 ms old, 363 sent, 359 delivered, 4 missed, 5 "
                                   "refused, 3 bad, 6 silences, 7 reopened") == 0);
    CHECK(glove.lines(130)[1].ends_with("q quit, r ranges, l light"));
    // Where both do not fit, what was lost matters more than the keys.
    CHECK(glove.lines()[1].find("363 sent, 359 delivered, 4 missed, 5 refused, 3 bad") !=
          std::string::npos);
    glove.picture.light = true;
    glove.picture.age_s = 2.34;
    CHECK(glove.lines()[0].ends_with("light on"));
    CHECK(glove.lines()[1].find("silent for 2.3 s") != std::string::npos);
    glove.picture.sample = nullptr;
    CHECK(glove.lines().size() == 2);
    CHECK(glove.lines()[1].find("no sample yet") != std::string::npos);
  }

  TEST_CASE("an average hand's angles are marked, each of them and the hand, at any size") {
    Glove glove;
    glove.calibration.sensors[0] = {0.01, 100.0 - 78.54};
    for (const int columns : {48, 80, 120}) {
      for (const bool uncalibrated : {false, true}) {
        CAPTURE(columns);
        glove.picture.uncalibrated = uncalibrated;
        int marked = 0, shown = 0;
        for (const auto& line : glove.lines(columns, 30)) {
          if (!line.ends_with(" deg")) continue;
          ++shown;
          if (line.find('~') != std::string::npos) ++marked;
        }
        CHECK(shown == 22);
        CHECK(marked == (uncalibrated ? 22 : 0));
        CHECK(glove.lines(columns, 30)[2].ends_with(uncalibrated ? " ~45 deg" : "  45 deg"));
      }
    }
    CHECK(glove.lines()[0].ends_with("right hand, uncalibrated"));
    glove.calibration.sensors[0] = {0.1, 100.0 + 31.4}; // the longest, of three digits and a sign
    CHECK(glove.lines()[2].size() == 80);
    CHECK(glove.lines()[2].ends_with("~-180 deg"));
  }

  TEST_CASE("a device's text cannot speak to the terminal") {
    Glove glove;
    glove.info.model = "\x1b[2J\x07\r\nCyber\xffGlove";
    CHECK(glove.lines()[0].find("?[2J???Cyber?Glove") != std::string::npos);
  }

  TEST_CASE("a bar has its length, and its marks are where the counts are") {
    CHECK(count_bar(11, 50, {20, 80}, 100) == "##[###--]..");
    CHECK(count_bar(11, 0, {0, 100}, 100) == "[---------]");
    CHECK(count_bar(11, 100, {100, 100}, 100) == "##########|");
    CHECK(count_bar(11, 65535, {0, 65535}, 100) == "[#########]"); // more than the glove said
    CHECK(count_bar(5, 0, {0, 0}, 0) == "|....");
    for (int width = 1; width < 60; ++width) {
      for (std::uint16_t count = 0; count < 256; count = static_cast<std::uint16_t>(count + 5))
        REQUIRE(static_cast<int>(count_bar(width, count, {0, 255}, 255).size()) == width);
    }
  }

  TEST_CASE("what was seen grows with the samples and is forgotten on request") {
    Glove glove(SensorMask{3});
    glove.sample.raw[0] = RawCount{50};
    glove.seen.add(glove.sample);
    glove.sample.raw[0] = RawCount{70};
    glove.seen.add(glove.sample);
    CHECK(glove.seen[Sensor::thumb_roll].least == 50);
    CHECK(glove.seen[Sensor::thumb_roll].most == 100);
    glove.seen.clear();
    glove.seen.add(glove.sample);
    CHECK(glove.seen[Sensor::thumb_roll].least == 70);
    CHECK(glove.seen[Sensor::thumb_roll].most == 70);
  }

  TEST_CASE("angles are in degrees, of calibrated sensors only, and absent from raw pictures") {
    Glove glove(SensorMask{3});
    glove.calibration.sensors[0] = {0.01, 100.0 - 78.54}; // a quarter of a right angle
    glove.calibration.sensors[1] = {};
    CHECK(glove.lines()[2].ends_with(" 45 deg"));
    CHECK(glove.lines()[3].find("deg") == std::string::npos);
    glove.calibration.sensors[0] = {0.005, 101.0}; // -0.3 degrees
    CHECK(glove.lines()[2].ends_with("  0 deg"));
    glove.calibration.sensors[0].gain_rad_per_count = std::nan("");
    CHECK(glove.lines()[2].size() == 80);
    glove.picture.calibration = nullptr;
    CHECK(glove.lines()[2].find("deg") == std::string::npos);
  }
}

} // namespace monitor_screen_test
