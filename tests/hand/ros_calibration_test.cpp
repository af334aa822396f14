#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/base/units.hpp>
#include <nendo/hand/calibration_exchange.hpp>

#include "support/random_calibration.hpp"

namespace ros_calibration_test {

using namespace nendo;
using namespace nendo::hand;

namespace {

struct Point {
  double raw;
  double deg;
};
struct Joint {
  std::string name;
  std::vector<Point> points;
};

std::string yaml_of(const std::vector<Joint>& joints) {
  std::string text = "{'cyberglove_calibration': [\n";
  for (const Joint& joint : joints) {
    text += "['" + joint.name + "', [";
    for (const Point& point : joint.points)
      text += "[" + std::to_string(point.raw) + ", " + std::to_string(point.deg) + "],";
    text.back() = ']';
    text += "],\n";
  }
  return text + "]}\n";
}

std::string xml_of(const std::vector<Joint>& joints) {
  std::string text = "<?xml version=\"1.0\" ?>\n<!-- by hand -->\n<Cyberglove_calibration>\n";
  for (const Joint& joint : joints) {
    text += "<Joint name=\"" + joint.name + "\">\n";
    for (const Point& point : joint.points)
      text += "  <calib raw_value=\"" + std::to_string(point.raw) + "\" calibrated_value=\"" +
              std::to_string(point.deg) + "\"/>\n";
    text += "</Joint>\n";
  }
  return text + "</Cyberglove_calibration>\n";
}

/// The count that a driver makes `raw` of, by its own words: (count - 1) / 254.
double angle_deg_at(const ImportedCalibration& read, Sensor sensor, double raw) {
  const auto& line = read.calibration[sensor];
  return to_degrees(line.gain_rad_per_count * (1.0 + 254.0 * raw - line.offset_counts));
}

bool any_note_has(const ImportedCalibration& read, const std::string& what) {
  return std::any_of(read.notes.begin(), read.notes.end(),
                     [&](const std::string& note) { return note.find(what) != std::string::npos; });
}

ImportedCalibration required(const Result<ImportedCalibration>& read) {
  REQUIRE_MESSAGE(read, (read ? "" : read.error().message));
  return *read;
}

void is_refused(const Result<ImportedCalibration>& read, const std::string& place,
                const std::string& what) {
  REQUIRE_FALSE(read);
  CHECK(read.error().code == Errc::bad_input);
  CHECK(read.error().message.find('\n') == std::string::npos);
  CHECK_MESSAGE(read.error().message.starts_with(place), read.error().message);
  CHECK_MESSAGE(read.error().message.find(what) != std::string::npos, read.error().message);
}

const std::vector<Joint> hand_of_two_points{
    {"G_IndexMPJ", {{0.3, 0.0}, {0.6, 90.0}}},      {"G_ThumbAb", {{0.2, 0.0}, {0.7, 50.0}}},
    {"G_WristPitch", {{0.25, -30.0}, {0.7, 40.0}}}, {"G_WristYaw", {{0.5, -30.0}, {0.3, 10.0}}},
    {"G_MiddleIndexAb", {{0.6, 0.0}, {0.4, 50.0}}}, {"G_RingMiddleAb", {{0.3, 0.0}, {0.5, 25.0}}},
};

} // namespace

TEST_SUITE("ros_calibration") {
  TEST_CASE("two points make a sensor's line, whichever sign it has") {
    for (const bool is_xml : {false, true}) {
      const std::string text = is_xml ? xml_of(hand_of_two_points) : yaml_of(hand_of_two_points);
      CHECK(format_of(text) == (is_xml ? CalibrationFormat::ros_xml : CalibrationFormat::ros_yaml));
      const auto read = required(is_xml ? parse_ros_xml(text, "a") : parse_ros_yaml(text, "a"));
      CHECK(angle_deg_at(read, Sensor::index_mcp, 0.3) == doctest::Approx(0.0).epsilon(1e-6));
      CHECK(angle_deg_at(read, Sensor::index_mcp, 0.6) == doctest::Approx(90.0));
      CHECK(angle_deg_at(read, Sensor::thumb_abduction, 0.7) == doctest::Approx(50.0));
      CHECK(angle_deg_at(read, Sensor::wrist_pitch, 0.25) == doctest::Approx(-30.0));
      CHECK(angle_deg_at(read, Sensor::wrist_yaw, 0.3) == doctest::Approx(10.0));
      // Where the text says that a gap's counts fall, they fall: the fingers spread all the same.
      CHECK(angle_deg_at(read, Sensor::index_middle_abduction, 0.4) == doctest::Approx(50.0));
      CHECK(angle_deg_at(read, Sensor::middle_ring_abduction, 0.5) == doctest::Approx(25.0));
      CHECK(any_note_has(read, "G_PalmArch"));
      CHECK_FALSE(any_note_has(read, "G_IndexMPJ"));
      CHECK(read.notes.size() == 1);
    }
  }

  TEST_CASE("all names have their slots") {
    const std::vector<std::pair<std::string, Sensor>> names{
        {"G_ThumbRotate", Sensor::thumb_roll},
        {"G_ThumbMPJ", Sensor::thumb_mcp},
        {"G_ThumbIJ", Sensor::thumb_ip},
        {"G_ThumbAb", Sensor::thumb_abduction},
        {"G_IndexMPJ", Sensor::index_mcp},
        {"G_IndexPIJ", Sensor::index_pip},
        {"G_IndexDIJ", Sensor::index_dip},
        {"G_MiddleMPJ", Sensor::middle_mcp},
        {"G_MiddlePIJ", Sensor::middle_pip},
        {"G_MiddleDIJ", Sensor::middle_dip},
        {"G_MiddleIndexAb", Sensor::index_middle_abduction},
        {"G_RingMPJ", Sensor::ring_mcp},
        {"G_RingPIJ", Sensor::ring_pip},
        {"G_RingDIJ", Sensor::ring_dip},
        {"G_RingMiddleAb", Sensor::middle_ring_abduction},
        {"G_PinkieMPJ", Sensor::little_mcp},
        {"G_PinkiePIJ", Sensor::little_pip},
        {"G_PinkieDIJ", Sensor::little_dip},
        {"G_PinkieRingAb", Sensor::ring_little_abduction},
        {"G_PalmArch", Sensor::palm_arch},
        {"G_WristPitch", Sensor::wrist_pitch},
        {"G_WristYaw", Sensor::wrist_yaw}};
    std::vector<Joint> joints;
    for (std::size_t at = 0; at < names.size(); ++at)
      joints.push_back({names[at].first, {{0.2, 0.0}, {0.6, 40.0 + static_cast<double>(at)}}});
    const auto read = required(parse_ros_yaml(yaml_of(joints), "a"));
    CHECK(read.notes.empty());
    for (std::size_t at = 0; at < names.size(); ++at)
      CHECK(angle_deg_at(read, names[at].second, 0.6) ==
            doctest::Approx(40.0 + static_cast<double>(at)));
  }

  TEST_CASE("of more points the line is kept that is off the least, and by how much is said") {
    // The middle of the strip between the chord and its parallel through the third point.
    const std::vector<Joint> bent{{"G_RingPIJ", {{0.6, 90.0}, {0.2, 0.0}, {0.4, 30.0}}}};
    const auto read = required(parse_ros_xml(xml_of(bent), "a"));
    CHECK(angle_deg_at(read, Sensor::ring_pip, 0.2) == doctest::Approx(-7.5));
    CHECK(angle_deg_at(read, Sensor::ring_pip, 0.4) == doctest::Approx(37.5));
    CHECK(angle_deg_at(read, Sensor::ring_pip, 0.6) == doctest::Approx(82.5));
    CHECK(any_note_has(read, "3 points, and is off by up to 7.5 degrees"));
    const std::vector<Joint> straight{{"G_RingPIJ", {{0.2, 0.0}, {0.4, 40.0}, {0.5, 60.0}}}};
    CHECK_FALSE(any_note_has(required(parse_ros_xml(xml_of(straight), "a")), "off by"));
  }

  TEST_CASE("no other line is off by less") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> jitter(-10.0, 10.0);
    for (int round = 0; round < 200; ++round) {
      Joint joint{"G_IndexPIJ", {}};
      for (int k = 0; k < 3 + round % 9; ++k)
        joint.points.push_back({0.2 + 0.05 * k, 12.0 * k + jitter(random)});
      const auto read = required(parse_ros_yaml(yaml_of({joint}), "a"));
      const auto worst = [&](double at_02, double slope) {
        double most = 0.0;
        for (const Point& point : joint.points)
          most = std::max(most, std::abs(at_02 + slope * (point.raw - 0.2) - point.deg));
        return most;
      };
      const double at_02 = angle_deg_at(read, Sensor::index_pip, 0.2);
      const double slope = angle_deg_at(read, Sensor::index_pip, 1.2) - at_02;
      const double ours = worst(at_02, slope);
      for (int k = 0; k < 100; ++k)
        CHECK(worst(at_02 + 0.2 * jitter(random), slope + 2.0 * jitter(random)) >= ours - 1e-4);
    }
  }

