// What the windows' OpenGL draws: edges, outlines and shadows, on a screen in memory.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

#include <nendo/deform/part_mover.hpp>
#include <nendo/hand/skeleton.hpp>

#include "render/picture.hpp"
#include "support/memory_screen.hpp"
#include "support/nasty_meshes.hpp"
#include "support/open_window.hpp"
#include "support/restraint.hpp"
#include "support/six_colours.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"
#include "viewer/command_widgets.hpp"
#include "viewer/pointing.hpp"
#include "viewer/scene_window.hpp"

namespace window_picture_test {

using namespace nendo;
using namespace nendo::render;
using namespace nendo::viewer;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr Size size{800, 600};

/// A window over a model alone, without hands.
struct Look {
  deform::Mesh mesh;
  deform::BlockLayout layout;
  SceneBuilder builder;
  std::shared_ptr<SceneWindow> window;
  SceneFrame frame; ///< without hands, at first

  explicit Look(const deform::Mesh& model) : mesh(model), layout(model.vertices), builder(model) {
    window = test::open_window({size, Theme::light, 1.0F});
    window->set_model(layout, builder);
    window->follow(layout.pack());
    picture();
  }
  Image picture(const SimulatedInput& input = {}) {
    window->simulate(input);
    window->begin_picture(frame);
    window->move_camera();
    window->follow_view_keys();
    for (const commands::Row& row : commands::table())
      if ((row.places & commands::in_window) != 0 && is_struck(row)) window->execute(row.name);
    window->end_picture();
    return window->screenshot();
  }
  /// Turns the camera by a drag of the mouse.
  Image turn(double dx, double dy) {
    SimulatedInput drag;
    drag.pointer = {400.0, 300.0};
    picture(drag);
    drag.buttons[0] = true;
    picture(drag);
    drag.pointer += Vector2d(dx, dy);
    picture(drag);
    return picture();
  }
};

double brightness(const Pixel& pixel) {
  return (pixel[0] + pixel[1] + pixel[2]) / 3.0;
}

double brightness_about(const Image& image, const Vector2d& place) {
  double sum = 0.0;
  constexpr int reach = 4;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x)
      sum += brightness(image.at(static_cast<int>(place.x()) + x, static_cast<int>(place.y()) + y));
  return sum / ((2 * reach + 1) * (2 * reach + 1));
}

bool is_clay(const Pixel& pixel) { // which is warmer than all else
  return pixel[0] > pixel[2] + 20;
}

bool is_within_clay(const Image& image, int x, int y) {
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx)
      if (!is_clay(image.at(x + dx, y + dy))) return false;
  return true;
}

/// A ball with bumps, each of which hides a part of it.
deform::Mesh bumpy_ball() {
  deform::Mesh mesh = test::sphere(40, 80, 1.0);
  for (Eigen::Index at = 0; at < mesh.vertices.cols(); ++at) {
    const Vector3d out = mesh.vertices.col(at);
    const double bump = std::sin(7.0 * out.x()) * std::sin(7.0 * out.y()) * std::sin(7.0 * out.z());
    mesh.vertices.col(at) = (1.0 + 0.35 * bump) * out;
  }
  return mesh;
}

/// How far a pixel is above, or below, both of its neighbours in a row or a column.
double contrast_of(double before, double here, double after) {
  return std::max({0.0, here - std::max(before, after), std::min(before, after) - here});
}

/// Pixels within the model that differ from their neighbours on all four sides by more than so many
/// steps of brightness.
int single_pixels(const Image& image, double steps) {
  int found = 0;
  for (int y = 3; y + 3 < size.height; ++y)
    for (int x = 3; x + 3 < size.width; ++x) {
      if (!is_within_clay(image, x, y)) continue;
      const auto of = [&](int dx, int dy) { return brightness(image.at(x + dx, y + dy)); };
      const double aside = contrast_of(of(-1, 0), of(0, 0), of(1, 0));
      const double above = contrast_of(of(0, -1), of(0, 0), of(0, 1));
      if (std::min(aside, above) > steps) ++found;
    }
  return found;
}

