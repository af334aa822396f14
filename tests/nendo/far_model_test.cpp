// Models in other places and units: whatever a run does with them, it does as at zero.

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "reference/icosphere.hpp"
#include "support/glb_reader.hpp"
#include "support/json_lines.hpp"
#include "support/program.hpp"

namespace far_model_test {

using namespace nendo;
using deform::Mesh;
using deform::Points;
using Eigen::Vector3d;
using nendo::test::contents;
using nendo::test::last_object;

namespace {

const Vector3d surveyed(500123.25, 4649776.5, 312.75);

/// Balls in a folder, and what is done with them there.
struct Balls {
  test::TemporaryFolder folder;

  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  /// Writes a ball of that size about a place, and returns its path.
  std::string ball(const std::string& name, double size, const Vector3d& at, int level = 3) const {
    Mesh mesh = reference::icosphere(level, 0.5 * size);
    mesh.vertices.colwise() += at;
    REQUIRE(deform::write_mesh(path(name), mesh));
    return path(name);
  }
  test::Finished nendo(std::vector<std::string> arguments) const {
    auto done = test::nendo(std::move(arguments));
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    return done;
  }
  /// Runs, recorded as NAME.nendo, and replays that: to the bit, to NAME-again.ply.
  void run(const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> arguments{"run", "--record", path(name + ".nendo"), "--out",
                                       path(name + ".ply")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    nendo(arguments);
    const auto again = nendo({"replay", path(name + ".nendo"), "--no-clock", "--json", "--out",
                              path(name + "-again.ply")});
    CHECK(last_object(again)["same_shape"] == true);
    CHECK(contents(path(name + ".ply")) == contents(path(name + "-again.ply")));
  }
  Points vertices(const std::string& name) const {
    const auto mesh = deform::read_mesh(path(name));
    REQUIRE(mesh);
    return mesh->vertices;
  }
};

Points moved(const Points& points, const Vector3d& way) {
  return points.colwise() + way;
}

double farthest(const Points& one, const Points& other) {
  REQUIRE(one.cols() == other.cols());
  return (one - other).colwise().norm().maxCoeff();
}

} // namespace

TEST_SUITE("far_model") {
  TEST_CASE("every kind of run can read its recording, wherever the model is and in all units") {
    const Balls balls;
    struct Ball {
      std::string name;
      double size;
      Vector3d at;
    };
    const std::array places{
        Ball{"near", 2.0, Vector3d(0.0, 1.0, 0.0)}, Ball{"surveyed", 2.0, surveyed},
        Ball{"tiny", 1e-3, Vector3d(1.0, 0.0, 1e3)}, Ball{"huge", 1e4, Vector3d(1e7, -1e7, 0.0)}};
    for (const Ball& place : places) {
      const std::string model = balls.ball(place.name + ".obj", place.size, place.at, 2);
      for (const std::string mode : {"type1", "type2", "clay", "parts"}) {
        const std::string name = place.name + "-" + mode;
        CAPTURE(name);
        balls.run(name, {model, "--mode", mode, "--left", "sim:sculpt", "--right", "sim:sculpt",
                         "--duration", "0.3"});
        balls.nendo({"recording", "info", balls.path(name + ".nendo")});
        if (place.name == "near" || mode != "type2") continue;
        balls.nendo({"recording", "repair", balls.path(name + ".nendo"), "--out",
                     balls.path(name + "-mended.nendo")});
        const std::string timeline = balls.path(name + ".timeline.toml");
        balls.nendo({"edit", "make", balls.path(name + ".nendo"), "--out", timeline});
        balls.nendo({"edit", "play", timeline, "--out", balls.path(name + "-played.ply")});
        CHECK(farthest(balls.vertices(name + "-played.ply"), balls.vertices(name + ".ply")) <
              0.3 * place.size);
      }
    }
  }

  TEST_CASE("the same hands make the same shape, moved by the same way") {
    const Balls balls;
    const Vector3d away(10000.0, 0.0, 0.0);
    const std::string near = balls.ball("near.obj", 2.0, Vector3d::Zero());
    const std::string far = balls.ball("far.obj", 2.0, away);
    for (const std::string mode : {"clay", "type1", "type2"}) {
      CAPTURE(mode);
      const std::string motion = mode == "clay" ? "sim:press" : "sim:sculpt";
      balls.run(mode, {far, "--mode", mode, "--left", motion, "--right", motion, "--duration",
                       mode == "clay" ? "2" : "0.5"});
      test::nendo({"replay", balls.path(mode + ".nendo"), "--no-clock", "--mesh", near, "--out",
                   balls.path(mode + "-near.ply")});
      const Points there = balls.vertices(mode + ".ply");
      const Points here = balls.vertices(mode + "-near.ply");
      CHECK(farthest(there, moved(here, away)) < 1e-5);
      CHECK(farthest(here, reference::icosphere(3, 1.0).vertices) > 0.02); // they did something
    }
  }

  TEST_CASE("what is refined, cut, copied or played over far away can be read, too") {
    const Balls balls;
    const std::string ball = balls.ball("ball.obj", 2.0, surveyed);
    balls.run("refined", {ball, "--mode", "clay", "--refine", "3000", "--left", "sim:press",
                          "--right", "sim:press", "--duration", "1"});
    balls.run("wired", {ball, "--wire", "0.1:0.4", "--left", "sim:sculpt", "--right", "sim:sculpt",
                        "--duration", "0.8"});
    balls.run("held", {ball, "--hold", "hand", "--right", "sim:wave", "--duration", "0.3"});
    balls.run("kept", {ball, "--keep-volume", "0.5", "--right", "sim:wave", "--duration", "0.3"});
    balls.run("masked", {ball, "--symmetry", "--right", "sim:sculpt", "--duration", "0.3"});
    balls.run("under", {ball, "--layer", "left.thumb", "--left", "sim:wave", "--duration", "0.3"});
    balls.run("over", {"--over", balls.path("under.nendo"), "--right", "sim:wave"});
  }

  TEST_CASE("a puppet of a far model is played, shown, and keeps its coordinates") {
    const Balls balls;
    balls.ball("ball.obj", 2.0, surveyed);
    std::ofstream(balls.path("ball.puppet.toml"))
        << "version = 1\nmodel = \"ball.obj\"\n[points]\n"
           "nose = { at = [500123.25, 4649776.5, 313.75], radius = 0.6 }\n"
           "[functions.nose]\ninput = \"right.index_flexion\"\ntravel_deg = 60.0\n"
           "move = { nose = [0.0, 0.0, 0.4] }\n";
    balls.run("played", {"--puppet", balls.path("ball.puppet.toml"), "--right", "sim:wave",
                         "--duration", "0.5"});
    const auto shown = balls.nendo({"puppet", "show", balls.path("ball.puppet.toml")});
    CHECK(shown.out.find("500123.25 4649776.5") != std::string::npos);
    balls.nendo({"puppet", "check", balls.path("ball.puppet.toml")});
    balls.nendo({"export", balls.path("played.nendo"), "--out", balls.path("played.glb")});
  }

  TEST_CASE("exports are exact to the model's size, and carry the offset apart") {
    const Balls balls;
    const std::string ball = balls.ball("ball.obj", 2.0, surveyed);
    balls.run("take", {ball, "--mode", "type1", "--no-injective", "--left", "sim:pinch", "--right",
                       "sim:grasp", "--duration", "0.5"});
    const Points shape = balls.vertices("take.ply");
    const std::string take = balls.path("take.nendo");
    const auto glb =
        balls.nendo({"export", take, "--out", balls.path("take.glb"), "--every-frame", "--json"});
    CHECK(last_object(glb)["morphs"]["greatest_error"].get<double>() < 1e-5);
    const test::Glb document(contents(balls.path("take.glb")));
    CHECK(farthest(document.vertices(0, 1e6), moved(shape, -surveyed)) < 2e-5);
    const auto& node = document.json["nodes"][0];
    const double scale = node["scale"][0].get<double>();
    for (std::size_t axis = 0; axis < 3; ++axis)
      CHECK(node["translation"][axis].get<double>() / scale ==
            doctest::Approx(surveyed[static_cast<Eigen::Index>(axis)]).epsilon(1e-12));
    for (const std::string format : {"pc2", "mdd", "csv", "bvh"}) {
      const auto done = balls.nendo(
          {"export", take, "--out", balls.path("take." + format), "--rate", "20", "--json"});
      CHECK(done.err.find("500123.25") != std::string::npos);
      const auto offset = last_object(done)["offset"].get<std::vector<double>>();
      REQUIRE(offset.size() == 3);
      CHECK((Vector3d::Map(offset.data()) - surveyed).norm() < 1e-5);
    }
    const std::string cache = contents(balls.path("take.pc2"));
    float coordinate = 0.0F;
    for (std::size_t at = 32; at + 4 <= cache.size(); at += 4) {
      std::memcpy(&coordinate, cache.data() + at, 4);
      CHECK(std::abs(coordinate) < 3.0F);
    }
    balls.nendo({"export", take, "--out", balls.path("frame-%d.obj"), "--rate", "10"});
    CHECK(farthest(balls.vertices("frame-1.obj"), shape) < 2.0);
    balls.nendo({"picture", ball, "--out", balls.path("ball.png")});
  }

  TEST_CASE("vectors, planes and wires are in the coordinates of the file") {
    const Balls balls;
    const Vector3d away(1e6, 2e6, -3e6);
    const std::string far = balls.ball("far.obj", 2.0, away);
    const std::string near = balls.ball("near.obj", 2.0, Vector3d::Zero());
    std::ofstream(balls.path("far.csv")) << "x,y,z,dx,dy,dz\n1000001,2000000,-3000000,0.5,0,0.25\n";
    std::ofstream(balls.path("near.csv")) << "x,y,z,dx,dy,dz\n1,0,0,0.5,0,0.25\n";
    for (const std::string name : {"far", "near"})
      balls.nendo({"deform", balls.path(name + ".obj"), "--vectors", balls.path(name + ".csv"),
                   "--radius", "1", "--out", balls.path(name + "-deformed.ply")});
    CHECK(farthest(balls.vertices("far-deformed.ply"),
                   moved(balls.vertices("near-deformed.ply"), away)) < 1e-8);
    balls.nendo({"cut", near, "--plane", "0.1,0.2,0.3,1,0.3,0.2", "--out", balls.path("n%d.obj")});
    balls.nendo({"cut", far, "--plane", "1000000.1,2000000.2,-2999999.7,1,0.3,0.2", "--out",
                 balls.path("f%d.obj")});
    for (const std::string part : {"1.obj", "2.obj"})
      CHECK(farthest(balls.vertices("f" + part), moved(balls.vertices("n" + part), away)) < 1e-7);
    const std::string missed = balls.path("m%d.obj");
    const auto miss = test::nendo({"cut", far, "--plane", "0,0,0,1,0,0", "--out", missed});
    CHECK(miss.err.find("(999999, 1999999, -3000001)") != std::string::npos);
  }
}

} // namespace far_model_test
