// Real hands that a camera has seen wear a real glove's calibration, and go the whole way: counts,
// glove, recording, angles, loop, replay, export.

#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/csv_table.hpp"
#include "support/program.hpp"
#include "support/shell.hpp"
#include "support/temporary_folder.hpp"

namespace optical_hand_test {

using namespace nendo;

namespace {

using Columns = std::map<std::string, std::vector<double>>;

Columns columns_of(const std::string& path) {
  Columns columns;
  for (const auto& [name, cells] : test::csv_columns(test::contents(path)))
    if (name != "hand")
      for (const std::string& cell : cells)
        columns[name].push_back(std::strtod(cell.c_str(), nullptr));
  return columns;
}

/// A motion, worn with the calibration of KIT's right glove.
struct Worn {
  test::TemporaryFolder folder;
  std::string counts = at("counts.csv"), take = at("take.nendo"), kit = at("kit.csv");

  explicit Worn(const std::string& motion) {
    ::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1);
    REQUIRE(test::nendo({"calibration", "import", NENDO_HANDS "/calibrations/kit_right.cal",
                         "--hand", "right", "--user", "kit"})
                .exit_code == 0);
    REQUIRE(
        test::nendo({"calibration", "export", "kit", "--format", "csv", "--out", kit}).exit_code ==
        0);
    write(motion, "", counts);
    write(motion, "--angles ", at("angles.csv"));
    REQUIRE(
        test::nendo({"record", "replay:" + counts + "?speed=20", "--user", "kit", "--out", take})
            .exit_code == 0);
  }
  ~Worn() { ::unsetenv("XDG_CONFIG_HOME"); }
  std::string at(const std::string& name) const { return (folder.path() / name).string(); }
  void write(const std::string& motion, const std::string& options, const std::string& to) const {
    const auto done = test::shell("python3 " NENDO_OPTICAL_COUNTS " " + options +
                                  NENDO_HANDS "/motions/" + motion + " " + kit + " > " + to);
    REQUIRE_MESSAGE(done.exit_code == 0, done.out);
  }
};

} // namespace

TEST_SUITE("optical_hand") {
  TEST_CASE("angles that a camera has seen come out of a recording, to a count") {
    for (const std::string motion : {"leap_grab.csv", "leap_handsplay.csv"}) {
      CAPTURE(motion);
      const Worn worn(motion);
      REQUIRE(test::nendo({"export", worn.take, "--out", worn.at("out.csv")}).exit_code == 0);
      Columns seen = columns_of(worn.at("angles.csv")), out = columns_of(worn.at("out.csv"));
      int compared = 0;
      for (const auto& column : seen) {
        const std::string& name = column.first;
        const std::vector<double>& angles = column.second;
        if (name == "time_s") continue;
        CAPTURE(name);
        const std::string sensor = name.substr(0, name.size() - std::string("_deg").size());
        const std::vector<double>&counts = out[sensor + "_count"], &report = out[name];
        REQUIRE(counts.size() == angles.size());
        REQUIRE(report.size() == angles.size());
        // The least step of the angle between two counts.
        double step_deg = 5.0;
        for (std::size_t at = 1; at < report.size(); ++at)
          if (std::abs(counts[at] - counts[at - 1]) == 1.0)
            step_deg = std::abs(report[at] - report[at - 1]);
        for (std::size_t at = 0; at < angles.size(); ++at) {
          if (!(counts[at] > 0.0 && counts[at] < 255.0)) continue; // beyond the glove's converter
          REQUIRE(std::abs(report[at] - angles[at]) <= 0.5 * step_deg + 1e-3);
          ++compared;
        }
      }
      CHECK(compared > 4000);
    }
  }

  TEST_CASE("the study of its joints reports what the camera's model takes for granted") {
    const Worn worn("leap_grab.csv");
    const auto report = test::nendo({"recording", "joints", worn.take, "--json"});
    REQUIRE(report.exit_code == 0);
    const auto hand = nlohmann::json::parse(report.out)["hands"][0];
    CHECK(hand["hand"] == "right");
    CHECK(hand["calibrated"] == true);
    CHECK(hand["samples"] == 374);
    int couplings = 0;
    for (const auto& pair : hand["pairs"]) {
      const std::string one = pair["one"], other = pair["other"];
      if (one.find("pip") == std::string::npos || other.find("dip") == std::string::npos) continue;
      ++couplings; // this camera bends both alike, where people's DIP joints bend by two thirds
      CHECK(pair["slope"].get<double>() == doctest::Approx(1.0).epsilon(0.03));
      CHECK(pair["correlation"].get<double>() > 0.99);
    }
    CHECK(couplings == 4);
    for (const auto& joint : hand["joints"]) {
      CAPTURE(joint["joint"]);
      if (joint["joint"] == "thumb_roll") continue; // the camera's thumb base is another joint
      CHECK(joint["beyond"].get<double>() < 0.1);
    }
    const auto text = test::nendo({"recording", "joints", worn.take});
    CHECK(text.exit_code == 0);
    CHECK(text.out.find("index_pip_flexion and index_dip_flexion") != std::string::npos);
  }

  TEST_CASE("such a hand shapes clay's ball, and the recording of that replays to the same bytes") {
    const Worn worn("leap_grab.csv");
    const auto run =
        test::nendo({"run", NENDO_MODELS "/clay.ply", "--right", "replay:" + worn.counts, "--user",
                     "kit", "--record", worn.at("run.nendo"), "--out", worn.at("run.ply")});
    REQUIRE_MESSAGE(run.exit_code == 0, run.err);
    const auto again = test::nendo({"replay", worn.at("run.nendo"), "--out", worn.at("again.ply")});
    REQUIRE_MESSAGE(again.exit_code == 0, again.err);
    CHECK(test::contents(worn.at("run.ply")) == test::contents(worn.at("again.ply")));
    CHECK(test::nendo({"export", worn.at("run.nendo"), "--out", worn.at("hand.bvh")}).exit_code ==
          0);
  }
}

} // namespace optical_hand_test
