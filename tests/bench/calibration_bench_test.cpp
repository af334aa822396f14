// nendo bench calibration, and the wearers that it judges by.

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace calibration_bench_test {

using nendo::test::lines_of;
using nendo::test::TemporaryFolder;

TEST_SUITE("calibration_bench") {
  TEST_CASE("guided poses calibrate strangers: nearer than two poses do, farther than the truth") {
    const auto done =
        nendo::test::nendo({"bench", "calibration", "--wearers", "8", "--seed", "2001", "--json"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto told = nlohmann::json::parse(lines_of(done.out).at(0));
    CHECK(told["wearers"] == 8);
    CHECK(told["refused"] == 0);
    // The wearers do as they are asked, but for slips: of 1.5 mm an axis, and 4 at the palm.
    CHECK(told["touch_gap_m_p95"].get<double>() < 0.012);
    CHECK(told["groups"].size() == 11); // nine, and two of several together
    for (const auto& group : told["groups"].items()) {
      const std::string joints = group.key();
      const auto& methods = group.value();
      CAPTURE(joints);
      const auto median = [&](const char* method) {
        return methods[method]["median_deg"].get<double>();
      };
      const bool fingers_bend = joints.starts_with("finger ") && joints != "finger abduction";
      CHECK(median("full") < (fingers_bend ? 4.0 : 7.0));
      CHECK(median("full") < median("two_pose"));
      CHECK(median("floor") < 1.0); // noise, 8 bits, and sensors that are not straight lines
      CHECK(median("floor") < median("full"));
      CHECK(median("adaptive") > median("floor"));
      // Half a minute of movement teaches about as much as its very minima and maxima.
      CHECK(median("adaptive") < 2.0 * median("min_max") + 2.0);
      CHECK(methods["full"]["p95_deg"].get<double>() > median("full"));
    }
    const auto again =
        nendo::test::nendo({"bench", "calibration", "--wearers", "8", "--seed", "2001", "--json"});
    const auto repeated = nlohmann::json::parse(lines_of(again.out).at(0));
    CHECK(repeated["groups"] == told["groups"]); // the same seed is the same wearer
  }

  TEST_CASE("tables in Markdown have as many columns in each line") {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "wearers.jsonl";
    const auto made =
        nendo::test::nendo({"bench", "wearers", "--wearers", "1", "--seed", "9007", "--out", file});
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const std::vector<std::vector<std::string>> tables{
        {"--wearers", "1"}, {"--judge", file}, {"--judge", file, "--floor"}};
    for (const auto& table : tables) {
      std::vector<std::string> arguments{"bench", "calibration", "--markdown"};
      arguments.insert(arguments.end(), table.begin(), table.end());
      const auto done = nendo::test::nendo(arguments);
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      std::set<std::ptrdiff_t> columns;
      std::size_t rows = 0;
      for (const std::string& line : lines_of(done.out)) {
        if (!line.starts_with('|')) continue;
        ++rows;
        columns.insert(std::count(line.begin(), line.end(), '|') - 1);
      }
      CHECK(rows > 10);
      CHECK(columns.size() == 1);
    }
  }
}

} // namespace calibration_bench_test
