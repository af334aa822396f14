#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/driver/sample.hpp>

#include "support/program.hpp"

namespace info_command_test {

using nendo::test::EmulatedGlove;
using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nlohmann::json;

TEST_SUITE("info") {
  TEST_CASE("info says in JSON what the glove is and can do") {
    const nendo::test::TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    const EmulatedGlove glove(link, "left", "18");
    const auto done = nendo::test::nendo({"info", "serial:" + link.string(), "--json"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    REQUIRE(lines_of(done.out).size() == 1);
    const json info = json::parse(done.out);
    CHECK(info["source"] == "serial:" + link.string());
    CHECK(info["model"].get<std::string>().find("CyberGlove") != std::string::npos);
    CHECK(info["hand"] == "left");
    REQUIRE(info["sensors"].size() == 18);
    for (const auto& name : info["sensors"])
      CHECK(name.get<std::string>().find("dip") == std::string::npos);
    // A glove without DIP sensors: those are estimated, the middle finger's direction.
    REQUIRE(info["angles"].size() == 23);
    for (const auto& item : info["angles"].items()) {
      const std::string& angle = item.key();
      const json& source = item.value();
      CAPTURE(angle);
      if (angle == "middle_mcp_abduction") {
        CHECK(source == "from_gaps");
      } else {
        CHECK(source == (angle.find("dip") == std::string::npos ? "measured" : "from_pip"));
      }
    }
    CHECK(info["rate_hz"].is_number());
    CHECK(info["counts"] == json{{"most", 255}, {"whole_range", false}});
    for (const auto* ability : {"wrist_switch", "light", "vibration", "resistance"})
      CHECK(info["abilities"][ability].is_boolean());
    CHECK(info["facts"].is_object());
  }

  TEST_CASE("info for people stands in two columns and fits 80 characters") {
    const auto done = nendo::test::nendo({"info", "sim:rest?hand=left&rate=120"});
    REQUIRE(done.exit_code == 0);
    CHECK(done.out.find("source      sim:rest?hand=left&rate=120\n") != std::string::npos);
    CHECK(done.out.find("hand        left\n") != std::string::npos);
    CHECK(done.out.find("rate        120 Hz\n") != std::string::npos);
    CHECK(done.out.find("sensors     22\n") != std::string::npos);
    for (std::size_t slot = 0; slot < nendo::sensor_slots; ++slot) {
      if (!nendo::sensors_22.has(static_cast<nendo::Sensor>(slot))) continue;
      CHECK(done.out.find(std::string(nendo::sensor_names[slot])) != std::string::npos);
    }
    CHECK(done.out.find("angles      22 of 23 measured") != std::string::npos);
    CHECK(done.out.find("from_gaps   middle_mcp_abduction\n") != std::string::npos);
    for (const auto& line : lines_of(done.out))
      CHECK(line.size() <= 80);
  }

  TEST_CASE("what is no glove gets one clear line and the right exit code") {
    const auto missing = nendo::test::nendo({"info", "serial:/dev/no-such-port"});
    CHECK(missing.exit_code == 3);
    CHECK(is_one_line_about(missing.err, "/dev/no-such-port"));
    const auto unknown = nendo::test::nendo({"info", "bogus:1", "--json"});
    CHECK(unknown.exit_code == 2);
    CHECK(is_one_line_about(unknown.err, "bogus"));
    CHECK(unknown.out.empty());
  }
}

} // namespace info_command_test
