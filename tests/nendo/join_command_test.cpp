#include <filesystem>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"
#include "support/program.hpp"
#include "support/test_meshes.hpp"

namespace join_command_test {

using namespace nendo::deform;
using nendo::Errc;
using nendo::test::is_one_line_about;
using nendo::test::moved;
using nendo::test::TemporaryFolder;

std::string saved(const TemporaryFolder& folder, const std::string& name, const Mesh& mesh) {
  const auto path = folder.path() / name;
  REQUIRE(write_mesh(path, mesh));
  return path.string();
}

TEST_SUITE("nendo join") {
  TEST_CASE("several files become one closed model") {
    const TemporaryFolder folder;
    const Mesh ball = nendo::test::sphere(20, 30, 1.0);
    const std::string a = saved(folder, "a.obj", ball);
    const std::string b = saved(folder, "b.ply", moved(ball, {1, 0.2, 0.1}));
    const std::string c = saved(folder, "c.obj", moved(ball, {2, 0.2, -0.3}));
    for (const char* seam : {"0", "0.15"}) {
      const std::string out = (folder.path() / (std::string(seam) + ".obj")).string();
      const auto done = nendo::test::nendo({"join", a, b, c, "--seam", seam, "--out", out});
      CHECK(done.exit_code == 0);
      CHECK(done.err.empty());
      CHECK(done.out.find(b + ": ") != std::string::npos);
      CHECK(done.out.find(c + ": ") != std::string::npos);
      CHECK(done.out.find("crossings, volume ") != std::string::npos);
      CHECK(done.out.find(out + ": ") != std::string::npos);
      const auto mesh = read_mesh(out);
      REQUIRE(mesh);
      CHECK(check_closed_manifold(*mesh));
      const double one = volume_of(ball);
      CHECK(volume_of(*mesh) > 1.8 * one);
      CHECK(volume_of(*mesh) < 3.0 * one);
    }
  }

  TEST_CASE("wrong usage and bad files end with one line, and write nothing") {
    const TemporaryFolder folder;
    const Mesh ball = nendo::test::sphere(10, 16, 1.0);
    Mesh open = ball;
    open.face_starts.pop_back();
    open.face_corners.resize(open.face_starts.back());
    const std::string a = saved(folder, "a.obj", ball);
    const std::string b = saved(folder, "b.obj", moved(ball, {1, 0.2, 0.1}));
    const std::string far = saved(folder, "far.obj", moved(ball, {9, 0, 0}));
    const std::string hole = saved(folder, "hole.obj", open);
    const std::string out = (folder.path() / "out.obj").string();
    struct Case {
      std::vector<std::string> arguments;
      int exit_code;
      std::string about;
    };
    for (const Case& wrong : {Case{{"join", a, "--out", out}, 2, "name a second file"},
                              Case{{"join", a, b, "--out", "x.fbx"}, 2, "--out"},
                              Case{{"join", a, b, "--out", a}, 2, "--force"},
                              Case{{"join", a, b, "--seam", "-1", "--out", out}, 2, "--seam"},
                              Case{{"join", a, b, "--seam", "nan", "--out", out}, 2, "--seam"},
                              Case{{"join", a, far, "--out", out}, 1, "do not touch"},
                              Case{{"join", a, hole, "--out", out}, 5, hole + ": is open at"},
                              Case{{"join", a, "/nowhere.obj", "--out", out}, 5, "/nowhere.obj"}}) {
      CAPTURE(wrong.about);
      const auto done = nendo::test::nendo(wrong.arguments);
      CHECK(done.exit_code == wrong.exit_code);
      CHECK(is_one_line_about(done.err, wrong.about));
      CHECK_FALSE(std::filesystem::exists(out));
    }
    CHECK(nendo::test::nendo({"join", a, b, "--out", a, "--force"}).exit_code == 0);
  }
}

} // namespace join_command_test