  TEST_CASE("YAML as other writers lay it out is the same") {
    const auto index_deg = [](const std::string& text) {
      CAPTURE(text);
      CHECK(format_of(text) == CalibrationFormat::ros_yaml);
      return angle_deg_at(required(parse_ros_yaml(text, "a")), Sensor::index_mcp, 0.6);
    };
    for (const std::string text :
         {"cyberglove_calibration:\n- - G_IndexMPJ\n  - - [0.3, 0.0]\n    - [0.6, 90.0]\n",
          "rh_cyberglove:\n  port: /dev/ttyS0\n  cyberglove_calibration:\n  - [G_IndexMPJ, [[0.3, "
          "0], "
          "[0.6, 90]]]\n",
          "# note\n---\n{\"cyberglove_calibration\": [[\"G_IndexMPJ\", [[3e-1,0],[0.6,9e1]]]]}\n",
          "[['G_IndexMPJ', [[0.3, 0], [0.6, 90]]]]\n",
          "{cyberglove_calibration: {G_IndexMPJ: [[0.3, 0], [0.6, 90]]}}\r\n",
          "\xEF\xBB\xBF{'cyberglove_calibration': [['G_IndexMPJ', [[0.3,0],[0.6,90]]],]}"})
      CHECK(index_deg(text) == doctest::Approx(90.0));
  }

