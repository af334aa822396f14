// The shipped puppets, and those that are made of the shipped models.

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/puppet/make_puppet.hpp>
#include <nendo/puppet/rig_check.hpp>

#include "support/test_meshes.hpp"

namespace face_puppet_test {

using namespace nendo;
using namespace nendo::puppet;

namespace {

const std::string models = NENDO_MODELS "/";

deform::Mesh model_named(const std::string& name) {
  auto model = deform::read_mesh(models + name + ".obj");
  REQUIRE(model);
  return *std::move(model);
}

RigCheck checked(const Puppet& puppet, const deform::Mesh& model) {
  auto shapes = RigShapes::make(std::make_shared<const Rig>(puppet, model), model);
  REQUIRE_MESSAGE(shapes, (shapes ? "" : shapes.error().message));
  return check_rig(**shapes, model);
}

bool has(const Puppet& puppet, std::string_view function) {
  return std::any_of(puppet.functions.begin(), puppet.functions.end(),
                     [&](const Function& known) { return known.name == function; });
}

} // namespace

TEST_SUITE("face puppet") {
  TEST_CASE("each shipped puppet passes its check, by ten fingers or more") {
    for (const char* const name : {"face", "face689", "moai", "spot"}) {
      CAPTURE(name);
      const auto puppet = read_puppet(models + name + ".puppet.toml");
      REQUIRE_MESSAGE(puppet, (puppet ? "" : puppet.error().message));
      CHECK(puppet->functions.size() >= 10);
      CHECK(checked(*puppet, model_named(name)).passes());
    }
  }

  TEST_CASE("landmarks of the face are where its makers have them") {
    // ICT FaceKit's vertices of the 68-point scheme, in centimetres.
    const auto face = find_face(model_named("face"));
    REQUIRE(face);
    const auto near = [](const Eigen::Vector3d& found, double x, double y, double z) {
      INFO(found.transpose());
      return (found - Eigen::Vector3d(x, y, z)).norm() < 0.8;
    };
    CHECK(near(face->nose, 0.0, 0.4, 13.1));
    CHECK(near(face->jaw, 0.0, -7.6, 10.4));
    REQUIRE(face->mouth);
    CHECK(near(face->mouth->corner, 2.5, -3.5, 10.2));
    CHECK(near(face->mouth->upper, 0.0, -2.5, 11.8));
    CHECK(near(face->mouth->lower, 0.0, -4.4, 11.5));
    CHECK(face->eye);
    CHECK(face->is_symmetric());
  }

  TEST_CASE("heads with mouth and eyes get a puppet that opens both, and passes the check") {
    for (const char* const name : {"face", "head"}) {
      CAPTURE(name);
      const deform::Mesh model = model_named(name);
      const auto made = make_face_puppet(model, "a.obj");
      REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
      const auto puppet = parse_puppet(made->text, "made");
      REQUIRE_MESSAGE(puppet, (puppet ? "" : puppet.error().message));
      for (const char* const function :
           {"jawOpen", "mouthPucker", "mouthSmileLeft", "mouthFrownRight", "browUpLeft",
            "browDownRight", "eyeBlinkLeft", "eyeBlinkRight"})
        CHECK_MESSAGE(has(*puppet, function), function);
      CHECK(checked(*puppet, model).passes());
    }
  }

  TEST_CASE("on a symmetric head, twins are symmetric") {
    const deform::Mesh model = model_named("head");
    const auto made = make_face_puppet(model, "head.obj");
    REQUIRE(made);
    const RigCheck check = checked(*parse_puppet(made->text, "made"), model);
    CHECK(check.lone_vertices == 0);
    REQUIRE_FALSE(check.twins.empty());
    for (const TwinCheck& twins : check.twins)
      CHECK(twins.apart < RigCheck::symmetric_within);
  }

  TEST_CASE("the check of a puppet finds as many mirror images as its maker has found") {
    const deform::Mesh model = model_named("spot"); // symmetric but for its triangles
    const auto made = make_face_puppet(model, "spot.obj");
    REQUIRE(made);
    const RigCheck check = checked(*parse_puppet(made->text, "made"), model);
    const auto vertices = static_cast<std::size_t>(model.vertices.cols());
    CHECK(check.lone_vertices < vertices / 10);
    const std::string found = std::to_string(vertices - check.lone_vertices) + " of " +
                              std::to_string(vertices) + " vertices have a mirror image";
    CHECK_MESSAGE(made->found.front().find(found) != std::string::npos, made->found.front());
    REQUIRE_FALSE(check.twins.empty());
    for (const TwinCheck& twins : check.twins)
      CHECK(twins.apart < 0.02);
  }

  TEST_CASE("a face without openings gets what remains, and the file says so") {
    const deform::Mesh model = model_named("moai");
    const auto made = make_face_puppet(model, "moai.obj");
    REQUIRE(made);
    CHECK(made->text.find("no opening was found") != std::string::npos);
    const auto puppet = parse_puppet(made->text, "made");
    REQUIRE(puppet);
    CHECK_FALSE(has(*puppet, "jawOpen"));
    CHECK_FALSE(has(*puppet, "eyeBlinkLeft"));
    CHECK(has(*puppet, "noseLong"));
    CHECK(has(*puppet, "browUpLeft"));
    CHECK(checked(*puppet, model).passes());
  }

  TEST_CASE("what is no face is refused, and never makes a puppet that is not finite") {
    CHECK_FALSE(find_face(deform::Mesh{}));
    CHECK_FALSE(make_face_puppet(test::grid(4, 1.0), "grid.obj"));
    deform::Mesh broken = test::sphere(6, 8, 1.0);
    broken.vertices(0, 3) = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(make_face_puppet(broken, "broken.obj"));
    const auto ball = make_face_puppet(test::sphere(12, 16, 1.0), "ball.obj");
    if (ball) CHECK(parse_puppet(ball->text, "made"));
  }
}

} // namespace face_puppet_test
