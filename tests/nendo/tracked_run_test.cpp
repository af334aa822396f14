#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/json_lines.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace tracked_run_test {

using namespace nendo;
using nendo::test::is_one_line_about;
using nendo::test::last_object;
using nendo::test::TemporaryFolder;
using nlohmann::json;

TEST_SUITE("tracked_run") {
  TEST_CASE("trackers move two hands round a model, and the take is replayed bit for bit") {
    const TemporaryFolder folder;
    const auto path = [&](const char* name) { return (folder.path() / name).string(); };
    for (const std::string mode : {"type1", "type2"}) {
      const std::string take = path((mode + ".nendo").c_str());
      const auto run = test::nendo(
          {"run", "--left", "sim:pinch", "--right", "sim:pinch", "--left-wrist",
           "sim:orbit?station=1", "--right-wrist", "sim:orbit?station=2", "--mode", mode,
           "--duration", "2", "--json", "--record", take, "--out", path("live.obj"), "--force"});
      CAPTURE(run.err);
      REQUIRE(run.exit_code == 0);
      CHECK(last_object(run)["failed"] == 0);
      const auto replay = test::nendo(
          {"replay", take, "--no-clock", "--json", "--out", path((mode + ".again.obj").c_str())});
      CAPTURE(replay.err);
      REQUIRE(replay.exit_code == 0);
      CHECK(test::contents(path("live.obj")) ==
            test::contents(path((mode + ".again.obj").c_str())));
      const auto info = test::nendo({"recording", "info", take, "--json"});
      REQUIRE(info.exit_code == 0);
      CHECK(last_object(info)["loop"]["poses"].get<int>() > 300); // two stations at 120 Hz
    }
    // One recorded tracker moves other hands.
    const auto again = test::nendo({"run", "--left", "sim", "--left-wrist",
                                    "replay:" + path("type1.nendo") + "?hand=left&end=hold",
                                    "--duration", "1", "--json", "--out", path("other.obj")});
    CAPTURE(again.err);
    CHECK(again.exit_code == 0);
  }

  TEST_CASE("a tracker that cannot be is one line with a remedy") {
    struct Case {
      std::vector<std::string> arguments;
      std::string about;
      int exit_code;
    };
    for (const Case& wrong :
         {Case{{"--left", "sim", "--left-wrist", "sonar:1"}, "unknown kind sonar; known: ", 2},
          Case{{"--left", "sim", "--right-wrist", "sim:orbit"}, "there is no right hand", 2},
          Case{{"--left", "sim", "--left-wrist", "sim:jump"}, "rest, orbit, walk, table, cross", 2},
          Case{{"--left", "sim", "--left-wrist", "sim:orbit?station=17"}, "1 to 16", 2},
          Case{{"--left", "sim", "--left-wrist", "sim:orbit?speed=2"}, "unknown option speed", 2},
          Case{{"--left", "sim", "--right", "sim", "--left-wrist", "sim:orbit", "--right-wrist",
                "sim:orbit"},
               "a station of its own",
               2},
          Case{{"--left", "sim", "--left-wrist", "replay:/no/such.nendo"}, "/no/such.nendo", 5}}) {
      std::vector<std::string> arguments{"run", "--duration", "1"};
      arguments.insert(arguments.end(), wrong.arguments.begin(), wrong.arguments.end());
      const auto run = test::nendo(arguments);
      CAPTURE(run.err);
      CHECK(run.exit_code == wrong.exit_code);
      CHECK(is_one_line_about(run.err, wrong.about));
    }
  }
}

} // namespace tracked_run_test