  TEST_CASE("joints that measure nothing or that are not known are named and left out") {
    // A glove of 18 sensors has no DIP sensors; its drivers write such points for them.
    auto joints = hand_of_two_points;
    joints.push_back({"G_IndexDIJ", {{-0.001, 0.0}, {0.0, 90.0}}});
    joints.push_back({"G_PinkieDIJ", {{0.999, 10.0}, {1.0, 10.0}}});
    joints.push_back({"G_Toe", {{0.1, 0.0}, {0.2, 9.0}}});
    const auto read = required(parse_ros_yaml(yaml_of(joints), "a"));
    CHECK(read.calibration[Sensor::index_dip].gain_rad_per_count == 0.0);
    CHECK(read.calibration[Sensor::little_dip].gain_rad_per_count == 0.0);
    CHECK(any_note_has(read, "G_IndexDIJ (index_dip) is left out"));
    CHECK(any_note_has(read, "G_PinkieDIJ (little_dip) is left out"));
    CHECK(any_note_has(read, "not known and not read: 'G_Toe'"));
  }

  TEST_CASE("a thumb whose roll has its zero elsewhere is kept as written, and a note says so") {
    const std::vector<Joint> joints{{"G_ThumbRotate", {{0.1, -60.0}, {0.6, 60.0}}}};
    const auto read = required(parse_ros_yaml(yaml_of(joints), "a"));
    CHECK(angle_deg_at(read, Sensor::thumb_roll, 0.1) == doctest::Approx(-60.0));
    CHECK(any_note_has(read, "G_ThumbRotate (thumb_roll) goes below 0 degrees"));
  }

