#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "render/image.hpp"
#include "support/prisms.hpp"
#include "support/program.hpp"

namespace concave_model_test {

using namespace nendo;
using nendo::test::TemporaryFolder;

std::string saved(const TemporaryFolder& folder, const std::string& name,
                  const deform::Mesh& mesh) {
  const auto path = folder.path() / name;
  REQUIRE(deform::write_mesh(path, mesh));
  return path.string();
}

/// Of an L or an arrow, whose notch is in the middle of its box.
void check_notch_is_seen(const std::string& mesh, const std::string& out) {
  const auto done =
      test::nendo({"picture", mesh, "--out", out, "--pixels", "120x120", "--camera", "front"});
  REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  const auto image = render::read_png(out);
  REQUIRE(image);
  CHECK(image->at(62, 58) == image->at(118, 58)); // in the notch: what is beside the model
  CHECK(image->at(30, 58) != image->at(118, 58)); // in the arm
}

TEST_SUITE("concave model") {
  TEST_CASE("the notch of an L is seen, as OBJ and as PLY") {
    const TemporaryFolder folder;
    const std::string out = (folder.path() / "l.png").string();
    for (const char* name : {"l.obj", "l.ply"})
      check_notch_is_seen(saved(folder, name, test::l_prism()), out);
  }

  TEST_CASE("a tilted plane cuts an L into two closed files of its volume") {
    const TemporaryFolder folder;
    const std::string mesh = saved(folder, "l.obj", test::l_prism());
    const std::string out = (folder.path() / "part%d.obj").string();
    const auto done =
        test::nendo({"cut", mesh, "--plane", "0.5,0.45,0.5,0.02,1,0.03", "--out", out});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    double volume = 0.0;
    for (const char* name : {"part1.obj", "part2.obj"}) {
      const auto part = deform::read_mesh(folder.path() / name);
      REQUIRE(part);
      CHECK(deform::check_closed_manifold(*part));
      volume += deform::volume_of(*part);
    }
    CHECK(volume == doctest::Approx(5.0));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "part3.obj"));
  }

  TEST_CASE("a run of an L is exported with the area that it has, and stays an L") {
    const TemporaryFolder folder;
    const std::string mesh = saved(folder, "l.obj", test::l_prism());
    const std::string take = (folder.path() / "take.nendo").string();
    const std::string glb = (folder.path() / "take.glb").string();
    const std::string shape = (folder.path() / "shape.obj").string();
    const auto ran = test::nendo({"run", mesh, "--left", "sim:sculpt", "--right", "sim:sculpt",
                                  "--duration", "0.3", "--record", take, "--out", shape});
    REQUIRE_MESSAGE(ran.exit_code == 0, ran.err);
    const auto exported = test::nendo({"export", take, "--out", glb, "--no-hands"});
    REQUIRE_MESSAGE(exported.exit_code == 0, exported.err);
    auto rest = deform::read_mesh(glb);
    REQUIRE_MESSAGE(rest, rest.error().message);
    const deform::Box box = deform::finite_box_of(rest->vertices);
    rest->vertices *= 3.0 / (box.highest.x() - box.lowest.x());
    CHECK(test::area_of(*rest) == doctest::Approx(22.0).epsilon(1e-5));
    const auto written = deform::read_mesh(shape);
    REQUIRE(written);
    CHECK(written->face_corners == test::l_prism().face_corners);
  }
}

} // namespace concave_model_test
