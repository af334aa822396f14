#include <nendo/hand/calibration_exchange.hpp>

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/joint_angles.hpp>

#include "support/random_calibration.hpp"

namespace calibration_exchange_test {

using namespace nendo;
using namespace nendo::hand;

namespace {

struct Row {
  int offset;
  double gain;
};
using Rows = std::array<Row, 24>;

/// Of a wearer: every gain and offset its own; slots 7 and 11 as VirtualHand has them.
Rows typical_rows() {
  Rows rows{};
  for (std::size_t slot = 0; slot < rows.size(); ++slot)
    rows[slot] = {40 + 5 * static_cast<int>(slot), 0.008 + 0.0002 * static_cast<double>(slot)};
  rows[11].gain = 0.25;
  rows[23] = {0, 0.0};
  return rows;
}

enum class Columns { wide, blank, tab };

std::string row_text(const Rows& rows, std::size_t slot, Columns columns) {
  char text[80];
  const int joint = static_cast<int>(slot % 4);
  const auto [offset, gain] = rows[slot];
  if (columns == Columns::wide) {
    std::snprintf(text, sizeof text, "%3d%6d%10.5f    0\n", joint, offset, gain);
  } else if (columns == Columns::tab) {
    std::snprintf(text, sizeof text, "%d\t%d\t%f\t0\n", joint, offset, gain);
  } else {
    std::snprintf(text, sizeof text, "%d %d %f 0\r\n", joint, offset, gain);
  }
  return text;
}

/// As VTI's library writes it, with the hand's geometry after it.
std::string vti_text(const Rows& rows) {
  std::string text = "VHv2.0\n! a comment\nGLOVE CALIBRATION follows:\n"
                     "! joint, offset, gain, gesture\n";
  for (std::size_t slot = 0; slot < rows.size(); ++slot) {
    if (slot % 4 == 0) text += "FINGER " + std::to_string(slot / 4) + ":\n";
    text += row_text(rows, slot, Columns::wide);
  }
  return text + "! E_O_CAL\nRIGHT HAND\n 1.0 2.0 3.0 4 5\n 9 9 9\n! E_O_GEO\n";
}

/// As the Device Configuration Utility does.
std::string dcu_text(const Rows& rows) {
  std::string text = "Calibration of a glove\r\n";
  for (std::size_t slot = 0; slot < rows.size(); ++slot) {
    if (slot % 4 == 0) text += "Thumb or other\r\n";
    text += row_text(rows, slot, Columns::blank);
  }
  return text;
}

/// As MotorControl does.
std::string motor_control_text(const Rows& rows) {
  std::string text;
  for (std::size_t slot = 0; slot < rows.size(); ++slot)
    text += row_text(rows, slot, Columns::tab);
  return text;
}

std::string replaced(std::string text, const std::string& what, const std::string& instead) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), instead);
}

void is_refused(const Result<ImportedCalibration>& result, const std::string& place,
                const std::string& about) {
  CAPTURE(about);
  REQUIRE_FALSE(result);
  CAPTURE(result.error().message);
  CHECK(result.error().code == Errc::bad_input);
  CHECK(result.error().message.starts_with(place));
  CHECK(result.error().message.find(about) != std::string::npos);
  CHECK(result.error().message.find('\n') == std::string::npos);
}

std::string stored(const std::string& name) {
  const auto path = std::filesystem::path(NENDO_CALIBRATIONS) / name;
  std::ifstream file(path, std::ios::binary);
  REQUIRE(file);
  return {std::istreambuf_iterator<char>(file), {}};
}

} // namespace