/// Lights differ a little: they have the sky's shadows in pictures. Hues do not.
void check_same_hues(const deform::Mesh& mesh) {
  Look look(mesh);
  look.window->parts().ground = false;
  const Image image = look.picture();
  Scene scene;
  SceneFrame moment;
  moment.vertices = mesh.vertices;
  SceneParts parts;
  parts.ground = false;
  look.builder.build(moment, parts, scene);
  const Camera& camera = look.window->camera();
  const Image drawn = draw(Lighting(scene, camera.view.azimuth_deg), camera, size);
  int compared = 0;
  int alike = 0;
  for (int y = 0; y < size.height; y += 3)
    for (int x = 0; x < size.width; x += 3) {
      const auto hue = [](const Pixel& pixel) {
        return static_cast<int>(pixel[0]) - static_cast<int>(pixel[2]);
      };
      const int expected = hue(drawn.at(x, y));
      if (std::abs(expected) < 40) continue;
      ++compared;
      alike += hue(image.at(x, y)) * expected > 0 ? 1 : 0;
    }
  CHECK(compared > 500);
  CHECK(alike > compared * 97 / 100);
}

const Pixel accent_pixel{0xB4, 0x53, 0x2A}; // of the light theme

/// Places of the pixels that have the accent colour, or nearly.
std::vector<Vector2d> line_pixels(const Image& image) {
  std::vector<Vector2d> found;
  for (int y = 0; y < image.size().height; ++y)
    for (int x = 0; x < image.size().width; ++x) {
      int off = 0;
      for (std::size_t channel = 0; channel < 3; ++channel)
        off = std::max(off, std::abs(image.at(x, y)[channel] - accent_pixel[channel]));
      if (off < 25) found.emplace_back(x + 0.5, y + 0.5);
    }
  return found;
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t at = 0; at < a.pixels().size(); ++at)
    for (std::size_t channel = 0; channel < 3; ++channel)
      sum += std::abs(a.pixels()[at][channel] - b.pixels()[at][channel]);
  return sum / (3.0 * static_cast<double>(a.pixels().size()));
}

/// Puts the tip of a hand's index finger there, on the stage. No other fingertip has a radius.
void put_tip(SceneFrame& frame, const Vector3d& place_m, double radius_m) {
  const hand::HandSkeleton skeleton(Side::right);
  Eigen::Isometry3d wrist = Eigen::Isometry3d::Identity();
  wrist.translation() = place_m - skeleton.pose({}, wrist).fingertip_positions().col(1);
  const hand::HandPose pose = skeleton.pose({}, wrist);
  frame.hands[1] = SceneHand{pose, pose.fingertip_positions()};
  frame.radius_m = {0.0, radius_m, 0.0, 0.0, 0.0};
}

} // namespace

