#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/hand/calibration_exchange.hpp>
#include <nendo/hand/calibration_file.hpp>

#include "support/bvh_reader.hpp"
#include "support/program.hpp"

namespace calibration_command_test {

using nendo::Side;
using nendo::test::contents;
using nendo::test::Finished;
using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nendo::test::write_file;
using nlohmann::json;

namespace fs = std::filesystem;

namespace {

/// A wearer's home of the test's own: what is stored there is gone with it.
class Home {
public:
  Home() {
    const char* const before = std::getenv("XDG_CONFIG_HOME");
    if (before != nullptr) before_ = before;
    ::setenv("XDG_CONFIG_HOME", folder_.path().c_str(), 1);
  }
  ~Home() {
    before_.empty() ? ::unsetenv("XDG_CONFIG_HOME")
                    : ::setenv("XDG_CONFIG_HOME", before_.c_str(), 1);
  }
  Home(const Home&) = delete;
  Home& operator=(const Home&) = delete;

  fs::path stored(const std::string& name) const {
    return folder_.path() / "nendo" / "calibrations" / (name + ".toml");
  }
  fs::path file(const std::string& name) const { return folder_.path() / name; }
  std::size_t count() const {
    const fs::path folder = folder_.path() / "nendo" / "calibrations";
    if (!fs::exists(folder)) return 0;
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder), fs::directory_iterator{}));
  }

private:
  nendo::test::TemporaryFolder folder_;
  std::string before_;
};

const std::string csv = "sensor,gain_rad_per_count,offset_counts\n"
                        "index_mcp,0.0125,60\n"
                        "index_pip,0.0110,64\n";

Finished calibration(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "calibration");
  return nendo::test::nendo(std::move(arguments));
}

std::string with_gain(const std::string& gain) {
  std::string text = csv;
  return text.replace(text.find("0.0125"), 6, gain);
}

} // namespace

