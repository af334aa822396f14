#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/part_mover.hpp>

#include "support/nasty_meshes.hpp"
#include "support/program.hpp"

namespace cut_command_test {

using namespace nendo;
using nendo::test::is_one_line_about;
using nendo::test::TemporaryFolder;

struct Fixture {
  TemporaryFolder folder;
  std::string place(const std::string& name) const { return (folder.path() / name).string(); }
  std::string save(const std::string& name, const deform::Mesh& mesh) const {
    REQUIRE(deform::write_mesh(place(name), mesh));
    return place(name);
  }
  test::Finished cut(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "cut");
    return ::nendo::test::nendo(arguments);
  }
};

TEST_SUITE("nendo cut") {
  TEST_CASE_FIXTURE(Fixture, "of a model that faces inwards one line reports that it is turned") {
    deform::Mesh mesh = test::cube_of_cells(2);
    for (std::size_t face = 0; face < mesh.face_count(); ++face)
      std::swap(mesh.face_corners[3 * face], mesh.face_corners[3 * face + 1]);
    REQUIRE(deform::volume_of(mesh) < 0.0);
    const std::string in = save("inwards.obj", mesh);
    for (const bool repairs : {false, true}) {
      std::vector<std::string> arguments{in, "--plane", "0.3,0.5,0.5,1,0,0", "--out",
                                         place("part%d.obj")};
      if (repairs) arguments.emplace_back("--repair");
      const auto done = cut(arguments);
      REQUIRE(done.exit_code == 0);
      CHECK(is_one_line_about(done.err, "48 of its faces look inwards"));
      std::vector<double> volumes;
      for (const char* name : {"part1.obj", "part2.obj"}) {
        const auto part = deform::read_mesh(place(name));
        REQUIRE(part);
        CHECK(deform::check_closed_manifold(*part));
        volumes.push_back(deform::volume_of(*part));
      }
      std::sort(volumes.begin(), volumes.end());
      CHECK(volumes[0] == doctest::Approx(0.3).epsilon(1e-11));
      CHECK(volumes[1] == doctest::Approx(0.7).epsilon(1e-11));
    }
  }

  TEST_CASE_FIXTURE(Fixture, "a plane cuts two models at once, and each part is a closed model") {
    const std::string cube = save("cube.obj", test::cube_of_cells(4));
    const std::string ring = save("ring.obj", test::torus(40, 20));
    const auto done =
        cut({cube, ring, "--plane", "0.3,0.5,0.5,1,0,0", "--out", place("%s-part%d.obj")});
    CHECK(done.err == "");
    REQUIRE(done.exit_code == 0);
    double volume = 0.0;
    for (const char* name : {"cube-part1.obj", "cube-part2.obj"}) {
      const auto part = deform::read_mesh(place(name));
      REQUIRE(part);
      CHECK(deform::check_closed_manifold(*part));
      CHECK(part->look.materials.back().name == "cut");
      volume += deform::volume_of(*part);
      CHECK(done.out.find(place(name) + ": ") != std::string::npos);
    }
    CHECK(volume == doctest::Approx(1.0).epsilon(1e-11));
    CHECK(std::filesystem::exists(place("ring-part2.obj")));
    CHECK(!std::filesystem::exists(place("ring-part3.obj")));
  }

  TEST_CASE_FIXTURE(Fixture, "without %d all parts become one file, which is joined again") {
    const std::string cube = save("cube.obj", test::cube_of_cells(4));
    const auto done = cut({cube, "--plane", "0.3,0.5,0.5,1,0.1,0", "--out", place("parts.obj")});
    CHECK(done.err == "");
    REQUIRE(done.exit_code == 0);
    CHECK(done.out.find(", in 2 parts") != std::string::npos);
    auto both = deform::read_mesh(place("parts.obj"));
    REQUIRE(both);
    CHECK(deform::check_closed_manifold(*both));
    CHECK(deform::volume_of(*both) == doctest::Approx(1.0).epsilon(1e-9));
    const auto parts = deform::separate(*both);
    REQUIRE(parts.size() == 2);
    Eigen::Index vertices = 0;
    for (const deform::Mesh& part : parts) {
      CHECK(deform::check_closed_manifold(part));
      vertices += part.vertices.cols();
    }
    CHECK(vertices == both->vertices.cols());
    // The larger one is pressed on again a little deeper.
    const deform::BlockLayout layout(both->vertices);
    const deform::ModelParts of(*both, layout);
    const auto places = layout.places();
    const std::uint32_t larger = deform::volume_of(parts[0]) > 0.5 ? 0 : 1;
    for (std::size_t vertex = 0; vertex < places.size(); ++vertex)
      if (of.at_place(places[vertex]) == larger)
        both->vertices(0, static_cast<Eigen::Index>(vertex)) -= 0.05;
    save("pressed.obj", *both);
    const auto joined = test::nendo({"join", place("pressed.obj"), "--out", place("joined.obj")});
    CHECK(joined.exit_code == 0);
    CHECK(joined.out.find("pressed.obj, part 2: ") != std::string::npos);
    const auto whole = deform::read_mesh(place("joined.obj"));
    REQUIRE(whole);
    CHECK(deform::check_closed_manifold(*whole));
    CHECK(deform::separate(*whole).size() == 1);
    CHECK(deform::volume_of(*whole) == doctest::Approx(0.95).epsilon(0.01));
  }

  TEST_CASE_FIXTURE(Fixture, "a wire's path from a file cuts, and what stays whole is said") {
    const std::string comb = save("comb.ply", test::comb(11));
    test::write_file(place("wire.txt"), "# from tooth to tooth\n"
                                        "-0.05,0.7,-1, -0.05,0.7,2\n"
                                        "0.1 0.7 -1 0.1 0.7 2\n\n"
                                        "0.28,0.7,-1,0.28,0.7,2\n");
    const auto done = cut({comb, "--wire", place("wire.txt"), "--out", place("tooth%d.obj")});
    REQUIRE(done.exit_code == 0);
    CHECK(is_one_line_about(done.err, "is not cut at 4 places"));
    CHECK(std::filesystem::exists(place("tooth3.obj")));
  }

  TEST_CASE_FIXTURE(Fixture, "one model that cannot be cut does not keep the others from it") {
    deform::Mesh open = test::cube_of_cells(2);
    open.face_starts.pop_back();
    open.face_corners.resize(open.face_starts.back());
    const std::string bad = save("open.obj", open);
    const std::string good = save("good.obj", test::cube_of_cells(2));
    const std::vector<std::string> how{"--plane", "0.3,0,0,1,0,0", "--out", place("%s%d.obj")};
    const auto first = cut({bad, good, how[0], how[1], how[2], how[3]});
    CHECK(first.exit_code == 5);
    CHECK(is_one_line_about(first.err, "open.obj: is open at the edge between ("));
    CHECK(first.err.find("--repair") != std::string::npos);
    CHECK(std::filesystem::exists(place("good2.obj")));
    CHECK(!std::filesystem::exists(place("open1.obj")));
    const auto repaired = cut({bad, "--repair", how[0], how[1], how[2], how[3]});
    CHECK(repaired.exit_code == 0);
    CHECK(is_one_line_about(repaired.err, "open.obj: filled 1 hole"));
    CHECK(std::filesystem::exists(place("open2.obj")));
  }

  TEST_CASE_FIXTURE(Fixture, "wrong arguments name themselves and the remedy") {
    const std::string cube = save("cube.obj", test::cube_of_cells(2));
    const std::string plane = "0.3,0,0,1,0,0";
    const std::string out = place("p%d.obj");
    const auto refused = [&](const std::vector<std::string>& arguments, int code,
                             const std::string& about) {
      CAPTURE(about);
      const auto done = cut(arguments);
      CHECK(done.exit_code == code);
      CHECK(is_one_line_about(done.err, about));
    };
    refused({cube, "--out", out}, 2, "--plane and --wire: give one of them");
    refused({cube, "--plane", "1,2,3", "--out", out}, 2, "--plane 1,2,3: use X,Y,Z,NX,NY,NZ");
    refused({cube, "--plane", "1,2,3,0,0,0", "--out", out}, 2, "a normal that is not zero");
    refused({cube, "--plane", "1,2,3,0,nan,1", "--out", out}, 2, "use X,Y,Z,NX,NY,NZ");
    refused({cube, "--plane", plane, "--out", place("p%d.fbx")}, 2, "--out");
    refused({cube, cube, "--plane", plane, "--out", out}, 2, "use a name with %s");
    refused({cube, "--plane", plane, "--out", out, "--edge", "-1"}, 2, "--edge");
    refused({cube, "--plane", "9,0,0,1,0,0", "--out", out}, 1, "cube.obj: is not touched");
    refused({place("none.obj"), "--plane", plane, "--out", out}, 5, "none.obj");
    refused({cube, "--wire", place("none.txt"), "--out", out}, 5, "none.txt");
    test::write_file(place("bad.txt"), "0,0,0,1,1,1\n0,0,x,1,1,1\n");
    refused({cube, "--wire", place("bad.txt"), "--out", out}, 5,
            "bad.txt:2: column 3: 'x' is not a finite number; a row has six");
    test::write_file(place("short.txt"), "0,0,0,1,1,1\n");
    refused({cube, "--wire", place("short.txt"), "--out", out}, 5, "fewer than two positions");
    save("own1.obj", test::cube_of_cells(2));
    refused({place("own1.obj"), "--plane", plane, "--out", place("own%d.obj")}, 2,
            "is the model itself");
  }
}

} // namespace cut_command_test