TEST_SUITE("window_picture" * doctest::skip(!test::restraint_is_counted)) {
  TEST_CASE("edges are smooth: the pixel on the outline is between the model and what is behind") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Look look(test::sphere(40, 80, 1.0));
    look.window->parts().ground = false;
    const Image image = look.picture();
    int rows = 0;
    int between = 0;
    for (int y = 150; y < 450; ++y) {
      const double behind = brightness(image.at(5, y));
      int x = 5;
      while (x < size.width - 5 && std::abs(brightness(image.at(x, y)) - behind) < 3.0)
        ++x;
      if (x >= size.width - 5) continue;
      ++rows;
      const double whole = behind - brightness(image.at(x + 1, y));
      const double part = behind - brightness(image.at(x, y));
      if (part < 0.85 * whole) ++between;
    }
    CHECK(rows == 300);
    CHECK(between > 150); // a row in five is covered by more than 85 %, or by nearly nothing
  }

  TEST_CASE("hardly a pixel differs from its neighbours where one part of a model hides another") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Look look(bumpy_ball());
    std::ptrdiff_t clay = 0;
    int strong = 0;
    int faint = 0;
    for (int view = 0; view < 6; ++view) {
      const Image image = look.turn(70.0, view % 2 == 0 ? 40.0 : -40.0);
      clay += std::count_if(image.pixels().begin(), image.pixels().end(), is_clay);
      strong += single_pixels(image, 40.0);
      faint += single_pixels(image, 12.0);
    }
    CHECK(clay > 300'000);
    // With normals that turn to the eye by themselves there are 44 strong ones and 245 faint ones.
    // Some faint ones remain, on triangles that are seen edge on.
    CHECK(strong == 0);
    CHECK(faint < 60);
  }

  TEST_CASE("the ground is darker in the model's shadow than beside it, wherever one looks from") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Look look(test::sphere(40, 80, 1.0));
    SimulatedInput top;
    top.taps = {GLFW_KEY_7};
    look.picture(top);
    for (int view = 0; view < 3; ++view) {
      const Image image = view == 0 ? look.picture() : look.turn(200.0, 0.0);
      const Camera& camera = look.window->camera();
      CHECK(camera.view.elevation_deg == 90.0);
      const double radius = look.builder.size_m().x() / 2;
      // The light comes from the left in the picture, from in front and from above; from the top
      // one sees the shadow behind the ball, to the right.
      const Eigen::Matrix3d axes = camera.axes();
      const Vector3d right = axes.row(0).transpose();
      const Vector3d behind = axes.row(1).transpose();
      const double away = 1.8 * radius / std::numbers::sqrt2;
      const auto shadow = pixel_of(camera, away * right + away * behind, size);
      const auto beside = pixel_of(camera, -away * right + away * behind, size);
      REQUIRE(shadow);
      REQUIRE(beside);
      CHECK_FALSE(is_clay(image.at(static_cast<int>(shadow->x()), static_cast<int>(shadow->y()))));
      const double dark = brightness_about(image, *shadow);
      const double bright = brightness_about(image, *beside);
      CHECK(dark < 0.93 * bright);
      CHECK(dark > 0.5 * bright); // and is no hole
    }
  }

  TEST_CASE("a model lies in the shadow of things above it") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    // A ball above a plate, whose rim is on the ground.
    deform::Mesh mesh = test::sphere(30, 60, 0.4);
    const auto ball = mesh.vertices.cols();
    deform::Mesh plate = test::grid(20, 4.0);
    deform::Points all(3, ball + plate.vertices.cols());
    all.leftCols(ball) = mesh.vertices.colwise() + Vector3d(0.0, 1.1, 0.0);
    for (Eigen::Index at = 0; at < plate.vertices.cols(); ++at) {
      const double x = plate.vertices(0, at) - 2.0;
      const double z = 2.0 - plate.vertices(1, at);
      all.col(ball + at) << x, std::max(std::abs(x), std::abs(z)) > 1.99 ? 0.0 : 0.2, z;
    }
    mesh.vertices = all;
    for (std::size_t face = 0; face + 1 < plate.face_starts.size(); ++face) {
      for (auto corner = plate.face_starts[face]; corner < plate.face_starts[face + 1]; ++corner)
        mesh.face_corners.push_back(plate.face_corners[corner] + static_cast<std::uint32_t>(ball));
      mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
    }
    Look look(mesh);
    SimulatedInput top;
    top.taps = {GLFW_KEY_7};
    look.picture(top);
    const Image image = look.picture();
    const Camera& camera = look.window->camera();
    const double metre = look.builder.units_per_metre();
    // Where the ball's middle casts its shadow: along the light, (-0.55, 0.75, 0.55).
    const double away = 0.9 * 0.55 / 0.75;
    const auto place = [&](double x, double z) {
      return pixel_of(camera, Vector3d(x, 0.2, z) / metre, size);
    };
    const auto shadow = place(away, -away);
    const auto beside = place(-away, -away);
    REQUIRE(shadow);
    REQUIRE(beside);
    CHECK(is_clay(image.at(static_cast<int>(shadow->x()), static_cast<int>(shadow->y()))));
    CHECK(brightness_about(image, *shadow) < 0.8 * brightness_about(image, *beside));
  }

  TEST_CASE("each MatCap differs from the others, is the same each time, and shows the light") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Look look(test::sphere(40, 80, 1.0));
    std::vector<Image> images;
    SimulatedInput next;
    next.shift = true;
    next.taps = {GLFW_KEY_V};
    for (std::size_t at = 0; at < gl::material_names.size(); ++at) {
      CHECK(look.window->material() == static_cast<gl::Material>(at));
      images.push_back(look.picture());
      CHECK(look.picture() == images.back());
      // As seen from the eye, the light comes from the left and from above.
      const Camera& camera = look.window->camera();
      const double radius = look.builder.size_m().x() / 2;
      const Vector3d middle(0.0, radius, 0.0);
      const Vector3d aside = camera.axes().transpose() * Vector3d(-0.45, 0.55, 0.0) * radius;
      const auto lit = pixel_of(camera, middle + aside, size);
      const auto unlit = pixel_of(camera, middle - aside, size);
      REQUIRE(lit);
      REQUIRE(unlit);
      CHECK(brightness_about(images.back(), *lit) > 1.2 * brightness_about(images.back(), *unlit));
      look.picture(next);
      look.picture();
    }
    CHECK(look.window->material() == gl::Material::lit);
    for (std::size_t a = 0; a < images.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        CHECK(mean_difference(images[a], images[b]) > 2.0); // of all pixels; the ball has a quarter
  }

  TEST_CASE("a MatCap is in place of colours and textures") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    deform::Mesh mesh = test::cube_of_cells(3, true);
    std::vector<Image> images;
    for (const bool coloured : {false, true}) {
      Look look(coloured ? test::with_six_colours(mesh) : mesh);
      look.window->material() = gl::Material::wax;
      images.push_back(look.picture());
      look.window->material() = gl::Material::lit;
      images.push_back(look.picture());
    }
    CHECK(images[0] == images[2]);
    CHECK_FALSE(images[1] == images[3]);
  }

  TEST_CASE("a line is where a fingertip's radius meets the model, and nowhere else") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Look look(test::sphere(60, 120, 1.0));
    look.window->parts().hands = false;
    look.window->material() = gl::Material::plaster;
    look.picture();
    CHECK(line_pixels(look.picture()).empty()); // no hand
    const Camera& camera = look.window->camera();
    const double radius = look.builder.size_m().x() / 2;
    const Vector3d middle(0.0, radius, 0.0);
    const Vector3d out = (camera.eye() - middle).normalized();
    const Vector3d touched = middle + radius * out;
    for (const double reach : {0.3 * radius, 0.6 * radius}) {
      put_tip(look.frame, touched + look.builder.origin_m(), reach);
      const std::vector<Vector2d> line = line_pixels(look.picture());
      // The sphere about the tip meets the ball in a circle, seen from its axis.
      const double behind = reach * reach / (2.0 * radius);
      const double across = std::sqrt(reach * reach - behind * behind);
      const double distance = (camera.eye() - touched).norm() + behind;
      const double expected_px = across / distance / camera.tangent() * size.height / 2.0;
      const auto centre = pixel_of(camera, touched, size);
      REQUIRE(centre);
      REQUIRE(line.size() > 6.0 * expected_px); // of 2 pi radii, two pixels wide
      CHECK(line.size() < 20.0 * expected_px);
      double sum = 0.0;
      for (const Vector2d& place : line)
        sum += (place - *centre).norm();
      CHECK(sum / static_cast<double>(line.size()) == doctest::Approx(expected_px).epsilon(0.02));
    }
    look.window->parts().radii = false;
    CHECK(line_pixels(look.picture()).empty());
    look.window->parts().radii = true;
    put_tip(look.frame, touched + 1.2 * radius * out + look.builder.origin_m(), radius);
    CHECK(line_pixels(look.picture()).empty()); // too far away
  }

  TEST_CASE("the part that a hand would take has an outline around it, and the others none") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    deform::Mesh mesh = test::sphere(30, 60, 0.5);
    const deform::Mesh one = mesh;
    const auto count = static_cast<std::uint32_t>(one.vertices.cols());
    mesh.vertices.conservativeResize(3, 2 * count);
    mesh.vertices.rightCols(count) = one.vertices.colwise() + Vector3d(1.5, 0.0, 0.0);
    for (std::size_t face = 0; face + 1 < one.face_starts.size(); ++face) {
      for (auto at = one.face_starts[face]; at < one.face_starts[face + 1]; ++at)
        mesh.face_corners.push_back(one.face_corners[at] + count);
      mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
    }
    Look look(mesh);
    look.window->parts().ground = false;
    look.window->material() = gl::Material::plaster;
    const auto parts = std::make_shared<const deform::ModelParts>(mesh, look.layout);
    CHECK(line_pixels(look.picture()).empty());
    look.window->set_parts_in_reach(parts, {deform::no_index, 1});
    const Image image = look.picture();
    const std::vector<Vector2d> line = line_pixels(image);
    const double metre = look.builder.units_per_metre();
    const Camera& camera = look.window->camera();
    const auto centre = pixel_of(camera, Vector3d(0.75, 0.5, 0.0) / metre, size);
    const auto top = pixel_of(
        camera, Vector3d(0.75, 0.5, 0.0) / metre + 0.5 / metre * camera.axes().row(1).transpose(),
        size);
    REQUIRE(centre);
    REQUIRE(top);
    const double radius_px = (*top - *centre).norm();
    CHECK(line.size() > 6.0 * radius_px);
    for (const Vector2d& place : line) {
      CHECK((place - *centre).norm() > 0.97 * radius_px - 2.0);
      CHECK((place - *centre).norm() < 1.05 * radius_px + 4.0);
    }
    look.window->set_parts_in_reach(parts, {deform::no_index, deform::no_index});
    CHECK(line_pixels(look.picture()).empty());
  }

  TEST_CASE("quick pictures, of merged triangles, hardly differ from fine ones") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    deform::Mesh mesh = test::sphere(160, 320, 1.0);
    for (Eigen::Index at = 0; at < mesh.vertices.cols(); ++at) {
      const Vector3d out = mesh.vertices.col(at);
      mesh.vertices.col(at) *=
          1.0 + 0.1 * std::sin(7.0 * out.x()) * std::sin(7.0 * out.y()) * std::sin(7.0 * out.z());
    }
    Look look(mesh);
    for (const auto material : {gl::Material::lit, gl::Material::clay}) {
      look.window->material() = material;
      const Image fine = look.picture();
      for (const double part : {1.0, 0.5}) {
        const Image quick = look.window->moving_screenshot(part);
        const double off = mean_difference(fine, quick);
        CHECK(off > 0.0); // it is another picture
        CHECK(off < (part < 1.0 ? 2.0 : 1.0));
      }
    }
  }

  TEST_CASE("the window shows the colours that pictures show") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    deform::Mesh mesh = test::sphere(30, 60, 1.0);
    mesh.look.materials = {
        {"a", Eigen::Vector4f(0.5F, 0.1F, 0.1F, 1.0F), deform::no_index, true},
        {"b", Eigen::Vector4f(0.1F, 0.1F, 0.6F, 1.0F), deform::no_index, true},
        {"not drawn", Eigen::Vector4f(1.0F, 1.0F, 1.0F, 0.0F), deform::no_index, false}};
    mesh.look.vertex_colours = Eigen::Matrix4Xf::Ones(4, mesh.vertices.cols());
    for (Eigen::Index vertex = 0; vertex < mesh.vertices.cols(); ++vertex)
      if (mesh.vertices(1, vertex) > 0.0) mesh.look.vertex_colours(1, vertex) = 0.2F;
    for (std::uint32_t face = 0; face < mesh.face_count(); ++face)
      mesh.look.face_materials.push_back(face % 7 == 0 ? 2 : face / 300 % 2);
    // A texture on the second, that turns its blue into green on one side.
    Image picture({64, 64}, {255, 255, 255});
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 32; ++x)
        picture.at(x, y) = {255, 60, 0};
    const test::TemporaryFolder folder;
    REQUIRE(write_png(folder.path() / "t.png", picture));
    std::ifstream file(folder.path() / "t.png", std::ios::binary);
    mesh.look.textures = {
        {"t.png", std::make_shared<const std::string>(std::istreambuf_iterator<char>(file),
                                                      std::istreambuf_iterator<char>())}};
    mesh.look.materials[1] = {"b", Eigen::Vector4f(0.4F, 0.4F, 0.6F, 1.0F), 0, true};
    mesh.texcoords = (mesh.vertices.topRows<2>() / 2.0).array() + 0.5;
    mesh.corner_texcoords = mesh.face_corners;
    check_same_hues(mesh);
  }

  TEST_CASE("the window shows the colours of corners that pictures show") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    check_same_hues(test::with_six_colours(test::cube_of_cells(3, true)));
  }
}

} // namespace window_picture_test
