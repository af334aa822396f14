// Runs of several models side by side, and what cuts and edits their parts, as users ask for it.

#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "support/program.hpp"
#include "support/test_meshes.hpp"

namespace run_models_command_test {

using namespace nendo;
using nendo::test::is_one_line_about;

namespace {

struct Fixture {
  test::TemporaryFolder folder;
  std::string place(const std::string& name) const { return (folder.path() / name).string(); }
  std::string save_ball(const std::string& name, double radius) const {
    REQUIRE(deform::write_mesh(place(name), test::sphere(12, 24, radius)));
    return place(name);
  }
  test::Finished run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "run");
    for (const char* more :
         {"--mode", "parts", "--left", "sim:carry", "--right", "sim:carry", "--duration", "1"})
      arguments.emplace_back(more);
    return test::nendo(arguments);
  }
};

} // namespace

TEST_SUITE("run_models_command") {
  TEST_CASE_FIXTURE(Fixture, "a model that is a speck beside the others is reported") {
    const std::string one = save_ball("one.obj", 1.0), fine = save_ball("fine.obj", 0.04),
                      speck = save_ball("speck.obj", 0.001);
    const auto done = run({one, fine, "--out", place("all.obj")});
    CHECK(done.exit_code == 0);
    CHECK(done.err == "");
    const auto report = run({one, fine, speck, "--out", place("all.obj")});
    CHECK(report.exit_code == 0);
    CHECK(is_one_line_about(report.err, "speck.obj"));
    CHECK(report.err.find("1000 times") != std::string::npos);
  }

  TEST_CASE_FIXTURE(Fixture, "several models stand side by side, and their recording replays") {
    const std::string one = save_ball("one.obj", 1.0), two = save_ball("two + a half.ply", 2.5),
                      three = save_ball("three.obj", 0.3);
    const auto done =
        run({one, two, three, "--out", place("all.obj"), "--record", place("a.nendo")});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const auto all = deform::read_mesh(place("all.obj"));
    REQUIRE(all);
    const auto parts = deform::separate(*all);
    REQUIRE(parts.size() == 3);
    CHECK(deform::volume_of(parts[1]) ==
          doctest::Approx(15.625 * deform::volume_of(parts[0])).epsilon(1e-4));
    const auto replayed = test::nendo({"replay", place("a.nendo"), "--out", place("again.obj")});
    CAPTURE(replayed.err);
    REQUIRE(replayed.exit_code == 0);
    CHECK(test::contents(place("again.obj")) == test::contents(place("all.obj")));
    std::filesystem::remove(three);
    const auto missing = test::nendo({"replay", place("a.nendo"), "--out", place("again.obj")});
    CHECK(missing.exit_code == 5);
    CHECK(is_one_line_about(missing.err, "three.obj"));
  }

  TEST_CASE_FIXTURE(Fixture, "none of several models is overwritten, and a missing one is named") {
    const std::string one = save_ball("one.obj", 1.0), two = save_ball("two.obj", 2.0);
    const auto refused = run({one, two, "--out", two});
    CHECK(refused.exit_code == 2);
    CHECK(is_one_line_about(refused.err, "--out"));
    const auto missing = run({one, place("none.obj"), "--out", place("all.obj")});
    CHECK(missing.exit_code == 5);
    CHECK(is_one_line_about(missing.err, "none.obj"));
    CHECK_FALSE(std::filesystem::exists(place("all.obj")));
  }

  TEST_CASE_FIXTURE(Fixture, "a wire or a knife is drawn from one time to another, and not both") {
    const std::string ball = save_ball("ball.obj", 1.0);
    for (const auto& [option, value] :
         {std::pair{"--knife", "1"}, {"--knife", "2s:1s"}, {"--wire", "x:y"}, {"--wire", "1s:"}}) {
      const auto refused = run({ball, option, value, "--out", place("all.obj")});
      CHECK(refused.exit_code == 2);
      CHECK(is_one_line_about(refused.err, option));
    }
    const auto both = run({ball, "--knife", "0s:1s", "--wire", "0s:1s", "--out", place("all.obj")});
    CHECK(both.exit_code == 2);
    CHECK(is_one_line_about(both.err, "--wire and --knife"));
  }
}

} // namespace run_models_command_test