TEST_SUITE("calibration exchange") {
  TEST_CASE("all three dialects of .cal say the same") {
    const Rows rows = typical_rows();
    for (const auto& text : {vti_text(rows), dcu_text(rows), motor_control_text(rows)}) {
      CAPTURE(text);
      CHECK(format_of(text) == CalibrationFormat::virtualhand);
      const auto read = parse_virtualhand(text, "x.cal");
      REQUIRE(read);
      for (std::size_t slot = 0; slot < rows.size(); ++slot) {
        const auto& line = read->calibration.sensors[slot];
        const bool real = slot != 7 && slot != 23;
        const double gain = slot == 11 ? rows[7].gain : rows[slot].gain;
        CHECK(line.gain_rad_per_count == doctest::Approx(real ? gain : 0.0).epsilon(1e-3));
        CHECK(line.offset_counts == (real ? rows[slot].offset : 0));
      }
      CHECK(read->calibration.middle_bias == doctest::Approx(0.25));
    }
    CHECK(parse_virtualhand(vti_text(rows), "x.cal")->side == Side::right);
    CHECK_FALSE(parse_virtualhand(dcu_text(rows), "x.cal")->side.has_value());
  }

  TEST_CASE("the fingers spread as the vendor's library spreads them") {
    Rows rows = typical_rows();
    for (const std::size_t slot : {std::size_t{7}, std::size_t{15}, std::size_t{19}})
      rows[slot].gain = 0.001 + 0.0001 * static_cast<double>(slot);
    const auto read = parse_virtualhand(vti_text(rows), "x.cal");
    REQUIRE(read);
    GloveSample sample;
    sample.present = sensors_22;
    sample.raw[11].value = 140;
    sample.raw[15].value = 165;
    sample.raw[19].value = 170;
    // Its frame turns towards the little finger by negative angles.
    const double index = (140 - rows[11].offset) * rows[7].gain;
    double ring = -rows[15].gain * (165 - rows[15].offset);
    double little = -rows[19].gain * (170 - rows[19].offset);
    const double middle = -(ring + index) * rows[11].gain;
    ring += middle;
    little += ring;
    const auto angles = joint_angles(sample, read->calibration);
    CHECK(angles[Finger::index].mcp_abduction_rad == doctest::Approx(index + middle));
    CHECK(angles[Finger::middle].mcp_abduction_rad == doctest::Approx(middle));
    CHECK(angles[Finger::ring].mcp_abduction_rad == doctest::Approx(ring));
    CHECK(angles[Finger::little].mcp_abduction_rad == doctest::Approx(little));
    CHECK(middle != 0.0);
  }

  TEST_CASE("a row of slot 7 that another program filled by habit does not replace a real gain") {
    Rows rows = typical_rows();
    rows[7] = {100, 0.01};
    rows[11].gain = 0.0071;
    for (const auto& text : {dcu_text(rows), motor_control_text(rows)}) {
      const auto read = parse_virtualhand(text, "x.cal");
      REQUIRE(read);
      CHECK(read->calibration[Sensor::index_middle_abduction].gain_rad_per_count ==
            doctest::Approx(0.0071));
      CHECK(read->calibration.middle_bias == 0.0);
    }
    // VirtualHand's own files always mean it.
    const auto vti = parse_virtualhand(vti_text(rows), "x.cal");
    REQUIRE(vti);
    CHECK(vti->calibration[Sensor::index_middle_abduction].gain_rad_per_count ==
          doctest::Approx(0.01));
    // Without it, the gain is where it seems to be.
    rows[7].gain = 0.0;
    CHECK(parse_virtualhand(vti_text(rows), "x.cal")
              ->calibration[Sensor::index_middle_abduction]
              .gain_rad_per_count == doctest::Approx(0.0071));
  }

  TEST_CASE("a text in the other frame gives the same calibration, and says so") {
    Rows rows = typical_rows();
    const auto straight = parse_virtualhand(vti_text(rows), "x.cal");
    for (auto& row : rows)
      row.gain = -row.gain;
    rows[11].gain = -rows[11].gain; // no gain
    const auto turned = parse_virtualhand(vti_text(rows), "x.cal");
    REQUIRE(straight);
    REQUIRE(turned);
    CHECK(nendo::test::same_bits(straight->calibration, turned->calibration));
    CHECK(turned->notes.size() == straight->notes.size() + 2);
  }

  TEST_CASE("a .cal file that is not right is refused in one line") {
    const Rows rows = typical_rows();
    const std::string text = vti_text(rows);
    const auto spoilt = [&](std::size_t slot, Row row) {
      Rows changed = rows;
      changed[slot] = row;
      return parse_virtualhand(vti_text(changed), "x.cal");
    };
    is_refused(parse_virtualhand("", "x.cal"), "x.cal:", "0 of 24");
    is_refused(parse_virtualhand(text.substr(0, text.find("FINGER 5")), "x.cal"),
               "x.cal:", "20 of 24");
    is_refused(parse_virtualhand(replaced(text, "VHv2", "VHv9"), "x.cal"), "x.cal:1:", "VHv9");
    is_refused(parse_virtualhand(replaced(text, "FINGER 1", "FINGER 2"), "x.cal"),
               "x.cal:10:", "FINGER 2");
    is_refused(parse_virtualhand(replaced(text, "  1    45", "  2    45"), "x.cal"),
               "x.cal:7:", "thumb_mcp");
    is_refused(parse_virtualhand(replaced(text, "  1    45   0.00820    0\n", ""), "x.cal"),
               "x.cal:7:", "order");
    is_refused(parse_virtualhand(replaced(text, "0.00820", "o.00820"), "x.cal"),
               "x.cal:7:", "o.00820");
    is_refused(parse_virtualhand(replaced(text, "0.00820    0", ""), "x.cal"),
               "x.cal:7:", "cut short");
    is_refused(parse_virtualhand(replaced(text, "0.00820", "nan"), "x.cal"), "x.cal:7:", "nan");
    is_refused(spoilt(1, {45, 0.0}), "x.cal:7:", "thumb_mcp");
    is_refused(spoilt(1, {45, -0.01}), "x.cal:7:", "sign");
    is_refused(spoilt(1, {45, 1.5}), "x.cal:7:", "absurd");
    is_refused(spoilt(1, {256, 0.01}), "x.cal:7:", "256");
    is_refused(spoilt(1, {-1, 0.01}), "x.cal:7:", "-1");
    is_refused(spoilt(11, {95, 100.0}), "x.cal:", "middle_bias");
    // An 18-sensor glove has no DIP sensors.
    REQUIRE(spoilt(6, {50, 0.0}));
    CHECK(spoilt(6, {50, 0.0})->calibration[Sensor::index_dip].gain_rad_per_count == 0.0);
  }

  TEST_CASE("what is exported as .cal reads back to half a count and five decimals") {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> gain(0.004, 0.03);
    std::uniform_real_distribution<double> offset(0.0, 255.0);
    for (int turn = 0; turn < 200; ++turn) {
      Calibration calibration;
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        if (sensors_22.has(static_cast<Sensor>(slot)))
          calibration.sensors[slot] = {gain(random), offset(random)};
      }
      calibration.middle_bias = 10.0 * gain(random);
      const auto written = virtualhand_text(calibration, {});
      REQUIRE(written);
      const auto read = parse_virtualhand(written->text, "x.cal");
      if (!read) FAIL(read.error().message);
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        const auto& was = calibration.sensors[slot];
        const auto& is = read->calibration.sensors[slot];
        CHECK(std::abs(is.gain_rad_per_count - was.gain_rad_per_count) <= 0.5e-5 + 1e-12);
        CHECK(std::abs(is.offset_counts - was.offset_counts) <= 0.5);
      }
      CHECK(std::abs(read->calibration.middle_bias - calibration.middle_bias) <= 0.5e-5 + 1e-12);
      std::istringstream lines(written->text);
      for (std::string line; std::getline(lines, line);)
        REQUIRE(line.size() <= 80); // the vendor's reader takes no longer ones
    }
  }

  TEST_CASE("rows of an exported .cal are in the vendor's columns") {
    Calibration calibration = default_calibration();
    calibration[Sensor::thumb_roll] = {0.0105, 90.0};
    const auto written = virtualhand_text(calibration, {});
    REQUIRE(written);
    CHECK(written->text.starts_with("VHv"));
    CHECK(written->text.find("\nFINGER 0:\n  0    90   0.01050    0\n") != std::string::npos);
    CHECK(written->text.ends_with("! E_O_CAL\n"));
    CHECK(written->notes.empty());
  }

  TEST_CASE("what a .cal file cannot hold is refused or reported") {
    Calibration calibration = default_calibration();
    calibration.coupling_gains[0] = 0.1;
    calibration[Sensor::index_mcp].offset_counts = 60.4;
    const auto lossy = virtualhand_text(calibration, {});
    REQUIRE(lossy);
    CHECK(lossy->notes.size() == 2);
    calibration[Sensor::index_mcp].offset_counts = 256.0;
    CHECK_FALSE(virtualhand_text(calibration, {}));
    calibration[Sensor::index_mcp].offset_counts = -0.6;
    CHECK_FALSE(virtualhand_text(calibration, {}));
    calibration[Sensor::index_mcp] = {};
    CHECK_FALSE(virtualhand_text(calibration, {}));
    calibration[Sensor::index_mcp] = {1e-7, 60.0};
    CHECK_FALSE(virtualhand_text(calibration, {}));
    calibration[Sensor::index_mcp] = {std::nan(""), 60.0};
    CHECK_FALSE(virtualhand_text(calibration, {}));
    CHECK_FALSE(virtualhand_text(default_calibration({1000, true}), {1000, true}));
    // A finer converter's counts are written in 8 bits.
    const auto fine = virtualhand_text(default_calibration({4080, false}), {4080, false});
    REQUIRE(fine);
    CHECK(fine->text == virtualhand_text(default_calibration(), {})->text);
  }

  TEST_CASE("KIT's gloves have angles of 0 beyond the counts, and an export as .cal says which") {
    // Where the lines through the two points of thumb_abduction, the files' third, cross 0: left
    // -0.5:164 and -0.2:48, so at 48 - 0.2 * 116 / 0.3; right -0.5:216 and -0.2:79.
    for (const auto& [name, at] :
         {std::pair{"kit_left.cal", "(-29.3)"}, {"kit_right.cal", "(-12.3)"}}) {
      const auto read = parse_two_point(stored(name), name);
      REQUIRE(read);
      const auto written = virtualhand_text(read->calibration, {});
      REQUIRE_FALSE(written);
      const std::string& why = written.error().message;
      CAPTURE(why);
      CHECK(why.find(std::string("thumb_abduction ") + at) != std::string::npos);
      CHECK(why.find("0 to 255") != std::string::npos);
      CHECK(why.find("toml or csv") != std::string::npos);
      CHECK(why.find("index_mcp") == std::string::npos); // 71 and 117 fit
      CHECK(calibration_csv_text(read->calibration));
    }
    // All of them are named, not the first alone.
    Calibration calibration = default_calibration();
    calibration[Sensor::index_mcp].offset_counts = 300.25;
    calibration[Sensor::wrist_yaw].offset_counts = -0.6;
    const auto two = virtualhand_text(calibration, {});
    REQUIRE_FALSE(two);
    CHECK(two.error().message.find("index_mcp (300.2), wrist_yaw (-0.6)") != std::string::npos);
    calibration[Sensor::index_mcp].offset_counts = 255.4; // as a whole count it fits
    calibration[Sensor::wrist_yaw].offset_counts = -0.4;
    CHECK(virtualhand_text(calibration, {}));
  }

  TEST_CASE("each line of a two-point file goes through both of its points") {
    // The order and signs of its hand model, from the names that its header gives the places.
    const std::vector<std::pair<std::string, double>> places{
        {"wrist_yaw", -1},       {"wrist_pitch", -1},
        {"thumb_abduction", -1}, {"thumb_roll", -1},
        {"thumb_mcp", -1},       {"thumb_ip", -1},
        {"index_mcp", -1},       {"index_middle_abduction", -1},
        {"index_pip", -1},       {"index_dip", -1},
        {"middle_mcp", -1},      {"palm_arch", 0},
        {"middle_pip", -1},      {"middle_dip", -1},
        {"ring_mcp", -1},        {"middle_ring_abduction", 1},
        {"ring_pip", -1},        {"ring_dip", -1},
        {"little_mcp", -1},      {"ring_little_abduction", 1},
        {"little_pip", -1},      {"little_dip", -1}};
    for (const auto* name : {"kit_left.cal", "kit_right.cal"}) {
      const std::string text = stored(name);
      CHECK(format_of(text) == CalibrationFormat::two_point);
      const auto read = parse_two_point(text, name);
      if (!read) FAIL(read.error().message);
      std::istringstream lines(text);
      std::string line;
      for (const auto& place : places) {
        const std::string& sensor = place.first;
        const double sign = place.second;
        REQUIRE(std::getline(lines, line));
        std::array<double, 4> n{};
        REQUIRE(std::sscanf(line.c_str(), "%lf:%lf %lf:%lf", &n[0], &n[1], &n[2], &n[3]) == 4);
        for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
          if (sensor_names[slot] != sensor || sign == 0.0) continue;
          CAPTURE(sensor);
          const auto& calibrated = read->calibration.sensors[slot];
          for (const std::size_t point : {std::size_t{0}, std::size_t{2}}) {
            const RawCount count{static_cast<std::uint16_t>(n[point + 1])};
            CHECK(calibrated.angle_rad(count) == doctest::Approx(sign * n[point]));
          }
        }
      }
      CHECK(read->calibration[Sensor::palm_arch].gain_rad_per_count == 0.0);
    }
  }

  TEST_CASE("a two-point file that is not right is refused in one line") {
    const std::string text = stored("kit_right.cal");
    const std::string first = text.substr(0, text.find('\n') + 1);
    is_refused(parse_two_point("", "x"), "x:", "0 of 22");
    is_refused(parse_two_point(text.substr(0, text.rfind("\n", text.size() - 2)), "x"),
               "x:", "21 of 22");
    is_refused(parse_two_point(text + first, "x"), "x:23:", "22");
    is_refused(parse_two_point(replaced(text, first, "0.1:10\n"), "x"), "x:1:", "wrist_yaw");
    is_refused(parse_two_point(replaced(text, first, "0.1:10 x:20\n"), "x"), "x:1:", "wrist_yaw");
    is_refused(parse_two_point(replaced(text, first, "0.1:10 nan:20\n"), "x"), "x:1:", "wrist_yaw");
    is_refused(parse_two_point(replaced(text, first, "0.1:10 0.2:256\n"), "x"),
               "x:1:", "wrist_yaw");
    is_refused(parse_two_point(replaced(text, first, "0.1:10 0.2:10\n"), "x"), "x:1:", "one count");
    is_refused(parse_two_point(replaced(text, first, "0.1:10 0.1:20\n"), "x"), "x:1:", "one angle");
  }

  TEST_CASE("a CSV file gives back what it was given, to the last bit") {
    std::mt19937_64 random(5);
    for (int turn = 0; turn < 500; ++turn) {
      auto wearer = nendo::test::random_calibration(random);
      Calibration calibration = default_calibration();
      if (wearer.counts.max_count <= 255) calibration = wearer.calibration;
      calibration.coupling_gains.fill(0.0);
      calibration.middle_bias = 0.0;
      for (auto& line : calibration.sensors) {
        if (line.gain_rad_per_count == 0.0) continue;
        line.gain_rad_per_count = std::min(line.gain_rad_per_count, 1.0);
        line.offset_counts += nendo::test::random_number(random, 50.0);
      }
      calibration[Sensor::index_mcp] = {0.011, 61.0};
      const auto written = calibration_csv_text(calibration);
      REQUIRE(written);
      CHECK(written->notes.empty());
      CHECK(format_of(written->text) == CalibrationFormat::csv);
      const auto read = parse_calibration_csv(written->text, "x.csv");
      if (!read) FAIL(read.error().message);
      REQUIRE(nendo::test::same_bits(read->calibration, calibration));
    }
    Calibration lossy = default_calibration();
    lossy.coupling_gains[1] = 0.5;
    lossy.middle_bias = 0.5;
    CHECK(calibration_csv_text(lossy)->notes.size() == 2);
  }

  TEST_CASE("a CSV file that is not right is refused in one line") {
    const std::string head = "# by hand\nsensor,gain_rad_per_count,offset_counts\n";
    const auto read = [&](const std::string& text) { return parse_calibration_csv(text, "x.csv"); };
    REQUIRE(read(head + " index_mcp , 0.0125 , 60 \r\n"));
    const auto same = read(head + "index_mcp,0.0125,60\n");
    for (const std::string text : {"Sensor;Gain_rad_per_count;Offset_counts\nIndex MCP;0,0125;60\n",
                                   "offset_counts\tnote\tgain_deg_per_count\tsensor\n60\tx\t0."
                                   "716197243913529\tindex_mcp\n"}) {
      CHECK(format_of(text) == CalibrationFormat::csv);
      const auto other = read(text);
      if (!other) FAIL(other.error().message);
      CHECK(other->calibration[Sensor::index_mcp].gain_rad_per_count ==
            doctest::Approx(same->calibration[Sensor::index_mcp].gain_rad_per_count));
      CHECK(other->calibration[Sensor::index_mcp].offset_counts == 60.0);
      CHECK(other->notes.size() == (text.find("note") == std::string::npos ? 0U : 1U));
    }
    is_refused(read(""), "x.csv:", "name the columns");
    is_refused(read("gain,sensor\n"), "x.csv:1:", "header");
    is_refused(read(head), "x.csv:2:", "no sensors");
    is_refused(read(head + "index_mcp,0.0125\n"), "x.csv:3:", "has 2 cells");
    is_refused(read(head + "index_mcp,0.0125,60,1\n"), "x.csv:3:", "has 4 cells");
    is_refused(read(head + "index,0.0125,60\n"), "x.csv:3:", "index");
    is_refused(read(head + "index_mcp,,60\n"), "x.csv:3:", "index_mcp");
    is_refused(read(head + "index_mcp,inf,60\n"), "x.csv:3:", "index_mcp");
    is_refused(read(head + "index_mcp,0,60\n"), "x.csv:3:", "gain of 0");
    is_refused(read(head + "index_mcp,0.01,60\nindex_pip,-0.01,60\n"), "x.csv:4:", "sign");
    is_refused(read(head + "index_mcp,2,60\n"), "x.csv:3:", "absurd");
    is_refused(read(head + "index_mcp,0.01,1e99\n"), "x.csv:3:", "offset");
    is_refused(read(head + "index_mcp,0.01,60\nindex_mcp,0.01,60\n"), "x.csv:4:", "twice");
  }

  TEST_CASE("formats are distinguished by their content") {
    CHECK(format_of("") == CalibrationFormat::virtualhand);
    CHECK(format_of("# x\n\nversion = 1\n") == CalibrationFormat::toml);
    CHECK(format_of("user = \"a\"\nversion = 1\n") == CalibrationFormat::toml);
    CHECK(format_of("0:1 2:3\n") == CalibrationFormat::two_point);
    CHECK(format_of("VHv2.0\n") == CalibrationFormat::virtualhand);
  }
}

} // namespace calibration_exchange_test
