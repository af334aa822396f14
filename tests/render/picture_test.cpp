#include <cmath>
#include <cstdint>
#include <limits>

#include <doctest/doctest.h>

#include "render/picture.hpp"
#include "support/test_meshes.hpp"

namespace picture_test {

using namespace nendo;
using namespace nendo::render;

namespace {

SceneFrame moment_of(const deform::Mesh& mesh) {
  SceneFrame scene_frame;
  scene_frame.vertices = mesh.vertices;
  return scene_frame;
}

Scene scene_of(const deform::Mesh& mesh, const SceneFrame& scene_frame) {
  Scene scene;
  SceneBuilder(mesh).build(scene_frame, {}, scene);
  return scene;
}

bool is_white(const Pixel& pixel) {
  return pixel[0] > 127;
}

double grey(const Pixel& pixel) {
  return (pixel[0] + pixel[1] + pixel[2]) / 3.0;
}

double mean_grey(const Image& image, int x0, int y0, int x1, int y1) {
  double sum = 0.0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      sum += grey(image.at(x, y));
  return sum / ((x1 - x0) * (y1 - y0));
}

SceneHand hand_at(Side side, const Eigen::Vector3d& place) {
  Eigen::Isometry3d T_world_wrist = Eigen::Isometry3d::Identity();
  T_world_wrist.translation() = place;
  const auto pose = hand::HandSkeleton(side).pose({}, T_world_wrist);
  return {pose, pose.fingertip_positions() - 0.1 * TipPlaces::Ones(), false};
}

/// A model, a solid, veils and a ground, made without a mathematical library, which differ.
Scene scene_without_libraries() {
  Scene scene;
  scene.model.material.colour = {0.5F, 0.24F, 0.14F};
  add_sphere(scene.model, {0.0F, 0.3F, 0.0F}, 0.3F, 48);
  add_capsule(scene.model, {0.3F, 0.1F, 0.1F}, {0.45F, 0.5F, 0.3F}, 0.08F, 0.03F);
  add_arrow(scene.solids.emplace_back(), {-0.5F, 0.1F, 0.3F}, {-0.2F, 0.5F, 0.3F}, 0.03F);
  Surface& skin = scene.veils.emplace_back();
  skin.material = {{0.3F, 0.3F, 0.4F}, 0.1F, 0.6F, 1.0F, 0.0F, 0.0F, true};
  add_capsule(skin, {-0.2F, 0.3F, 0.35F}, {0.2F, 0.35F, 0.35F}, 0.06F, 0.04F);
  Surface& reach = scene.veils.emplace_back();
  reach.material = {{0.8F, 0.4F, 0.0F}, 0.0F, 0.0F, 0.3F};
  add_sphere(reach, {0.1F, 0.6F, 0.1F}, 0.15F);
  Surface& ground = scene.grounds.emplace_back();
  ground.material = {{0.7F, 0.7F, 0.7F}, 0.0F, 1.0F, 1.0F, 0.1F, 1.2F};
  constexpr std::uint32_t side = 25;
  for (std::uint32_t at = 0; at < side * side; ++at) {
    ground.places.emplace_back(0.125F * static_cast<float>(at % side) - 1.5F, 0.0F,
                               0.125F * static_cast<float>(at / side) - 1.5F);
    ground.normals.emplace_back(Eigen::Vector3f::UnitY());
    if (at % side + 1 < side && at + side < side * side)
      ground.corners.insert(ground.corners.end(),
                            {at, at + side, at + side + 1, at, at + side + 1, at + 1});
  }
  return scene;
}

} // namespace

TEST_SUITE("picture") {
  TEST_CASE("a sphere is seen as the disc that geometry says") {
    const auto mesh = test::sphere(95, 192, 3.0);
    const Scene scene = scene_of(mesh, moment_of(mesh));
    const double radius = 0.4; // on the stage, standing on the ground
    Camera camera;
    camera.target = {0.0, radius, 0.0};
    camera.distance_m = 2.0;
    camera.view = {25.0, 40.0};
    const Size size{300, 200};
    const Image image = silhouette(scene, camera, size);
    // The cone about it: its edge is asin(r / d) off the middle.
    const double edge =
        std::tan(std::asin(radius / camera.distance_m)) / camera.tangent() * size.height / 2;
    int wrong = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const double away = std::hypot(x + 0.5 - size.width / 2.0, y + 0.5 - size.height / 2.0);
        if (std::abs(away - edge) > 0.5) wrong += is_white(image.at(x, y)) != (away < edge) ? 1 : 0;
      }
    CHECK(wrong == 0);
  }

