#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "support/glb_reader.hpp"
#include "support/program.hpp"

namespace export_command_test {

using namespace nendo;
using nendo::test::contents;
using nendo::test::is_one_line_about;
using nlohmann::json;

namespace {

/// A folder with a short recorded run in it.
struct RecordedRun {
  explicit RecordedRun(const std::string& mode) {
    const auto done = test::nendo({"run", "--left", "sim:pinch", "--right", "sim:grasp", "--mode",
                                   mode, "--duration", "1", "--out", path("clay.ply"), "--record",
                                   path("take.nendo"), "--no-injective"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  test::Finished export_to(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"export", path("take.nendo"), "--out", path(out), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::nendo(arguments);
  }
  test::TemporaryFolder folder;
};

} // namespace

TEST_SUITE("export_command") {
  TEST_CASE("every format of a run comes out, and the last frame is the run's own shape") {
    const RecordedRun run("type1");
    const auto shape = deform::read_mesh(run.path("clay.ply"));
    REQUIRE(shape);
    const double near = 1e-5 * deform::diagonal_of(shape->vertices);
    const auto done = run.export_to("take.glb");
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const json told = json::parse(done.out);
    CHECK(told["morphs"]["by"] == "control vectors");
    CHECK(told["morphs"]["greatest_error"].get<double>() < 1e-5);
    CHECK(told["frames"].get<int>() > 10);
    const test::Glb glb(contents(run.path("take.glb")));
    CHECK((glb.vertices(0, 1e6) - shape->vertices).colwise().norm().maxCoeff() < near);
    for (const std::string out : {"a.pc2", "a.mdd", "hands.bvh", "a.csv", "a-%03d.obj"}) {
      const auto other = run.export_to(out);
      CAPTURE(other.err);
      CHECK(other.exit_code == 0);
      CHECK(std::filesystem::exists(json::parse(other.out)["result"].get<std::string>()));
    }
    CHECK(run.export_to("cache.dat", {"--format", "pc2", "--rate", "10"}).exit_code == 0);
    CHECK(contents(run.path("cache.dat")).starts_with("POINTCACHE2"));
    const auto plain = test::nendo({"export", run.path("take.nendo"), "--out", run.path("b.glb")});
    CHECK(plain.out.find(" morph targets of the control vectors") != std::string::npos);
  }

  TEST_CASE("every format says whether something was missing in the recording") {
    const RecordedRun run("type1");
    const std::string whole = contents(run.path("take.nendo"));
    std::string damaged = whole;
    const std::size_t input_log = damaged.find("TAPE");
    REQUIRE(input_log != std::string::npos);
    damaged[input_log + 40] = static_cast<char>(damaged[input_log + 40] ^ 1);
    for (const std::string out : {"a.glb", "a.pc2", "a.mdd", "hands.bvh", "a.csv", "a-%03d.obj"}) {
      CAPTURE(out);
      test::write_file(run.path("take.nendo"), whole);
      const auto exact = run.export_to(out);
      REQUIRE(exact.exit_code == 0);
      CHECK(exact.err.empty());
      CHECK(json::parse(exact.out)["exact"] == true);
      test::write_file(run.path("take.nendo"), damaged);
      const auto other = run.export_to(out);
      REQUIRE(other.exit_code == 0);
      CHECK(is_one_line_about(other.err, "something is missing"));
      CHECK(json::parse(other.out)["exact"] == false);
    }
  }

  TEST_CASE("Type-2 keeps within its tolerance, and says so") {
    const RecordedRun run("type2");
    const auto done = run.export_to("take.glb", {"--tolerance", "1e-3", "--no-hands"});
    REQUIRE(done.exit_code == 0);
    const json told = json::parse(done.out);
    CHECK(told["morphs"]["by"] == "key shapes");
    CHECK(told["morphs"]["greatest_error"].get<double>() < 1.01e-3);
    CHECK_FALSE(test::Glb(contents(run.path("take.glb"))).json.contains("skins"));
  }

  TEST_CASE("wrong usage and files that are no takes are one line each") {
    const test::TemporaryFolder folder;
    const std::string text = (folder.path() / "a.nendo").string();
    test::write_file(text, "no recording");
    const auto run = [&](std::vector<std::string> more) {
      std::vector<std::string> arguments{"export", text};
      arguments.insert(arguments.end(), more.begin(), more.end());
      return test::nendo(arguments);
    };
    struct Row {
      std::vector<std::string> arguments;
      int exit_code;
      const char* about;
    };
    for (const Row& row :
         std::initializer_list<Row>{{{"--out", "a.glb"}, 5, "a.nendo"},
                                    {{"--out", "a.fbx"}, 2, "--out a.fbx"},
                                    {{"--out", "/nowhere/a.glb"}, 1, "/nowhere"},
                                    {{"--out", "a.obj"}, 2, "%04d"},
                                    {{"--out", "a-%d.ply", "--format", "obj"}, 2, ".obj"},
                                    {{"--out", "a.glb", "--rate", "0"}, 2, "--rate"},
                                    {{"--out", "a.glb", "--from", "2", "--to", "1"}, 2, "--from"},
                                    {{"--out", "a.glb", "--tolerance", "0"}, 2, "--tolerance"},
                                    {{"--out", "a.glb", "--format", "fbx"}, 2, "fbx"}}) {
      const auto done = run(row.arguments);
      CAPTURE(done.err);
      CHECK(done.exit_code == row.exit_code);
      CHECK(is_one_line_about(done.err, row.about));
    }
  }
}

} // namespace export_command_test
