// nendo run --adapt --user: what is learned of a wearer is kept, and continued from.

#include <cstdlib>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/calibration_store.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace kept_ranges_test {

using namespace nendo;
using namespace nendo::test;

namespace {

/// A home of its own, in which a simulated right hand runs.
struct Home {
  TemporaryFolder folder;
  Home() { REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0); }
  ~Home() { ::unsetenv("XDG_CONFIG_HOME"); }
  Home(const Home&) = delete;
  Home& operator=(const Home&) = delete;

  Finished run(const std::vector<std::string>& more, const char* duration = "4") const {
    std::vector<std::string> arguments{"run",    "--right", "sim",   "--duration",
                                       duration, "--json",  "--out", folder.path() / "out.obj"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return nendo::test::nendo(arguments);
  }
  std::filesystem::path file() const {
    return hand::calibration_folders().own / hand::calibration_file_name("vera", "", Side::right);
  }
};

std::uint64_t turns_in(const std::string& report) {
  std::uint64_t turns = 0;
  const auto json = nlohmann::json::parse(lines_of(report).back());
  for (const auto& range : json.at("right").at("ranges"))
    turns += range.at("turns").get<std::uint64_t>();
  return turns;
}

} // namespace

TEST_SUITE("kept_ranges") {
  TEST_CASE(
      "what a run has learned of a wearer is a calibration, and the next run continues from it") {
    const Home home;
    const Finished first = home.run({"--adapt", "--user", "vera"});
    REQUIRE_MESSAGE(first.exit_code == 0, first.err);
    CHECK(first.err.find(home.file().string()) != std::string::npos);
    const auto kept = hand::read_calibration(home.file());
    REQUIRE_MESSAGE(kept, kept.error().message);
    CHECK(kept->method == "adapted");
    CHECK(kept->user == "vera");
    const std::uint64_t turns = turns_in(first.out);
    REQUIRE(turns > 0);
    std::size_t lines = 0;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      const auto& quality = kept->quality[slot];
      if (!quality) continue;
      ++lines;
      // The line leads from one end of the joint's usual range to the other.
      const auto& line = kept->calibration.sensors[slot];
      const auto usual = hand::default_calibration({1, true}).sensors[slot];
      CHECK(line.gain_rad_per_count * (quality->max_counts - line.offset_counts) ==
            doctest::Approx(usual.angle_rad(RawCount{1})));
      CHECK(line.gain_rad_per_count * (quality->min_counts - line.offset_counts) ==
            doctest::Approx(usual.angle_rad(RawCount{0})));
    }
    CHECK(lines > 0);

    const Finished second = home.run({"--adapt", "--user", "vera"});
    REQUIRE_MESSAGE(second.exit_code == 0, second.err);
    CHECK(turns_in(second.out) > turns);
    const Finished used = home.run({"--user", "vera"});
    CHECK(used.exit_code == 0);
    CHECK(used.err.find("calibrated for vera") != std::string::npos);
  }

  TEST_CASE("a calibration that was made by poses is not lost to ranges: its slips are learned") {
    const Home home;
    hand::WearerCalibration made;
    made.user = "vera";
    made.method = "full";
    made.calibration = hand::default_calibration();
    REQUIRE(hand::write_calibration(home.file(), made));
    const std::string before = contents(home.file());
    const Finished refused = home.run({"--adapt", "--user", "vera"});
    CHECK(refused.exit_code == 5);
    CHECK(refused.err.find("does not have the ranges of its sensors") != std::string::npos);
    CHECK(contents(home.file()) == before);
    made.quality[4] = hand::SensorQuality{0.01, 40.0, 200.0, 1.0};
    REQUIRE(hand::write_calibration(home.file(), made));
    const std::string with_ends = contents(home.file());
    const Finished run = home.run({"--adapt", "--user", "vera"}, "1");
    REQUIRE_MESSAGE(run.exit_code == 0, run.err);
    CHECK(run.err.find("no sensor has slipped") != std::string::npos);
    const auto json = nlohmann::json::parse(lines_of(run.out).back());
    CHECK(json.at("right").at("slips_counts") == nlohmann::json{{"index_mcp", 0.0}});
    CHECK(contents(home.file()) == with_ends);
  }

  TEST_CASE("without a user nothing is kept, and one who does not move teaches nothing") {
    const Home home;
    CHECK(home.run({"--adapt"}).exit_code == 0);
    CHECK_FALSE(std::filesystem::exists(hand::calibration_folders().own));
    const Finished still = home.run({"--adapt", "--user", "vera"}, "0.2");
    CHECK(still.exit_code == 0);
    CHECK(is_one_line_about(still.err, "learned nothing"));
    CHECK_FALSE(std::filesystem::exists(home.file()));
  }
}

} // namespace kept_ranges_test
