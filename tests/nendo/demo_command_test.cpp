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
      CHECK(done.out.find("left hand") != std::string::npos);
      CHECK(done.out.find("right hand") != std::string::npos);
    }
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