TEST_SUITE("calibration command") {
  TEST_CASE("what is imported is stored, listed, shown and exported again") {
    const Home home;
    write_file(home.file("x.csv"), csv);
    const auto done = calibration({"import", home.file("x.csv").string(), "--user", "anna",
                                   "--hand", "right", "--glove", "A1"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const fs::path path = home.stored("anna+A1+right");
    CHECK(done.out.find(path.string()) != std::string::npos);
    const auto wearer = nendo::hand::read_calibration(path);
    REQUIRE(wearer);
    CHECK(wearer->user == "anna");
    CHECK(wearer->glove_serial == "A1");
    CHECK(wearer->side == Side::right);
    CHECK(wearer->method == "imported");
    CHECK(wearer->calibration[nendo::Sensor::index_mcp].gain_rad_per_count == 0.0125);

    const auto listed = calibration({"list", "--json"});
    REQUIRE(lines_of(listed.out).size() == 1);
    const json line = json::parse(listed.out);
    CHECK(line["user"] == "anna");
    CHECK(line["hand"] == "right");
    CHECK(line["glove_serial"] == "A1");
    CHECK(line["method"] == "imported");
    CHECK(line["path"] == path.string());
    CHECK(line["in_force"] == true);
    CHECK(line["shared"] == false);

    for (const std::string name : {"anna", "anna+A1+right"}) {
      const json shown = json::parse(calibration({"show", name, "--json"}).out);
      CHECK(shown["sensors"].size() == 2);
      CHECK(shown["sensors"]["index_pip"]["offset_counts"] == 64.0);
      CHECK(calibration({"path", name}).out == path.string() + "\n");
    }
    CHECK(calibration({"show", path.string()}).out.find("index_pip") != std::string::npos);

    const auto out = home.file("out.csv").string();
    const auto written = calibration({"export", "anna", "--format", "csv", "--out", out});
    CHECK(written.exit_code == 0);
    const auto back = nendo::hand::parse_calibration_csv(contents(out), out);
    REQUIRE(back);
    CHECK(back->calibration[nendo::Sensor::index_pip].gain_rad_per_count == 0.011);
    CHECK(calibration({"export", "anna"}).out == contents(path));
  }

  TEST_CASE("a TOML file names its wearer, glove and hand itself") {
    const Home home;
    write_file(home.file("x.csv"), csv);
    REQUIRE(calibration({"import", home.file("x.csv").string(), "--user", "anna", "--hand", "left"})
                .exit_code == 0);
    fs::rename(home.stored("anna+any+left"), home.file("taken.toml"));
    const auto done = calibration({"import", home.file("taken.toml").string()});
    CAPTURE(done.err);
    CHECK(done.exit_code == 0);
    CHECK(contents(home.stored("anna+any+left")) == contents(home.file("taken.toml")));
    const auto right = calibration({"import", home.file("taken.toml").string(), "--hand", "right"});
    CHECK(right.exit_code == 5);
    CHECK(is_one_line_about(right.err, "left hand"));
    CHECK(home.count() == 1);
  }

  TEST_CASE("a .cal goes out in VirtualHand's form and comes back") {
    const Home home;
    nendo::hand::WearerCalibration wearer;
    wearer.user = "anna";
    wearer.method = "quick";
    wearer.calibration = nendo::hand::default_calibration();
    REQUIRE(nendo::hand::write_calibration(home.stored("x"), wearer));
    const auto out = home.file("x.cal").string();
    const auto done = calibration({"export", "x", "--format", "cal", "--out", out});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    REQUIRE(calibration({"import", out, "--user", "berta", "--hand", "right"}).exit_code == 0);
    const auto diff = calibration({"diff", "anna", "berta", "--json"});
    REQUIRE(lines_of(diff.out).size() == 22);
    for (const auto& line : lines_of(diff.out)) {
      const json sensor = json::parse(line);
      CAPTURE(line);
      CHECK(std::abs(sensor["change_at_0_deg"].get<double>()) < 0.1);
      CHECK(std::abs(sensor["change_at_full_deg"].get<double>()) < 0.1);
      CHECK(sensor["b_at_full_deg"].get<double>() - sensor["a_at_full_deg"].get<double>() ==
            doctest::Approx(sensor["change_at_full_deg"].get<double>()));
    }
  }

  TEST_CASE("diff gives degrees at no counts and at the most") {
    const Home home;
    for (const std::string user : {"anna", "berta"}) {
      write_file(home.file("x.csv"), user == "anna" ? csv : with_gain("0.0150"));
      REQUIRE(
          calibration({"import", home.file("x.csv").string(), "--user", user, "--hand", "right"})
              .exit_code == 0);
    }
    const json first =
        json::parse(lines_of(calibration({"diff", "anna", "berta", "--json"}).out)[0]);
    constexpr double deg = 57.29577951308232;
    CHECK(first["sensor"] == "index_mcp");
    CHECK(first["a_at_0_deg"].get<double>() == doctest::Approx(-0.75 * deg));
    CHECK(first["b_at_0_deg"].get<double>() == doctest::Approx(-0.90 * deg));
    CHECK(first["a_at_full_deg"].get<double>() == doctest::Approx(0.0125 * 195.0 * deg));
    CHECK(first["change_at_full_deg"].get<double>() == doctest::Approx(0.0025 * 195.0 * deg));
    CHECK(lines_of(calibration({"diff", "anna", "berta"}).out).size() == 3);
  }

  TEST_CASE("an import keeps the earlier version, and removing keeps the last") {
    const Home home;
    const auto take_in = [&] {
      return calibration(
          {"import", home.file("x.csv").string(), "--user", "anna", "--hand", "right"});
    };
    write_file(home.file("x.csv"), csv);
    REQUIRE(take_in().exit_code == 0);
    write_file(home.file("x.csv"), with_gain("0.02"));
    const auto second = take_in();
    CHECK(second.exit_code == 0);
    CHECK(second.out.find("kept as") != std::string::npos);
    CHECK(home.count() == 2);
    CHECK(lines_of(calibration({"list", "--json"}).out).size() == 1);
    const auto removed = calibration({"remove", "anna"});
    CHECK(removed.exit_code == 0);
    CHECK(home.count() == 2);
    CHECK(calibration({"list", "--json"}).out.empty());
    CHECK(calibration({"remove", "anna"}).exit_code == 5);
  }

  TEST_CASE("a bad file is one clear line, and no file is touched") {
    const Home home;
    write_file(home.file("good.csv"), csv);
    REQUIRE(
        calibration({"import", home.file("good.csv").string(), "--user", "anna", "--hand", "right"})
            .exit_code == 0);
    const auto before = contents(home.stored("anna+any+right"));
    for (const std::string& text :
         {std::string(), with_gain("0"), with_gain("-0.0125"), with_gain("nan"), with_gain("7"),
          csv.substr(0, csv.size() - 4), std::string("VHv9.0\n"), std::string("version = 9\n"),
          std::string("\0\1\2", 3)}) {
      write_file(home.file("bad"), text);
      const auto done =
          calibration({"import", home.file("bad").string(), "--user", "anna", "--hand", "right"});
      CAPTURE(text);
      CAPTURE(done.err);
      CHECK(done.exit_code == 5);
      CHECK(is_one_line_about(done.err, home.file("bad").string() + ":"));
      CHECK(done.out.empty());
    }
    CHECK(contents(home.stored("anna+any+right")) == before);
    CHECK(home.count() == 1);
  }

  TEST_CASE("a hostile wearer's name stays within the folder") {
    const Home home;
    write_file(home.file("x.csv"), csv);
    const auto done = calibration({"import", home.file("x.csv").string(), "--user",
                                   "../../../escaped", "--hand", "right", "--glove", "/dev/null"});
    CHECK(done.exit_code == 0);
    CHECK(home.count() == 1);
    CHECK_FALSE(fs::exists(home.file("escaped")));
    const auto newline =
        calibration({"import", home.file("x.csv").string(), "--user", "a\nb", "--hand", "right"});
    CHECK(newline.exit_code == 5);
    CHECK(home.count() == 1);
  }

  TEST_CASE("wrong usage is reported") {
    const Home home;
    write_file(home.file("x.csv"), csv);
    const auto file = home.file("x.csv").string();
    CHECK(is_one_line_about(calibration({"import", file, "--user", "anna"}).err, "--hand"));
    CHECK(is_one_line_about(calibration({"import", file, "--hand", "left"}).err, "--user"));
    CHECK(calibration({"import", file, "--user", "a", "--hand", "both"}).exit_code == 2);
    CHECK(calibration({"export", "anna", "--format", "pdf"}).exit_code == 2);
    CHECK(calibration({"import", "/no/such/file", "--user", "a", "--hand", "left"}).exit_code == 5);
    CHECK(calibration({"show", "nobody"}).exit_code == 5);
    CHECK(calibration({}).exit_code == 2);
    CHECK(home.count() == 0);
  }

  TEST_CASE("a file whose name says its hand gets that hand offered, but not unasked") {
    const Home home;
    // The first two are the names that KIT's files have.
    const std::vector<std::pair<std::string, std::string>> names{
        {"GloveCalibrationLeft.cal", "add --hand left"},
        {"GloveCalibrationRight.cal", "add --hand right"},
        {"kit_left.csv", "add --hand left"},
        {"RIGHT-2.csv", "add --hand right"},
        {"copyright.csv", "add --hand left or right"},
        {"leftover.csv", "add --hand left or right"},
        {"left or right.csv", "add --hand left or right"},
        {"x.csv", "add --hand left or right"}};
    for (const auto& [name, offered] : names) {
      write_file(home.file(name), csv);
      const auto done = calibration({"import", home.file(name).string(), "--user", "anna"});
      CHECK(done.exit_code == 2);
      CHECK(is_one_line_about(done.err, name));
      CHECK(done.err.ends_with(offered + "\n"));
    }
    CHECK(home.count() == 0);
  }

  TEST_CASE("an export that a format cannot hold names the wearer, the sensors and the remedy") {
    const Home home;
    write_file(home.file("x.csv"), "sensor,gain_rad_per_count,offset_counts\n"
                                   "index_mcp,0.0125,60\nthumb_abduction,0.0026,-29.33\n");
    REQUIRE(
        calibration({"import", home.file("x.csv").string(), "--user", "anna", "--hand", "right"})
            .exit_code == 0);
    const auto done = calibration({"export", "anna", "--format", "cal"});
    CHECK(done.exit_code == 5);
    CHECK(done.out.empty());
    CHECK(is_one_line_about(done.err, "anna: "));
    CHECK(done.err.find("thumb_abduction (-29.3)") != std::string::npos);
    CHECK(done.err.find("toml or csv") != std::string::npos);
  }

  TEST_CASE("a stored file that cannot be read is reported, and the rest is listed") {
    const Home home;
    write_file(home.file("x.csv"), csv);
    REQUIRE(
        calibration({"import", home.file("x.csv").string(), "--user", "anna", "--hand", "right"})
            .exit_code == 0);
    write_file(home.stored("broken"), "version = 1\nuser = 7\n");
    const auto done = calibration({"list", "--json"});
    CHECK(done.exit_code == 0);
    CHECK(lines_of(done.out).size() == 1);
    CHECK(is_one_line_about(done.err, "broken.toml:2:"));
  }

  TEST_CASE("a glove gets the stored calibration of its hand, and one line says so") {
    const Home home;
    const auto link = home.file("glove");
    const nendo::test::EmulatedGlove glove(link, "left", "22");
    const auto monitor = [&](std::vector<std::string> more) {
      more.insert(more.begin(), {"monitor", "serial:" + link.string(), "--json", "--count", "2"});
      return nendo::test::nendo(more);
    };
    // The gain by which index_mcp's angle was made of its count, if the offset is 60.
    const auto gain = [&](const Finished& done) {
      REQUIRE_MESSAGE(lines_of(done.out).size() == 2, done.err);
      const json sample = json::parse(lines_of(done.out)[0]);
      return sample["angle_rad"]["index_mcp"].get<double>() /
             (sample["raw"]["index_mcp"].get<double>() - 60.0);
    };
    const auto take_in = [&](const std::string& user, const std::string& hand,
                             const std::string& index_gain) {
      write_file(home.file("x.csv"), with_gain(index_gain));
      REQUIRE(calibration({"import", home.file("x.csv").string(), "--user", user, "--hand", hand})
                  .exit_code == 0);
    };
    take_in("anna", "right", "0.02");
    const auto other_hand = monitor({});
    CHECK(is_one_line_about(other_hand.err, "not calibrated for this left hand"));
    CHECK(other_hand.err.find("nendo calibrate serial:" + link.string()) != std::string::npos);
    CHECK(gain(other_hand) == doctest::Approx(0.0125)); // the default
    const auto without = monitor({"--user", "anna"});
    CHECK(without.exit_code == 0);
    CHECK(is_one_line_about(without.err, "anna has no calibration of a left hand"));
    CHECK(gain(without) == doctest::Approx(0.0125));
    CHECK(json::parse(lines_of(without.out)[0])["calibration"]["kind"] == "average");
    const auto nobody = monitor({"--user", "nobody"});
    CHECK(nobody.exit_code == 5);
    CHECK(is_one_line_about(nobody.err, "there are those of anna"));
    CHECK(is_one_line_about(monitor({"--calibration", "anna"}).err, "right hand"));

    take_in("anna", "left", "0.03");
    const auto own = monitor({});
    CHECK(is_one_line_about(own.err, "anna, left hand"));
    CHECK(own.err.find("does not name the glove with which it was made") != std::string::npos);
    CHECK(gain(own) == doctest::Approx(0.03));
    const json whose = json::parse(lines_of(own.out)[0])["calibration"];
    CHECK(whose["kind"] == "stored");
    CHECK(whose["user"] == "anna");
    CHECK(fs::exists(whose["path"].get<std::string>()));
    CHECK_FALSE(json::parse(lines_of(own.out)[1]).contains("calibration"));
    take_in("berta", "left", "0.01");
    CHECK(gain(monitor({"--user", "anna"})) == doctest::Approx(0.03));
    CHECK(gain(monitor({"--user", "berta"})) == doctest::Approx(0.01));
    CHECK(gain(monitor({"--calibration", "berta"})) == doctest::Approx(0.01));
    const auto none = monitor({"--calibration", "none"});
    CHECK(none.err.empty());
    CHECK(gain(none) == doctest::Approx(0.0125));

    const auto run = nendo::test::nendo({"run", "--left", "serial:" + link.string(), "--user",
                                         "berta", "--duration", "0.3", "--json", "--out",
                                         home.file("shape.obj").string()});
    CHECK(run.exit_code == 0);
    CHECK(run.err.find("berta, left hand") != std::string::npos);
  }

  TEST_CASE("two gloves have two wearers, and one that is not calibrated continues") {
    const Home home;
    for (const auto& [user, hand, index_gain] :
         {std::tuple{"anna", "right", "0.02"}, {"berta", "left", "0.03"}}) {
      write_file(home.file("x.csv"), with_gain(index_gain));
      REQUIRE(calibration({"import", home.file("x.csv").string(), "--user", user, "--hand", hand})
                  .exit_code == 0);
    }
    int takes = 0;
    // The gains by which the angles of the left and the right hand in the table were made.
    const auto record = [&](std::vector<std::string> more) {
      const std::string take = home.file(std::to_string(++takes) + ".nendo").string();
      more.insert(more.begin(), {"record", "sim?hand=left", "sim?hand=right", "--duration", "200ms",
                                 "--out", take});
      return nendo::test::nendo(more);
    };
    const auto both = record({"--left-user", "berta", "--right-user", "anna"});
    CHECK(both.exit_code == 0);
    CHECK(both.err.find("calibrated for berta, left hand") != std::string::npos);
    CHECK(both.err.find("calibrated for anna, right hand") != std::string::npos);
    const auto one = record({"--user", "anna"});
    CHECK(one.exit_code == 0);
    CHECK(one.err.find("calibrated for anna, right hand") != std::string::npos);
    CHECK(one.err.find("anna has no calibration of a left hand") != std::string::npos);
    CHECK(one.err.find("`nendo calibrate 'sim?hand=left' --user anna` makes one") !=
          std::string::npos);
    const auto mixed = record({"--user", "anna", "--left-user", "berta"});
    CHECK(mixed.exit_code == 0);
    CHECK(mixed.err.find("calibrated for berta, left hand") != std::string::npos);
    const auto nobody = record({"--left-user", "bert", "--right-user", "anna"});
    CHECK(nobody.exit_code == 5);
    CHECK(nobody.err.find("--left-user bert: no calibration of bert is stored; there are those of "
                          "anna, berta") != std::string::npos);
    const auto run = nendo::test::nendo({"run", "--left", "sim", "--right", "sim", "--left-user",
                                         "berta", "--right-user", "anna", "--duration", "0.2",
                                         "--out", home.file("x.obj").string()});
    CHECK(run.exit_code == 0);
    CHECK(run.err.find("berta, left hand") != std::string::npos);
    const auto no_left = nendo::test::nendo(
        {"poses", "sim", "--count", "1", "--left-user", "berta", "--right-user", "anna"});
    CHECK(no_left.exit_code == 2);
    CHECK(is_one_line_about(no_left.err, "no glove here is of a left hand"));
  }

  TEST_CASE("a calibration of a ROS driver comes in, and goes out in both forms") {
    const Home home;
    write_file(home.file("theirs.yaml"),
               "{'cyberglove_calibration': [\n"
               "['G_IndexMPJ', [[0.200000,0.000000],[0.600000,90.000000]]],\n"
               "['G_IndexPIJ', [[0.200000,0.000000],[0.400000,30.000000],[0.600000,90.000000]]],\n"
               "['G_WristYaw', [[0.300000,-30.000000],[0.700000,10.000000]]],\n]}\n");
    const auto import = [&](const std::string& file, const std::string& user) {
      return calibration({"import", home.file(file).string(), "--user", user, "--hand", "right"});
    };
    const auto in = import("theirs.yaml", "anna");
    CHECK(in.exit_code == 0);
    CHECK(in.err.find("G_IndexPIJ (index_pip): a line replaces its 3 points, and is off by up to "
                      "7.5 degrees") != std::string::npos);
    CHECK(in.err.find("G_ThumbRotate") != std::string::npos); // not there
    const auto sensors = [&](const std::string& user) {
      return json::parse(calibration({"show", user, "--json"}).out)["sensors"];
    };
    const json theirs = sensors("anna");
    CHECK(theirs.size() == 3);
    // 0.2 and 0.6 of 1 to 255 are counts 51.8 and 153.4.
    CHECK(theirs["index_mcp"]["offset_counts"].get<double>() == doctest::Approx(51.8));
    CHECK(theirs["index_mcp"]["gain_rad_per_count"].get<double>() ==
          doctest::Approx(1.5707963267948966 / 101.6));
    for (const std::string format : {"yaml", "xml"}) {
      const auto out = calibration(
          {"export", "anna", "--format", format, "--out", home.file("out." + format).string()});
      CHECK(out.exit_code == 0);
      CHECK(out.err.find("not calibrated, so left out") != std::string::npos);
      REQUIRE(import("out." + format, "of_" + format).exit_code == 0);
      const json again = sensors("of_" + format);
      REQUIRE(again.size() == 3);
      for (const auto& [name, line] : theirs.items())
        for (const char* key : {"gain_rad_per_count", "offset_counts"})
          CHECK(again[name][key].get<double>() ==
                doctest::Approx(line[key].get<double>()).epsilon(1e-6));
    }
  }

  TEST_CASE("a calibration that may be another glove's says so, and one that is this one's not") {
    const Home home;
    nendo::hand::WearerCalibration wearer;
    wearer.user = "anna";
    wearer.method = "full";
    wearer.calibration = nendo::hand::default_calibration();
    wearer.calibration[nendo::Sensor::index_mcp].gain_rad_per_count = 0.02;
    const auto link = home.file("glove");
    const nendo::test::EmulatedGlove glove(link, "right", "22");
    const std::string spec = "serial:" + link.string();
    const json info = json::parse(nendo::test::nendo({"info", spec, "--json"}).out);
    const auto said = [&](const std::string& model, const std::string& serial) {
      wearer.glove_model = model;
      wearer.glove_serial = serial;
      REQUIRE(nendo::hand::write_calibration(home.stored("x"), wearer));
      return nendo::test::nendo({"monitor", spec, "--json", "--count", "1"}).err;
    };
    const std::string model = info["model"];
    CHECK(is_one_line_about(said(model, "B2"), "made with another glove of this model"));
    CHECK(is_one_line_about(said(model, ""), "maybe another one"));
    CHECK(is_one_line_about(said("", ""), "does not name the glove"));
    CHECK(is_one_line_about(said("another model", ""), "not calibrated"));
    CHECK(is_one_line_about(said("another model", "B2"), "not calibrated"));
  }

  TEST_CASE(
      "run says once that it shapes by default angles, and its progress and end keep a mark") {
    const Home home;
    const auto link = home.file("glove");
    const nendo::test::EmulatedGlove glove(link, "right", "22");
    const auto run = [&](std::vector<std::string> more) {
      more.insert(more.begin(), {"run", "--right", "serial:" + link.string(), "--duration", "2.5",
                                 "--out", home.file("shape.obj").string()});
      const auto done = nendo::test::nendo(more);
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      return done;
    };
    const auto count = [](const std::string& text, const std::string& word) {
      std::size_t found = 0;
      for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
        ++found;
      return found;
    };
    const auto bare = run({});
    CHECK(count(bare.err, "not calibrated for this right hand") == 1);
    CHECK(count(bare.err, ", uncalibrated") >= 1);
    CHECK(count(bare.out, "uncalibrated") == 1);
    const auto asked = run({"--calibration", "none"});
    CHECK(count(asked.err, "not calibrated") == 0); // it was asked for
    CHECK(count(asked.out, "uncalibrated") == 1);
    const auto learning = run({"--adapt"});
    CHECK(count(learning.err + learning.out, "calibrated") == 0);
    write_file(home.file("x.csv"), with_gain("0.02"));
    REQUIRE(
        calibration({"import", home.file("x.csv").string(), "--user", "anna", "--hand", "right"})
            .exit_code == 0);
    const auto own = run({});
    CHECK(count(own.err, "anna, right hand") == 1);
    CHECK(count(own.err + own.out, "uncalibrated") == 0);
  }

  TEST_CASE("a simulated hand is the default's, and the demo uses no real hand's calibration") {
    const Home home;
    const auto sim = nendo::test::nendo({"monitor", "sim", "--json", "--count", "1"});
    CHECK(sim.err.empty());
    for (const std::string hand : {"left", "right"}) {
      write_file(home.file("x.csv"), with_gain("0.03"));
      REQUIRE(calibration({"import", home.file("x.csv").string(), "--user", "anna", "--hand", hand})
                  .exit_code == 0);
    }
    const auto demo =
        nendo::test::nendo({"demo", "--duration", "2.5", "--out", home.file("x.obj").string(),
                            "--picture", home.file("x.png").string()});
    REQUIRE_MESSAGE(demo.exit_code == 0, demo.err);
    CHECK((demo.err + demo.out).find("anna") == std::string::npos);
    CHECK((demo.err + demo.out).find("calibrated") == std::string::npos);
  }

  TEST_CASE("an empty list says how to make a calibration") {
    const Home home;
    const auto done = calibration({"list"});
    CHECK(done.exit_code == 0);
    CHECK(done.out.empty());
    if (fs::exists("/etc/nendo/calibrations")) return; // this machine has some for all users
    CHECK(is_one_line_about(done.err, "`nendo calibrate GLOVE --user NAME`"));
  }

  TEST_CASE("a glove of the other hand that is plugged in instead gets that hand's calibration") {
    const Home home;
    for (const auto& [hand, index_gain] : {std::pair{"left", "0.03"}, {"right", "0.02"}}) {
      write_file(home.file("x.csv"), with_gain(index_gain));
      REQUIRE(calibration({"import", home.file("x.csv").string(), "--user", "anna", "--hand", hand})
                  .exit_code == 0);
    }
    const auto link = home.file("glove");
    const nendo::test::Program emulator(
        {"emulate", "--link", link.string(), "--hand", "left", "--fault", "swap@4s=right"});
    REQUIRE(nendo::test::appears(link));
    const auto done =
        nendo::test::nendo({"monitor", "serial:" + link.string(), "--json", "--count", "480"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    std::size_t left = 0, right = 0, report = 0;
    for (const auto& line : lines_of(done.out)) {
      const json sample = json::parse(line);
      const bool is_left = sample["hand"] == "left";
      ++(is_left ? left : right);
      if (sample.contains("angles")) ++report;
      const double counts = sample["raw"]["index_mcp"].get<double>() - 60.0;
      REQUIRE(sample["angle_rad"]["index_mcp"].get<double>() ==
              doctest::Approx((is_left ? 0.03 : 0.02) * counts));
    }
    CHECK(left > 0);
    CHECK(right > 0);
    CHECK(report == 2);                                        // once a glove
    CHECK(done.err.find("in its place") == std::string::npos); // the same wearer's, as one expects
  }

  TEST_CASE("who would get another wearer's calibration by changing the glove gets a message") {
    const Home home;
    for (const auto& [user, hand] : {std::pair{"anna", "left"}, {"bert", "right"}}) {
      write_file(home.file("x.csv"), with_gain("0.03"));
      REQUIRE(calibration({"import", home.file("x.csv").string(), "--user", user, "--hand", hand})
                  .exit_code == 0);
    }
    const auto link = home.file("glove");
    const nendo::test::Program emulator({"emulate", "--link", link.string(), "--hand", "left"});
    REQUIRE(nendo::test::appears(link));
    const auto done =
        nendo::test::nendo({"monitor", "serial:" + link.string(), "--json", "--count", "1"});
    CHECK(done.err.find("calibrated for anna, left hand") != std::string::npos);
    CHECK(
        done.err.find("a right-hand glove in its place would be calibrated for bert, right hand") !=
        std::string::npos);
  }

  TEST_CASE("a wearer's hand has the size that the calibration says, unless another is given") {
    const Home home;
    nendo::hand::WearerCalibration wearer;
    wearer.user = "anna";
    wearer.method = "full";
    wearer.size = {0.160, 0.070};
    wearer.calibration = nendo::hand::default_calibration();
    REQUIRE(nendo::hand::write_calibration(home.stored("x"), wearer));
    // Buchholz et al. 1992: the index finger's proximal phalanx is 0.245 of the hand's length, and
    // its knuckle 0.251 of the breadth from the middle one's axis.
    const auto measures = [](std::vector<std::string> more) {
      more.insert(more.begin(), {"poses", "sim", "--count", "1"});
      const auto done = nendo::test::nendo(more);
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      const auto joints = json::parse(done.out)["joints"];
      const auto place = [&](const char* joint) {
        const auto& p = joints[joint]["position_m"];
        return Eigen::Vector3d(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
      };
      return std::pair{(place("index_proximal") - place("index_intermediate")).norm() / 0.245,
                       (place("index_proximal") - place("middle_proximal")).norm()};
    };
    const auto [own, own_knuckles] = measures({"--user", "anna"});
    CHECK(own == doctest::Approx(0.160));
    const auto [named, named_knuckles] = measures({"--calibration", "anna"});
    CHECK(named == doctest::Approx(0.160));
    CHECK(measures({}).first == doctest::Approx(0.187)); // an average one
    const auto [given, given_knuckles] = measures({"--user", "anna", "--hand-length", "208"});
    CHECK(given == doctest::Approx(0.208));
    CHECK(given_knuckles == doctest::Approx(own_knuckles * 208.0 / 160.0)); // of her proportions

    const auto bvh = home.file("x.bvh").string();
    REQUIRE(nendo::test::nendo({"poses", "sim", "--count", "1", "--user", "anna", "--bvh", bvh})
                .exit_code == 0);
    const nendo::test::BvhRecording recording(contents(bvh));
    const auto& bone = recording.nodes[recording.find("index_intermediate_R")];
    CHECK(0.01 * bone.offset.norm() == doctest::Approx(0.245 * 0.160));

    for (const auto& [option, length_mm] :
         {std::pair<std::string, double>{"", 160.0}, {"208", 208.0}}) {
      std::vector<std::string> run{"run",    "--right",    "sim", "--user", "anna",
                                   "--json", "--duration", "0.3", "--out",  home.file("x.obj")};
      if (!option.empty()) run.insert(run.end(), {"--hand-length", option});
      const auto done = nendo::test::nendo(run);
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      const json summary = json::parse(lines_of(done.out).back());
      CHECK(summary["right"]["hand_length_mm"].get<double>() == doctest::Approx(length_mm));
    }
  }
}

} // namespace calibration_command_test