  TEST_CASE("the same scene gives the same bytes, with any number of threads") {
    const auto mesh = test::sphere(20, 40, 1.0);
    SceneFrame scene_frame = moment_of(mesh);
    scene_frame.held = true;
    scene_frame.radius_m.fill(0.1);
    scene_frame.hands[0] = hand_at(Side::left, {-0.5, 0.4, 0.0});
    const Scene scene = scene_of(mesh, scene_frame);
    const Camera camera = framing(scene.outline(), {20, 15}, 1.2);
    const Image once = draw(Lighting(scene, 0.0, 1), camera, {120, 100}, 1);
    for (const unsigned threads : {1U, 2U, 8U})
      CHECK(draw(Lighting(scene, 0.0, threads), camera, {120, 100}, threads) == once);
    scene_frame.vertices *= 1.1;
    const Scene larger = scene_of(mesh, scene_frame);
    CHECK_FALSE(draw(Lighting(larger), camera, {120, 100}) == once);
  }

  TEST_CASE("a picture has the same bytes on every machine and in every version") {
    const Scene scene = scene_without_libraries();
    const Camera camera = framing(scene.outline(), {30.0, 20.0}, 4.0 / 3.0);
    const auto sum_of = [&](double azimuth_deg) {
      std::uint64_t sum = 0xcbf29ce484222325U; // FNV-1a
      const Image image = draw(Lighting(scene, azimuth_deg), camera, {160, 120});
      for (const Pixel& pixel : image.pixels())
        for (const std::uint8_t byte : pixel)
          sum = (sum ^ byte) * 0x100000001b3U;
      return sum;
    };
    // As they were before the lights were computed several places at once. They change only if a
    // picture is meant to look different.
    CHECK(sum_of(0.0) == 0xc8c12a06bcd3f01aU);
    CHECK(sum_of(30.0) == 0x5c42bedfaca4e89cU);
  }

  TEST_CASE("light comes from the upper left, and things on the ground shade it") {
    const auto mesh = test::sphere(48, 96, 1.0);
    const Scene scene = scene_of(mesh, moment_of(mesh));
    for (const double azimuth : {0.0, 130.0}) { // the lights go round with the camera
      Camera camera;
      camera.target = {0.0, 0.4, 0.0};
      camera.distance_m = 4.0;
      camera.view = {azimuth, 8.0};
      const Image image = draw(Lighting(scene, azimuth), camera, {200, 200});
      const auto at = [&](double dx, double dy) { // of the picture's half, from its middle
        const int x = static_cast<int>(100 + 100 * dx);
        const int y = static_cast<int>(100 - 100 * dy);
        return mean_grey(image, x - 2, y - 2, x + 3, y + 3);
      };
      CHECK(at(-0.25, 0.25) > at(0.25, -0.25) + 20.0);
      // Under the ball, to the right: its shadow. As far to the left: none.
      CHECK(at(0.55, -0.42) + 15.0 < at(-0.75, -0.42));
    }
  }