  TEST_CASE("a file that is not right is refused in one line that names the place") {
    const auto yaml = [](const std::string& text) { return parse_ros_yaml(text, "a.yaml"); };
    const auto joint = [&](const std::string& points) {
      return yaml("{'cyberglove_calibration': [\n['G_IndexMPJ', " + points + "]]}\n");
    };
    REQUIRE(joint("[[0.3, 0], [0.6, 90]]"));
    is_refused(yaml(""), "a.yaml:1:", "empty");
    is_refused(yaml("other: 5\n"), "a.yaml:1:", "cyberglove_calibration");
    is_refused(yaml("{'cyberglove_calibration': [\n['G_IndexMPJ', [[0.3"), "a.yaml:", "YAML");
    is_refused(yaml("{'cyberglove_calibration': []}"), "a.yaml:1:", "no joint");
    is_refused(yaml("{'cyberglove_calibration': 4}"), "a.yaml:1:", "no list");
    is_refused(yaml("cyberglove_calibration:\n- G_IndexMPJ\n"), "a.yaml:2:", "no joint");
    is_refused(joint("[[0.3, 0]]"), "a.yaml:2: G_IndexMPJ", "fewer than two");
    is_refused(joint("[[0.3, 0], [0.3, 90]]"), "a.yaml:2:", "two angles");
    is_refused(joint("[[0.3, 0], [0.3, 0]]"), "a.yaml:2:", "one point");
    is_refused(joint("[[0.3, 0], [0.6, 90, 1]]"), "a.yaml:2:", "two numbers");
    is_refused(joint("[[0.3, zero], [0.6, 90]]"), "a.yaml:2:", "'zero' is no finite number");
    is_refused(joint("[[0.3, .nan], [0.6, 90]]"), "a.yaml:2:", "no finite number");
    is_refused(joint("[[80, 0], [160, 90]]"), "a.yaml:2:", "(count - 1) / 254");
    is_refused(joint("[[0.3, 0], [0.6, 9e99]]"), "a.yaml:2:", "absurd");
    is_refused(joint("5"), "a.yaml:2:", "no list");
    is_refused(yaml("&a [*a]"), "a.yaml:1:", "alias");
    is_refused(yaml(std::string(100'000, '[')), "a.yaml:1:", "nested too deeply");
    auto twice = hand_of_two_points;
    twice.push_back(twice.front());
    is_refused(yaml(yaml_of(twice)), "a.yaml:8:", "twice");

    const auto xml = [](const std::string& text) { return parse_ros_xml(text, "a.xml"); };
    const auto element = [&](const std::string& content) {
      return xml("<Cyberglove_calibration>\n<Joint name=\"G_IndexMPJ\">" + content +
                 "</Joint>\n</Cyberglove_calibration>\n");
    };
    const std::string good =
        "<calib raw_value='0.3' calibrated_value='0'/><calib raw_value=' 0.6 ' "
        "calibrated_value='90'/>";
    REQUIRE(element(good));
    is_refused(element(""), "a.xml:2: G_IndexMPJ", "fewer than two");
    is_refused(element("<calib raw_value='0.3'/>"), "a.xml:2:", "calibrated_value");
    is_refused(element("<calib raw_value='x' calibrated_value='0'/>"), "a.xml:2:", "raw_value");
    is_refused(element("<point/>"), "a.xml:2:", "'point' is not known");
    is_refused(xml(""), "a.xml:", "no XML");
    is_refused(xml("<html><body/></html>"), "a.xml:1:", "'html'");
    is_refused(xml("<Cyberglove_calibration>\n<Joint>"), "a.xml:2:", "needs a name");
    is_refused(xml("<Cyberglove_calibration>\n<calib/>"), "a.xml:2:", "outside");
    is_refused(xml("<Cyberglove_calibration>\n</Joint>"), "a.xml:2:", "mismatched tag");
    is_refused(xml("<!DOCTYPE a [<!ENTITY b \"c\">]>\n<Cyberglove_calibration/>"),
               "a.xml:1:", "document type");
    std::string deep = "<Cyberglove_calibration>";
    for (int k = 0; k < 1000; ++k)
      deep += "<Joint name='a'>";
    is_refused(xml(deep), "a.xml:1:", "outermost");
  }

  TEST_CASE("what is written reads back to the same angles, also of 12 bits") {
    std::mt19937 random(11);
    for (int round = 0; round < 50; ++round) {
      Calibration calibration = default_calibration();
      calibration.coupling_gains = {};
      for (auto& line : calibration.sensors)
        if (line.gain_rad_per_count != 0.0)
          line = {(round % 5 == 0 ? 8.0 : 1.0) * line.gain_rad_per_count *
                      (0.5 + 1e-9 * static_cast<double>(random() % 1'000'000'000)),
                  line.offset_counts + static_cast<double>(random() % 40)};
      for (const bool is_xml : {false, true}) {
        const auto text = is_xml ? ros_xml_text(calibration, {}) : ros_yaml_text(calibration, {});
        REQUIRE(text);
        CHECK(text->notes.empty());
        const auto read =
            required(is_xml ? parse_ros_xml(text->text, "a") : parse_ros_yaml(text->text, "a"));
        CHECK(read.notes.empty());
        for (std::size_t slot = 0; slot < sensor_slots; ++slot)
          for (const unsigned count : {0U, 255U}) {
            const RawCount raw{static_cast<std::uint16_t>(count)};
            CHECK(read.calibration.sensors[slot].angle_rad(raw) ==
                  doctest::Approx(calibration.sensors[slot].angle_rad(raw)).epsilon(1e-6));
          }
        // The same hand on a glove of 12 bits has the same points.
        Calibration fine = calibration;
        for (auto& line : fine.sensors)
          line = {line.gain_rad_per_count * 255.0 / 4095.0, line.offset_counts * 4095.0 / 255.0};
        const auto fine_text = is_xml ? ros_xml_text(fine, {4095}) : ros_yaml_text(fine, {4095});
        REQUIRE(fine_text);
        CHECK(fine_text->text == text->text);
      }
    }
  }

  TEST_CASE("what the forms cannot hold is reported or refused") {
    Calibration lossy = default_calibration();
    lossy.coupling_gains[1] = 0.5;
    lossy.middle_bias = 0.5;
    lossy[Sensor::index_dip] = {};
    const auto text = ros_yaml_text(lossy, {});
    REQUIRE(text);
    CHECK(text->notes.size() == 3);
    CHECK(text->notes.front().find("index_dip") != std::string::npos);
    CHECK(text->text.find("G_IndexDIJ") == std::string::npos);
    CHECK_FALSE(ros_xml_text(lossy, {255, true}));
    CHECK_FALSE(ros_xml_text(Calibration{}, {}));
  }
}

} // namespace ros_calibration_test
