#include <filesystem>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "render/image.hpp"
#include "support/program.hpp"
#include "support/test_meshes.hpp"

namespace picture_command_test {

using namespace nendo;
using nendo::test::is_one_line_about;
using nendo::test::TemporaryFolder;
using render::read_png;
using render::Size;

namespace {

struct Folder {
  TemporaryFolder folder;
  std::string mesh = (folder.path() / "ball.obj").string();
  std::string out = (folder.path() / "ball.png").string();

  Folder() { REQUIRE(deform::write_mesh(mesh, test::sphere(12, 24, 1.0))); }
  test::Finished picture(std::vector<std::string> more) const {
    more.insert(more.begin(), {"picture", mesh, "--out", out});
    return test::nendo(more);
  }
};

} // namespace

TEST_SUITE("picture") {
  TEST_CASE("a picture has the size that was asked for, and the same bytes each time") {
    const Folder with;
    const auto done = with.picture({"--pixels", "120x90"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto image = read_png(with.out);
    REQUIRE(image);
    CHECK(image->size() == Size{120, 90});
    const auto bytes = test::contents(with.out);
    REQUIRE(with.picture({"--pixels", "120x90"}).exit_code == 0);
    CHECK(test::contents(with.out) == bytes);
    REQUIRE(with.picture({"--pixels", "120x90", "--camera", "top"}).exit_code == 0);
    CHECK(test::contents(with.out) != bytes);
  }

  TEST_CASE("a turntable is one sheet, or numbered files") {
    const Folder with;
    REQUIRE(with.picture({"--pixels", "64x64", "--turntable", "4"}).exit_code == 0);
    const auto sheet = read_png(with.out);
    REQUIRE(sheet);
    CHECK(sheet->size().width > 128);
    REQUIRE(with.picture({"--pixels", "64x64", "--turntable", "3", "--numbered"}).exit_code == 0);
    for (const char* name : {"ball-00.png", "ball-01.png", "ball-02.png"}) {
      const auto image = read_png(with.folder.path() / name);
      REQUIRE(image);
      CHECK(image->size() == Size{64, 64});
    }
    CHECK_FALSE(std::filesystem::exists(with.folder.path() / "ball-03.png"));
  }

  TEST_CASE("wrong arguments get one line, and nothing is written") {
    const Folder with;
    const auto refused = [&](std::vector<std::string> more, const std::string& what, int code) {
      const auto done = with.picture(std::move(more));
      CAPTURE(done.err);
      CHECK(done.exit_code == code);
      CHECK(is_one_line_about(done.err, what));
      CHECK_FALSE(std::filesystem::exists(with.out));
    };
    refused({"--camera", "up"}, "--camera up", 2);
    refused({"--colour", "distance"}, "--colour distance", 2);
    refused({"--colour", "red"}, "--colour red", 2);
    refused({"--pixels", "0x0"}, "--pixels 0x0", 2);
    refused({"--pixels", "8192x8192", "--turntable", "9"}, "--pixels", 2);
    refused({"--turntable", "1"}, "--turntable", 2);
    refused({"--turntable", "4", "--strip", "4"}, "--strip", 2);
    refused({"--strip", "3", "--key-poses", "3"}, "--key-poses", 2);
    refused({"--key-poses", "1"}, "--key-poses", 2);
    refused({"--key-poses", "3"}, "no times", 2);
    refused({"--turntable", "2", "--captions", "one"}, "--captions", 2);
    refused({"--time", "1"}, "no times", 2);
    refused({"--time", "1", "--strip", "3"}, "give one of them", 2);
    refused({"--time", "0,1", "--captions", "one"}, "--captions", 2);
    refused({"--numbered"}, "--numbered", 2);
    const auto missing = test::nendo({"picture", "no.obj", "--out", with.out});
    CHECK(missing.exit_code == 5);
    CHECK(is_one_line_about(missing.err, "no.obj"));
    const std::string folder = std::filesystem::path(with.out).parent_path().string();
    const auto of_folder = test::nendo({"picture", folder, "--out", with.out});
    CHECK(of_folder.exit_code == 5);
    CHECK(is_one_line_about(of_folder.err, folder + ": is a folder"));
    const auto named = test::nendo({"picture", with.mesh, "--out", "picture.jpg"});
    CHECK(named.exit_code == 2);
    CHECK(is_one_line_about(named.err, ".png"));
  }

  TEST_CASE("a recording is drawn at any of its moments, and the last one is the live run's") {
    const Folder with;
    const auto shape = (with.folder.path() / "shape.obj").string();
    const auto take = (with.folder.path() / "take.nendo").string();
    const auto done = test::nendo({"run", "--right", "sim:touch", "--mesh", with.mesh, "--duration",
                                   "1.5", "--out", shape, "--record", take});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto drawn = [&](std::vector<std::string> more) {
      more.insert(more.begin(), {"picture", take, "--out", with.out, "--pixels", "96x96"});
      const auto made = test::nendo(more);
      CAPTURE(made.err);
      CHECK(made.exit_code == 0);
      return test::contents(with.out);
    };
    const auto first = drawn({"--time", "0"});
    CHECK(drawn({"--time", "1.4"}) != first);
    CHECK(drawn({"--time", "0"}) == first);
    drawn({"--time", "0,1.4"});
    const auto both = read_png(with.out);
    REQUIRE(both);
    CHECK(both->size().width >= 192);
    // The simulated glove's first sample came before the run began, or at its begin.
    CHECK(drawn({"--time", "0.5", "--glove-time"}) != first);
    drawn({"--strip", "3"});
    const auto strip = read_png(with.out);
    REQUIRE(strip);
    CHECK(strip->size().width > 192);
    const auto plain = drawn({"--key-poses", "3"});
    CHECK(drawn({"--key-poses", "3", "--captions", "a,b,c"}) != plain);
    const auto coloured = drawn({"--time", "1.4", "--colour", "distance"});
    CHECK(coloured != drawn({"--time", "1.4"}));
    const auto report = test::nendo({"picture", take, "--out", with.out, "--pixels", "96x96",
                                     "--time", "1.4", "--colour", "distance"});
    CHECK(report.err.find("dark red: displaced by 0.") != std::string::npos);
    const auto image = read_png(with.out);
    REQUIRE(image);
    int red = 0; // pixels that went far
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x)
        red += image->at(x, y)[0] > 2 * image->at(x, y)[2] ? 1 : 0;
    CHECK(red > 20);
    CHECK(red < 96 * 96 / 4);
    const auto late = test::nendo({"picture", take, "--out", with.out, "--time", "9"});
    CHECK(late.exit_code == 2);
    CHECK(is_one_line_about(late.err, "--time 9"));
    const auto word = test::nendo({"picture", take, "--out", with.out, "--time", "0,soon"});
    CHECK(word.exit_code == 2);
    CHECK(is_one_line_about(word.err, "--time soon"));
    std::filesystem::remove(with.mesh);
    const auto gone = test::nendo({"picture", take, "--out", with.out});
    CHECK(gone.exit_code == 5);
    CHECK(is_one_line_about(gone.err, "ball.obj"));
  }

  TEST_CASE("a run leaves a picture of before and after, and a window without a screen says so") {
    const Folder with;
    const auto shape = (with.folder.path() / "shape.obj").string();
    const auto done =
        test::nendo({"run", "--left", "sim:sculpt", "--right", "sim:sculpt", "--mesh", with.mesh,
                     "--duration", "0.5", "--out", shape, "--picture", with.out});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto image = read_png(with.out);
    REQUIRE(image);
    CHECK(image->size().width > image->size().height); // beside each other
    const auto wrong =
        test::nendo({"run", "--duration", "1", "--out", shape, "--picture", "x.obj"});
    CHECK(wrong.exit_code == 2);
    CHECK(is_one_line_about(wrong.err, "--picture x.obj"));
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    const auto blind = test::nendo({"view", "--duration", "1", "--out", shape});
    CHECK(blind.exit_code == 1);
    CHECK(is_one_line_about(blind.err, "nendo picture"));
  }
}

} // namespace picture_command_test
