// Models of other programs, as users give them: STL, z up, odd files and files that are no models.

#include <cstdlib>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>
#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "support/program.hpp"
#include "support/test_meshes.hpp"

namespace model_formats_command_test {

using namespace nendo;
using nendo::test::is_one_line_about;

namespace {

const std::string cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                         "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

struct Fixture {
  test::TemporaryFolder folder;
  std::string place(const std::string& name) const { return (folder.path() / name).string(); }
  std::string save(const std::string& name, const std::string& text) const {
    test::write_file(place(name), text);
    return place(name);
  }
  std::string save_vectors() const {
    return save("v.csv", "x,y,z,dx,dy,dz\n"
                         "0,0,0,0.25,0,0\n");
  }
  static deform::Mesh read(const std::string& file) {
    auto mesh = deform::read_mesh(file);
    REQUIRE_MESSAGE(mesh, mesh.error().message);
    return *std::move(mesh);
  }
  test::Finished deformed(const std::string& in, const std::string& out,
                          std::vector<std::string> more = {}) const {
    more.insert(more.begin(),
                {"deform", in, "--vectors", save_vectors(), "--radius", "0.5", "--out", out});
    return test::nendo(more);
  }
};

} // namespace

TEST_SUITE("model_formats_command") {
  TEST_CASE_FIXTURE(Fixture, "a model may become an STL and come back, with any case of endings") {
    const auto to_stl = deformed(save("a.OBJ", cube), place("a.STL"));
    CHECK(to_stl.exit_code == 0);
    CHECK(is_one_line_about(to_stl.err, "an STL cannot keep faces of more than three corners"));
    const auto back = deformed(place("a.STL"), place("b.Obj"));
    CHECK(back.exit_code == 0);
    CHECK(back.err == "");
    const deform::Mesh mesh = read(place("b.Obj"));
    CHECK(mesh.vertices.cols() == 8);
    CHECK(mesh.face_count() == 12);
    CHECK(deform::check_closed_manifold(mesh));
  }

  TEST_CASE_FIXTURE(Fixture, "a model with z up is written with z up again") {
    const std::string in = save("scan.obj", cube);
    const auto done = deformed(in, place("out.obj"), {"--up", "z"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    // Nothing but the corner that is pulled along x has moved; its place is the same in both axes.
    deform::Points expected = read(in).vertices;
    expected(0, 0) += 0.25;
    CHECK(read(place("out.obj")).vertices.isApprox(expected, 1e-12));
    const auto wrong = deformed(in, place("out.obj"), {"--up", "x"});
    CHECK(wrong.exit_code == 2);
  }

  TEST_CASE_FIXTURE(Fixture,
                    "the recording of a model with z up needs no option, and has its axes") {
    const std::string in = save("scan.obj", cube), take = place("t.nendo");
    const auto done =
        test::nendo({"run", in, "--up", "z", "--left", "sim:sculpt", "--right", "sim:sculpt",
                     "--duration", "0.5", "--record", take, "--out", place("run.obj")});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const auto again = test::nendo({"replay", take, "--no-clock", "--out", place("replay.obj")});
    CAPTURE(again.err);
    REQUIRE(again.exit_code == 0);
    CHECK(read(place("replay.obj")).vertices == read(place("run.obj")).vertices);
    const auto exported = test::nendo(
        {"export", take, "--out", place("e-%d.obj"), "--from", "0", "--to", "0.3", "--rate", "10"});
    CAPTURE(exported.err);
    REQUIRE(exported.exit_code == 0);
    // At its beginning, hardly anything has moved yet.
    CHECK(read(place("e-1.obj")).vertices.isApprox(read(in).vertices, 0.02));
  }

  TEST_CASE_FIXTURE(Fixture, "of an STL, one line says how it was laid, and its advice works") {
    const std::string in = save("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
                                         "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
                                         "endsolid\n");
    const auto report = test::nendo({"picture", in, "--out", place("a.png"), "--pixels", "64x64"});
    CHECK(report.exit_code == 0);
    CHECK(is_one_line_about(report.err, "add --up z"));
    for (const char* const up : {"y", "z"}) {
      const auto done = test::nendo({"picture", in, "--up", up, "--out",
                                     place(std::string(up) + ".png"), "--pixels", "64x64"});
      CHECK(done.exit_code == 0);
      CHECK(done.err == "");
    }
    CHECK(test::contents(place("y.png")) == test::contents(place("a.png")));
    CHECK(test::contents(place("z.png")) != test::contents(place("a.png")));
  }

  TEST_CASE_FIXTURE(Fixture, "a stray vertex changes nothing of a picture") {
    const auto picture = [&](const std::string& in, const std::string& out) {
      const auto done = test::nendo({"picture", in, "--out", place(out), "--pixels", "96x96"});
      CHECK(done.exit_code == 0);
      return done.err;
    };
    CHECK(picture(save("whole.obj", cube), "whole.png") == "");
    const std::string err = picture(save("stray.obj", cube + "v 1000 1000 1000\n"), "stray.png");
    CHECK(is_one_line_about(err, "1 vertex belongs to no face"));
    CHECK(test::contents(place("stray.png")) == test::contents(place("whole.png")));
  }

  TEST_CASE_FIXTURE(Fixture, "a face that repeats its first corner can be cut") {
    std::string text = cube;
    text.replace(text.find("f 4 3 2 1"), 9, "f 4 3 2 \\ \n1 4");
    const auto done = test::nendo({"cut", save("a.obj", text), "--plane", "0.5,0.5,0.5,1,0.1,0.2",
                                   "--out", place("part-%d.stl")});
    CAPTURE(done.err);
    CHECK(done.exit_code == 0);
    CHECK(done.err.find("names a corner twice in a row") != std::string::npos);
    for (const char* const part : {"part-1.stl", "part-2.stl"})
      CHECK(deform::check_closed_manifold(read(place(part))));
  }

  TEST_CASE_FIXTURE(Fixture, "what is no model is refused by its name, and its advice works") {
    std::string wide = "\xFF\xFE";
    for (const char c : cube)
      wide += {c, '\0'};
    const std::string in = save("wide.obj", wide), out = place("plain.obj");
    const auto refused = deformed(in, place("out.obj"));
    CHECK(refused.exit_code == 5);
    CHECK(is_one_line_about(refused.err, "UTF-16"));
    CHECK_FALSE(std::filesystem::exists(place("out.obj")));
    CHECK(refused.err.find("iconv -f UTF-16 -t UTF-8 FILE >NEW-FILE") != std::string::npos);
    const std::string command = "iconv -f UTF-16 -t UTF-8 '" + in + "' >'" + out + "'";
    // NOLINTNEXTLINE(concurrency-mt-unsafe,cert-env33-c): no other thread, and the advice is a
    // shell's
    if (std::system(command.c_str()) == 0) CHECK(deformed(out, place("out.obj")).exit_code == 0);
  }
}

} // namespace model_formats_command_test
