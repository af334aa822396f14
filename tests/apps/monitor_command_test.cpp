#include <set>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/driver/sample.hpp>

#include "support/program.hpp"

using nendo::test::EmulatedGlove;
using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nlohmann::json;

namespace {

std::set<std::string> names_in(nendo::SensorMask mask) {
  std::set<std::string> names;
  for (std::size_t slot = 0; slot < nendo::sensor_slots; ++slot) {
    const auto sensor = static_cast<nendo::Sensor>(slot);
    if (mask.has(sensor)) names.emplace(name_of(sensor));
  }
  return names;
}

std::set<std::string> keys_of(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items())
    keys.insert(key);
  return keys;
}

} // namespace

TEST_SUITE("monitor") {
  TEST_CASE(
      "monitor prints one JSON object a sample, with the names of the sensors that the glove has") {
    for (const auto& [sensors, mask] :
         {std::pair{"18", nendo::sensors_18}, std::pair{"22", nendo::sensors_22}}) {
      const nendo::test::TemporaryFolder folder;
      const auto link = folder.path() / "glove";
      const EmulatedGlove glove(link, "left", sensors);
      const auto done = nendo::test::nendo(
          {"monitor", "serial:" + link.string(), "--json", "--raw", "--count", "25"});
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      const auto lines = lines_of(done.out);
      REQUIRE(lines.size() == 25);
      double last_time_s = 0.0;
      for (std::size_t n = 0; n < lines.size(); ++n) {
        const json line = json::parse(lines[n]);
        CHECK(keys_of(line["raw"]) == names_in(mask));
        CHECK(line["hand"] == "left");
        CHECK(line["sequence"] == n + json::parse(lines[0])["sequence"].get<std::size_t>());
        CHECK(line["time_s"].get<double>() >= last_time_s);
        last_time_s = line["time_s"];
        for (const auto& [name, count] : line["raw"].items()) {
          CHECK(count.get<int>() >= 1);
          CHECK(count.get<int>() <= 255);
        }
        CHECK_FALSE(line.contains("angle_rad"));
      }
    }
  }

  TEST_CASE("without --raw angles come along, and a pipe gets JSON without asking") {
    const auto done = nendo::test::nendo({"monitor", "sim:rest?seed=3", "--count", "2"});
    REQUIRE(done.exit_code == 0);
    const json line = json::parse(lines_of(done.out).at(1));
    CHECK(line["hand"] == "right");
    CHECK(line["angle_rad"]["index_mcp"].get<double>() > 0.2); // a relaxed finger is bent
    CHECK(line["angle_rad"]["index_mcp"].get<double>() < 0.8);
  }

  TEST_CASE("what is no glove gets one clear line, the right exit code, and no long wait") {
    const nendo::test::TemporaryFolder folder;
    nendo::test::write_file(folder.path() / "file", "not a terminal");
    struct Case {
      std::string glove;
      int exit_code;
      std::string about;
    };
    for (const Case& c :
         {Case{"serial:/dev/no-such-port", 3, "/dev/no-such-port"},
          Case{"serial:" + (folder.path() / "file").string(), 3, "file"},
          Case{"serial:/dev/null", 3, "/dev/null"}, Case{"bogus:1", 2, "bogus"},
          Case{"/dev/ttyUSB0", 2, "serial:/dev/ttyUSB0"}, Case{"sim:moonwalk", 2, "moonwalk"},
          Case{"sim?rate=0", 2, "rate"}, Case{"", 2, ""}}) {
      const auto done = nendo::test::nendo({"monitor", c.glove, "--count", "1"});
      CAPTURE(c.glove);
      CAPTURE(done.err);
      CHECK(done.exit_code == c.exit_code);
      CHECK(is_one_line_about(done.err, c.about));
      CHECK(done.out.empty());
      CHECK(done.seconds < 5.0);
    }
  }
}
