#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/recording/setup.hpp>

#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"
#include "support/program.hpp"
#include "takes/model_files.hpp"

namespace repair_command_test {

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
  std::string text_of(const std::string& path) const {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

deform::Mesh loose(const deform::Mesh& mesh) {
  deform::Mesh soup = mesh;
  soup.vertices.resize(3, static_cast<Eigen::Index>(mesh.face_corners.size()));
  for (std::uint32_t at = 0; at < mesh.face_corners.size(); ++at) {
    soup.vertices.col(at) = mesh.vertices.col(mesh.face_corners[at]);
    soup.face_corners[at] = at;
  }
  return soup;
}

deform::Mesh open_cube(int cells) {
  deform::Mesh mesh = test::cube_of_cells(cells);
  mesh.face_starts.pop_back();
  mesh.face_corners.resize(mesh.face_starts.back());
  return mesh;
}

TEST_SUITE("nendo repair") {
  TEST_CASE_FIXTURE(Fixture, "what it did is said line by line, and the model is closed") {
    deform::Mesh mesh = open_cube(2);
    mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
    mesh.vertices.rightCols<1>().setConstant(50.0);
    const std::string in = save("in.obj", mesh);
    const auto done = test::nendo({"repair", in, "--out", place("out.ply")});
    CHECK(is_one_line_about(done.err, "belongs to no face"));
    REQUIRE(done.exit_code == 0);
    CHECK(done.out == in + ": filled 1 hole\n" + in + ": dropped 1 vertex without a face\n" +
                          place("out.ply") + ": 26 vertices, 48 faces, volume 1\n");
    const auto repaired = deform::read_mesh(place("out.ply"));
    REQUIRE(repaired);
    CHECK(deform::check_closed_manifold(*repaired));
    const auto json = test::nendo({"repair", in, "--out", place("out.ply"), "--json"});
    CHECK(json.out.find("\"filled_holes\":1,") != std::string::npos);
    CHECK(json.out.find("\"dropped_vertices\":1,") != std::string::npos);
  }

  TEST_CASE_FIXTURE(Fixture, "a flap on an edge is left out in one line, and what is left is cut") {
    deform::Mesh mesh = test::cube_of_cells(2);
    mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
    mesh.vertices.rightCols<1>() << 0.5, 0.5, 2.0;
    test::add_face(mesh, {mesh.face_corners[0], mesh.face_corners[1], 26});
    const std::string in = save("in.obj", mesh);
    const auto done = test::nendo({"repair", in, "--out", place("out.obj"), "--json"});
    REQUIRE(done.exit_code == 0);
    CHECK(done.out.find("\"left_out_faces\":1,") != std::string::npos);
    CHECK(done.out.find("\"volume\":1.0") != std::string::npos);
    const auto report = test::nendo({"repair", in, "--out", place("out.obj")});
    CHECK(report.out.find(in + ": left out 1 face at (") != std::string::npos);
    const std::vector<std::string> plane{"--plane", "0.4,0,0,1,0,0"};
    const auto cut =
        test::nendo({"cut", in, plane[0], plane[1], "--repair", "--out", place("p%d.obj")});
    CHECK(cut.exit_code == 0);
    CHECK(cut.err.find("left out 1 face at (") != std::string::npos);
  }

  TEST_CASE_FIXTURE(Fixture,
                    "runs tell before they begin what keeps hands from knowing an inside") {
    const auto run = [&](const std::string& model, const char* mode) {
      return test::nendo({"run", model, "--mode", mode, "--left", "sim:press", "--duration", "0.1",
                          "--out", place("run.obj"), "--force"});
    };
    const auto open = run(save("open.obj", open_cube(3)), "clay");
    CHECK(open.exit_code == 0);
    CHECK(is_one_line_about(open.err, "is open at the edge between"));
    CHECK(open.err.find("`nendo repair IN --out OUT` closes it") != std::string::npos);
    const auto sheet = run(save("sheet.obj", test::grid(6, 1.0)), "clay");
    CHECK(is_one_line_about(sheet.err, "is a sheet without an inside"));
    CHECK(run(place("open.obj"), "type1").err == "");
    deform::Mesh inwards = test::cube_of_cells(3);
    for (std::size_t face = 0; face < inwards.face_count(); ++face)
      std::swap(inwards.face_corners[3 * face], inwards.face_corners[3 * face + 1]);
    const std::string turned = save("inwards.obj", inwards);
    for (const char* mode : {"clay", "parts", "type1"})
      CHECK(is_one_line_about(run(turned, mode).err, "108 of its 108 faces look inwards"));
    REQUIRE(test::nendo({"repair", turned, "--out", place("outwards.obj")}).exit_code == 0);
    CHECK(run(place("outwards.obj"), "clay").err == "");
  }

  TEST_CASE_FIXTURE(Fixture, "a model without faults is written as it was, to the bit") {
    const std::string in = save("in.obj", test::torus(20, 10));
    const auto done = test::nendo({"repair", in, "--out", place("out.obj")});
    REQUIRE(done.exit_code == 0);
    CHECK(done.out.starts_with(in + ": nothing to repair\n"));
    CHECK(text_of(in) == text_of(place("out.obj")));
  }

  TEST_CASE_FIXTURE(Fixture, "wrong usage and what cannot be repaired end with one line") {
    const std::string in = save("in.obj", test::grid(3, 1.0));
    const std::string out = place("out.obj");
    const auto refused = [&](const std::vector<std::string>& arguments, int code,
                             const std::string& about) {
      CAPTURE(about);
      const auto done = test::nendo(arguments);
      CHECK(done.exit_code == code);
      CHECK(is_one_line_about(done.err, about));
      CHECK(done.out.empty());
      CHECK(!std::filesystem::exists(out));
    };
    refused({"repair", in, "--out", out}, 5, "is a sheet without an inside");
    refused({"repair", in, "--out", in}, 2, "--force");
    refused({"repair", in, "--out", out, "--tolerance", "-1"}, 2, "--tolerance");
    refused({"repair", "/nowhere.obj", "--out", out}, 5, "/nowhere.obj");
  }

  TEST_CASE_FIXTURE(Fixture, "what other commands advise works: repair, and --force") {
    const std::string bad = save("bad.obj", open_cube(3));
    const std::string ball =
        save("ball.obj", test::moved(test::sphere(12, 16, 0.4), {1, 0.5, 0.5}));
    const std::string good = place("good.obj");
    const std::vector<std::string> plane{"--plane", "0.4,0,0,1,0,0"};
    const auto cut = test::nendo({"cut", bad, plane[0], plane[1], "--out", place("p%d.obj")});
    CHECK(cut.err.find("`nendo repair " + bad + " --out OUT`") != std::string::npos);
    CHECK(cut.err.find("--repair") != std::string::npos);
    const auto join = test::nendo({"join", bad, ball, "--out", place("j.obj")});
    CHECK(join.err.find("`nendo repair IN --out OUT`") != std::string::npos);
    const std::vector<std::string> run{
        "run",    "--mesh",    bad,          "--refine", "400",   "--mode",        "clay",
        "--left", "sim:press", "--duration", "0.1",      "--out", place("run.obj")};
    const auto refine = test::nendo(run);
    CHECK(refine.exit_code == 5);
    CHECK(refine.err.find("`nendo repair IN --out OUT`") != std::string::npos);
    // That is done.
    REQUIRE(test::nendo({"repair", bad, "--out", good}).exit_code == 0);
    CHECK(test::nendo({"cut", good, plane[0], plane[1], "--out", place("p%d.obj")}).exit_code == 0);
    CHECK(test::nendo({"cut", bad, plane[0], plane[1], "--repair", "--out", place("q%d.obj")})
              .exit_code == 0);
    CHECK(test::nendo({"join", good, ball, "--out", place("j.obj")}).exit_code == 0);
    std::vector<std::string> again = run;
    again[2] = good;
    CHECK(test::nendo(again).exit_code == 0);
    // A part in the place of the model itself.
    const std::vector<std::string> over{"cut", good, plane[0], plane[1], "--out", good};
    const auto spared = test::nendo(over);
    CHECK(spared.exit_code == 2);
    CHECK(is_one_line_about(spared.err, "add --force"));
    std::vector<std::string> forced = over;
    forced.emplace_back("--force");
    CHECK(test::nendo(forced).exit_code == 0);
    const auto parts = deform::read_mesh(good);
    REQUIRE(parts);
    CHECK(deform::separate(*parts).size() == 2);
    const std::string inwards = [&] {
      deform::Mesh mesh = test::cube_of_cells(2);
      for (std::size_t face = 0; face < mesh.face_count(); ++face)
        std::swap(mesh.face_corners[3 * face], mesh.face_corners[3 * face + 1]);
      return save("inwards.obj", mesh);
    }();
    CHECK(is_one_line_about(test::nendo({"join", inwards, ball, "--out", place("j.obj")}).err,
                            "faces inwards"));
    REQUIRE(test::nendo({"repair", inwards, "--out", place("outwards.obj")}).exit_code == 0);
    CHECK(test::nendo({"join", place("outwards.obj"), ball, "--out", place("j.obj")}).exit_code ==
          0);
  }

  TEST_CASE_FIXTURE(Fixture, "soup is whole for cutting, joining, refining, parts and clay") {
    const std::string soup = save("soup.ply", loose(test::cube_of_cells(3)));
    const std::string ball =
        save("ball.obj", test::moved(test::sphere(12, 16, 0.4), {1, 0.5, 0.5}));
    CHECK(test::nendo({"cut", soup, "--plane", "0.4,0,0,1,0,0", "--out", place("p%d.obj")})
              .exit_code == 0);
    CHECK(std::filesystem::exists(place("p2.obj")));
    CHECK(test::nendo({"join", soup, ball, "--out", place("j.obj")}).exit_code == 0);
    for (const char* mode : {"clay", "parts"}) {
      std::vector<std::string> run{"run",    "--mesh",    soup,         "--mode", mode,
                                   "--left", "sim:press", "--duration", "0.3"};
      if (std::string(mode) == "clay") run.insert(run.end(), {"--refine", "600"});
      const auto done = test::nendo(run);
      CHECK(done.exit_code == 0);
      CHECK(done.err.find("not kept") == std::string::npos);
    }
  }

  TEST_CASE_FIXTURE(Fixture,
                    "a recording over an unwelded reading finds it, another file does not") {
    const std::string soup = save("soup.obj", loose(test::cube_of_cells(2)));
    const auto then = deform::read_model(soup, {.up = deform::UpAxis::y, .weld = false});
    REQUIRE(then);
    REQUIRE(then->mesh.vertices.cols() == 144);
    recording::LoopSetup loop;
    loop.mesh = soup;
    loop.mesh_sum = recording::sum_of(then->mesh.vertices);
    const auto found = takes::find_recorded_model(loop);
    REQUIRE_MESSAGE(found, found.error().message);
    CHECK(found->is_recorded);
    CHECK(found->mesh.vertices == then->mesh.vertices);
    const auto now = deform::read_model(soup);
    REQUIRE(now);
    loop.mesh_sum = recording::sum_of(now->mesh.vertices);
    const auto welded = takes::find_recorded_model(loop);
    REQUIRE(welded);
    CHECK(welded->mesh.vertices.cols() == 26);
    loop.mesh_sum.crc ^= 1U;
    CHECK(!takes::find_recorded_model(loop));
  }
}

} // namespace repair_command_test
