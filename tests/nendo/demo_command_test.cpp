#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "render/image.hpp"
#include "support/program.hpp"

namespace demo_command_test {

using namespace nendo;
using nendo::test::is_one_line_about;
using nendo::test::TemporaryFolder;

TEST_SUITE("demo") {
  TEST_CASE("both emulated gloves shape the model, and a picture is left") {
    for (const std::string what : {"face", "moai"}) {
      CAPTURE(what);
      const TemporaryFolder folder;
      const auto out = (folder.path() / "shape.obj").string();
      const auto picture = (folder.path() / "shape.png").string();
      const auto done =
          test::nendo({"demo", what, "--duration", "1.5", "--out", out, "--picture", picture});
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      const auto shaped = deform::read_mesh(out);
      REQUIRE(shaped);
      const auto model = deform::read_mesh(std::filesystem::path(NENDO_PROGRAM).parent_path() /
                                           "../share/nendo/models/" / (what + ".obj"));
      REQUIRE(model);
      REQUIRE(shaped->vertices.cols() == model->vertices.cols());
      CHECK((shaped->vertices - model->vertices).cwiseAbs().maxCoeff() > 0.001);
      CHECK(render::read_png(picture));
      CHECK(std::filesystem::exists(folder.path() / "shape.nendo"));
      CHECK(std::filesystem::file_size(folder.path() / "shape.glb") > 100'000);
      CHECK(done.out.find("left hand") != std::string::npos);
      CHECK(done.out.find("right hand") != std::string::npos);
    }
  }

  TEST_CASE("a face's picture has an expression for each that was played, which differ") {
    const TemporaryFolder folder;
    const auto at = [&](const char* name) { return (folder.path() / name).string(); };
    const auto done = test::nendo(
        {"demo", "--duration", "4.9", "--out", at("shape.obj"), "--picture", at("shape.png")});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto sheet = render::read_png(at("shape.png"));
    REQUIRE(sheet);
    CHECK(sheet->size().width > 2 * 520); // at rest and smile, frown below
    const auto panel_differs = [&](int one, int other) {
      int differing = 0;
      for (int y = 100; y < 400; ++y)
        for (int x = 100; x < 420; ++x)
          differing += sheet->at(x + one * 530, y) != sheet->at(x + other * 530, y) ? 1 : 0;
      return differing;
    };
    CHECK(panel_differs(0, 1) > 2000);
    // A second demo takes the place of the first.
    const auto again = test::nendo(
        {"demo", "--duration", "1", "--out", at("shape.obj"), "--picture", at("shape.png")});
    CHECK_MESSAGE(again.exit_code == 0, again.err);
  }

  TEST_CASE("wrong words are refused in one line before anything runs") {
    const auto mode = test::nendo({"demo", "--mode", "type3"});
    CHECK(mode.exit_code == 2);
    CHECK(is_one_line_about(mode.err, "--mode"));
    const auto what = test::nendo({"demo", "cube"});
    CHECK(what.exit_code == 2);
    CHECK(is_one_line_about(what.err, "cube"));
    const auto duration = test::nendo({"demo", "--duration", "0"});
    CHECK(duration.exit_code == 2);
    CHECK(is_one_line_about(duration.err, "--duration"));
    const auto ending = test::nendo({"demo", "--picture", "moai.txt"});
    CHECK(ending.exit_code == 2);
    CHECK(is_one_line_about(ending.err, "--picture"));
  }
}

} // namespace demo_command_test