  TEST_CASE("what is nearer hides what is farther, and a veil lets it through") {
    const auto wall = test::grid(4, 1.0);
    SceneFrame scene_frame = moment_of(wall);
    Scene scene = scene_of(wall, scene_frame);
    scene.grounds.clear();
    Surface ball;
    ball.material.colour = {0.0F, 0.0F, 1.0F};
    add_sphere(ball, {0.0F, 0.4F, 0.3F}, 0.1F);
    Camera camera;
    camera.target = {0.0, 0.4, 0.0};
    const auto blueness = [&] {
      const Pixel pixel = draw(Lighting(scene), camera, {64, 64}).at(32, 32);
      return int{pixel[2]} - int{pixel[0]};
    };
    const int without = blueness();
    scene.solids.push_back(ball);
    const int before = blueness();
    for (auto& place : scene.solids.back().places)
      place.z() -= 0.6F;
    CHECK(blueness() == without); // behind the wall
    CHECK(before > without + 60);
    scene.solids.clear();
    ball.material.opacity = ball.material.rim_opacity = 0.4F;
    scene.veils.push_back(ball);
    const int through = blueness();
    CHECK(through > without + 10);
    CHECK(through < before - 10);
    // Before the model a hand's skin is like any veil. Before the ground it is like a solid.
    scene.veils.back().material.opaque_before_ground = true;
    CHECK(blueness() == through);
    scene.model.corners.clear();
    const int before_nothing = blueness();
    scene.veils.back().material.opacity = scene.veils.back().material.rim_opacity = 1.0F;
    CHECK(blueness() == before_nothing);
  }

