// Takes in layers on the command line: nendo run --over.

#include <array>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/json_lines.hpp"
#include "support/program.hpp"

namespace overdub_command_test {

using namespace nendo;
using nendo::test::TemporaryFolder;

namespace {

struct Takes {
  TemporaryFolder folder;
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }

  /// Runs `nendo run`, recorded as `name`.nendo.
  test::Finished run(std::vector<std::string> arguments, const std::string& name) const {
    arguments.insert(arguments.begin(), "run");
    for (const std::string& more : {std::string("--record"), path(name + ".nendo"),
                                    std::string("--out"), path(name + ".obj")})
      arguments.push_back(more);
    return test::nendo(arguments);
  }
  nlohmann::json replayed(const std::string& name) const {
    return last_object(test::nendo({"replay", path(name + ".nendo"), "--no-clock", "--json"}));
  }
  nlohmann::json info(const std::string& name) const {
    return last_object(test::nendo({"recording", "info", path(name + ".nendo"), "--json"}));
  }
};

} // namespace

TEST_SUITE("overdub_command") {
  TEST_CASE("mouth first, then brows, then both again: each take is replayed bit for bit") {
    const Takes takes;
    const auto mouth = takes.run({"--puppet", "face", "--left", "sim:faces", "--right", "sim:faces",
                                  "--layer", "left.thumb,right.index", "--duration", "1.5"},
                                 "mouth");
    CAPTURE(mouth.err);
    REQUIRE(mouth.exit_code == 0);
    const auto brows = takes.run({"--over", takes.path("mouth.nendo"), "--right", "sim:wave",
                                  "--layer", "right.ring,right.little", "--punch", "0.5s:1s"},
                                 "brows");
    CAPTURE(brows.err);
    REQUIRE(brows.exit_code == 0);
    CHECK(brows.err.find("punched in") != std::string::npos);
    CHECK(brows.err.find("punched out") != std::string::npos);
    const auto round = takes.run({"--over", takes.path("brows.nendo"), "--left", "sim:wave",
                                  "--loop", "0.2s:0.6s", "--duration", "2"},
                                 "round");
    CAPTURE(round.err);
    REQUIRE(round.exit_code == 0);
    for (const auto& [name, gloves, ticks] :
         {std::tuple{"mouth", 2U, 135U}, {"brows", 3U, 135U}, {"round", 4U, 180U}}) {
      const std::string named = name;
      CAPTURE(named);
      const auto replay = takes.replayed(name);
      CHECK(replay["exact"] == true);
      CHECK(replay["same_shape"] == true);
      const auto info = takes.info(name);
      CHECK(info["gloves"].size() == gloves);
      CHECK(info["gloves"][0]["layer"]["plays"] == "left.thumb");
      CHECK(info["gloves"][1]["layer"]["plays"] == "right.index");
      if (gloves > 2) {
        CHECK(info["gloves"][2]["layer"]["plays"] == "right.ring,right.little");
        CHECK(info["gloves"][2]["layer"]["punches"] >= 2);
        CHECK(info["gloves"][2]["layer"]["in_at_first"] == false);
      }
      if (gloves > 3) CHECK(info["gloves"][3]["layer"]["plays"] == "left");
      CHECK(replay["ticks"].get<unsigned>() >= ticks / 2); // on a machine that is late
      CHECK(replay["ticks"].get<unsigned>() <= ticks + 30);
      CHECK(
          test::nendo({"recording", "check", takes.path(std::string(name) + ".nendo")}).exit_code ==
          0);
    }
  }

  TEST_CASE("the other hand joins a take of one hand, and holds the model with it") {
    const Takes takes;
    const std::string model = NENDO_MODELS "/head.obj";
    REQUIRE(takes
                .run({model, "--left", "sim:sculpt", "--duration", "0.6", "--radius", "3,3,4,3,3"},
                     "left")
                .exit_code == 0);
    const auto both =
        takes.run({"--over", takes.path("left.nendo"), "--right", "sim:sculpt"}, "both");
    CAPTURE(both.err);
    REQUIRE(both.exit_code == 0);
    CHECK(takes.replayed("both")["same_shape"] == true);
  }

  TEST_CASE("what contradicts the take, or is none, is refused in one line") {
    const Takes takes;
    const auto made = takes.run({"--puppet", "moai", "--left", "sim", "--duration", "0.3"}, "take");
    REQUIRE(made.exit_code == 0);
    const std::string take = takes.path("take.nendo");
    using Arguments = std::vector<std::string>;
    const std::vector<std::pair<Arguments, std::string>> wrong{
        {{"--over", take, "--mode", "type1"}, "--mode: cannot be combined with --over"},
        {{"--over", take, "--rate", "90"}, "--rate: cannot be combined with --over"},
        {{"--over", take, "--left-wrist", "sim:orbit"},
         "--left-wrist: cannot be combined with --over"},
        {{"--over", take, "--pinches", "measured"}, "--pinches: cannot be combined with --over"},
        {{"--over", take, "--puppet", "face"}, "--puppet: cannot be combined with --over"},
        {{NENDO_MODELS "/head.obj", "--over", take}, "is not the model of"},
        {{"--over", take, "--layer", "left.toe"}, "--layer left.toe: use left, right"},
        {{"--over", take, "--left", "sim", "--layer", "left,right"},
         "--layer: no glove plays the right"},
        {{"--over", take, "--left", "sim", "--right", "sim", "--layer", "right"},
         "--left: the layer does not contain that hand"},
        {{"--over", take, "--punch", "9s:10s"}, "--punch 9s:10s: the recording lasts"},
        {{"--over", take, "--punch", "5"}, "--punch 5: use two times"},
        {{"--over", take, "--loop", "0.2s:0.1s"}, "--loop 0.2s:0.1s: ends before it begins"},
        {{"--over", take, "--loop", "0:0.1"}, "use 0.2 s at least"},
        {{"--punch", "1s:2s"}, "--punch: needs --over"},
        {{"--over", takes.path("take.obj")}, "is no recording"},
        {{"--over", takes.path("missing.nendo")}, "missing.nendo"},
    };
    for (const auto& [arguments, message] : wrong) {
      const std::string wanted = message;
      CAPTURE(wanted);
      const auto refused = takes.run(arguments, "refused");
      CAPTURE(refused.err);
      CHECK(refused.exit_code != 0);
      CHECK(refused.err.find(message) != std::string::npos);
    }
  }
}

} // namespace overdub_command_test