  TEST_CASE("hostile shapes are drawn as far as they can be, and nothing crashes") {
    const double inf = std::numeric_limits<double>::infinity();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {nan, inf, -inf, 1e308, -1e30, 1e-320}) {
      auto mesh = test::sphere(6, 12, 1.0);
      SceneFrame scene_frame = moment_of(mesh);
      scene_frame.vertices(1, 3) = bad;
      scene_frame.radius_m.fill(bad);
      scene_frame.held = true;
      scene_frame.hands[1] = hand_at(Side::right, {0.3, bad, 0.0});
      for (const bool in_rest : {false, true}) {
        if (in_rest) mesh.vertices = scene_frame.vertices;
        const Scene scene = scene_of(mesh, scene_frame);
        const Camera camera = framing(scene.outline(), {}, 1.0);
        CHECK(camera.eye().allFinite());
        CHECK(draw(Lighting(scene), camera, {32, 32}).size() == Size{32, 32});
      }
    }
    for (const auto& places : {deform::Points(3, 0), deform::Points(deform::Points::Zero(3, 5))}) {
      deform::Mesh mesh;
      mesh.vertices = places;
      const Scene scene = scene_of(mesh, moment_of(mesh));
      const Camera camera = framing(scene.outline(), {}, 1.0);
      CHECK(draw(Lighting(scene), camera, {32, 32}).size() == Size{32, 32});
    }
  }

  TEST_CASE("a model of any size and place gives the same picture") {
    const auto mesh = test::sphere(12, 24, 1.0);
    const Scene scene = scene_of(mesh, moment_of(mesh));
    const Camera camera = framing(scene.outline(), {30, 10}, 1.0);
    const Image image = draw(Lighting(scene), camera, {60, 60});
    for (const double scale : {0x1p-40, 0x1p40}) {
      auto other = mesh;
      other.vertices = (mesh.vertices * scale).colwise() + Eigen::Vector3d(4, -8, 2) * scale;
      const Scene moved = scene_of(other, moment_of(other));
      const Image drawn = draw(Lighting(moved), camera, {60, 60});
      double difference = 0.0;
      for (std::size_t at = 0; at < drawn.pixels().size(); ++at)
        difference =
            std::max(difference, std::abs(grey(drawn.pixels()[at]) - grey(image.pixels()[at])));
      CHECK(difference < 12.0); // roundings move an edge by a sample of four at most
    }
  }

  /// A plate of four cells, seen from straight above.
  static Image plate_from_above(deform::Mesh mesh) {
    mesh.vertices.row(2) = -mesh.vertices.row(1); // flat on the ground, facing up
    mesh.vertices.row(1).setZero();
    const Scene scene = scene_of(mesh, moment_of(mesh));
    Camera camera;
    camera.target = {0.0, 0.0, 0.0};
    camera.distance_m = 2.0;
    camera.view = {0.0, 90.0};
    return draw(Lighting(scene), camera, {120, 120});
  }

  TEST_CASE("faces have their materials' colours, and transparent ones are left out") {
    deform::Mesh mesh = test::grid(2, 1.0); // cells: bottom left and right, top left and right
    const auto colour = [](float r, float g, float b, float a) {
      return Eigen::Vector4f(r, g, b, a);
    };
    mesh.look.materials = {{"red", colour(0.6F, 0.0F, 0.0F, 1.0F), deform::no_index, true},
                           {"green", colour(0.0F, 0.6F, 0.0F, 1.0F), deform::no_index, true},
                           {"shell", colour(1.0F, 1.0F, 1.0F, 0.0F), deform::no_index, false}};
    mesh.look.face_materials = {1, 0, 2, deform::no_index};
    const Image image = plate_from_above(mesh);
    const Image plain = plate_from_above(test::grid(2, 1.0));
    const Pixel& left = image.at(52, 68);
    const Pixel& right = image.at(68, 68);
    CHECK(left[1] > left[0] + 60);
    CHECK(right[0] > right[1] + 60);
    CHECK(image.at(68, 52) == plain.at(68, 52)); // clay, where a face has no material
    const Pixel& through = image.at(52, 52);     // grey ground
    CHECK(std::abs(through[0] - through[2]) < 12);
    CHECK(plain.at(52, 52)[0] > plain.at(52, 52)[2] + 20);
  }

  TEST_CASE("colours of vertices are mixed over a face") {
    deform::Mesh mesh = test::grid(2, 1.0);
    mesh.look.vertex_colours = Eigen::Matrix4Xf::Zero(4, 9);
    for (Eigen::Index vertex = 0; vertex < 9; ++vertex) { // from red on the left to blue
      const float along = static_cast<float>(mesh.vertices(0, vertex));
      mesh.look.vertex_colours.col(vertex) << 0.6F * (1.0F - along), 0.0F, 0.6F * along, 1.0F;
    }
    const Image image = plate_from_above(mesh);
    double before = 1e9;
    for (const int x : {45, 52, 60, 68, 75}) {
      const Pixel& pixel = image.at(x, 60);
      const double warmth = static_cast<double>(pixel[0]) - static_cast<double>(pixel[2]);
      CHECK(warmth < before - 10.0);
      before = warmth;
    }
    CHECK(std::abs(before) > 40.0);
  }

  TEST_CASE("colours of corners end at the edge between two faces") {
    deform::Mesh mesh = test::grid(2, 1.0);
    mesh.texcoords = Eigen::Matrix2Xd::Zero(2, 2);
    mesh.look.texcoord_colours.resize(4, 2);
    mesh.look.texcoord_colours << 0.6F, 0.0F, 0.0F, 0.0F, 0.0F, 0.6F, 1.0F, 1.0F; // red and blue
    for (std::uint32_t corner = 0; corner < 16; ++corner)
      mesh.corner_texcoords.push_back(corner / 4 % 2); // faces on the left, and on the right
    const Image image = plate_from_above(mesh);
    for (const int y : {45, 55, 65, 75})
      for (const int x : {45, 57, 63, 75}) {
        const Pixel& pixel = image.at(x, y);
        const int warmth = static_cast<int>(pixel[0]) - static_cast<int>(pixel[2]);
        CHECK((x < 60 ? warmth : -warmth) > 60);
      }
  }

  TEST_CASE("a model of which all is transparent is drawn all the same") {
    deform::Mesh mesh = test::grid(2, 1.0);
    mesh.look.materials = {
        {"ghost", Eigen::Vector4f(1.0F, 0.0F, 0.0F, 0.1F), deform::no_index, true}};
    mesh.look.face_materials = {0, 0, 0, 0};
    const Pixel pixel = plate_from_above(mesh).at(60, 60);
    CHECK(pixel[0] > pixel[2] + 60);
  }

  TEST_CASE("a sheet has every panel as it was, and its words under it") {
    std::vector<Panel> panels;
    for (std::uint8_t at = 0; at < 5; ++at)
      panels.push_back({Image({80, 60}, {at, 200, 100}), at == 2 ? "third" : ""});
    const Image sheet = contact_sheet(panels, 3);
    for (std::uint8_t at = 0; at < 5; ++at) {
      int seen = 0;
      for (const Pixel& pixel : sheet.pixels())
        seen += pixel == Pixel{at, 200, 100} ? 1 : 0;
      CHECK(seen == 80 * 60);
    }
    CHECK(sheet.size().width > sheet.size().height);
    CHECK(contact_sheet({}).size().width > 0);
  }
}

} // namespace picture_test
