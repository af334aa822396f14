#include "bench/gouraud.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "render/picture.hpp"
#include "support/test_meshes.hpp"

namespace gouraud_test {

using namespace nendo;
using namespace nendo::render;
using bench::GouraudRenderer;

namespace {

constexpr Size size{160, 120};

Scene ball() {
  const auto mesh = test::sphere(24, 48, 1.0);
  SceneFrame moment;
  moment.vertices = mesh.vertices;
  Scene scene;
  SceneBuilder(mesh).build(moment, {.ground = false}, scene);
  return scene;
}

Surface square(float z, const Eigen::Vector3f& normal) {
  Surface surface;
  surface.places = {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}};
  surface.normals.assign(4, normal);
  surface.corners = {0, 1, 2, 0, 2, 3};
  return surface;
}

void append(Surface& to, const Surface& from) {
  const auto first = static_cast<std::uint32_t>(to.places.size());
  to.places.insert(to.places.end(), from.places.begin(), from.places.end());
  to.normals.insert(to.normals.end(), from.normals.begin(), from.normals.end());
  for (const std::uint32_t corner : from.corners)
    to.corners.push_back(first + corner);
}

} // namespace

TEST_SUITE("gouraud") {
  TEST_CASE("it covers the pixels that the silhouette has") {
    const Scene scene = ball();
    const Camera camera = framing(scene.outline(), {30.0, 20.0}, 4.0 / 3.0);
    const Image outline = silhouette(scene, camera, size);
    GouraudRenderer renderer(size);
    const Image empty = renderer.draw({}, camera);
    const Image& drawn = renderer.draw(scene.model, camera);
    int covered = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const bool inside = outline.at(x, y)[0] > 127;
        CHECK((drawn.at(x, y) != empty.at(x, y)) == inside);
        covered += inside ? 1 : 0;
      }
    CHECK(covered > 4000);
  }

  TEST_CASE("a face is brightest where it looks at the lamp, over the camera's left shoulder") {
    const Scene scene = ball();
    const Camera camera = framing(scene.outline(), {}, 4.0 / 3.0);
    GouraudRenderer renderer(size);
    const Image& drawn = renderer.draw(scene.model, camera);
    const auto radius = 0.47 * size.height;
    const auto at = [&](double right, double up) {
      return drawn.at(static_cast<int>(size.width / 2.0 + radius * right),
                      static_cast<int>(size.height / 2.0 - radius * up))[0];
    };
    const double length = std::sqrt(0.4 * 0.4 + 0.5 * 0.5 + 0.8 * 0.8);
    const int brightest = at(-0.4 / length, 0.5 / length);
    int last = brightest;
    for (const double further : {0.4, 0.8, 1.2}) { // to the right, farther and farther from it
      const int here = at(-0.4 / length + further, 0.5 / length - 0.5 * further);
      CHECK(here < last);
      last = here;
    }
  }

  TEST_CASE("what is nearer hides what is behind it, in whichever order they come") {
    Camera camera;
    camera.distance_m = 10.0;
    // Their light tells them apart.
    const Surface near = square(0.0F, {0.8F, 0.0F, 0.6F});
    const Surface far = square(-1.0F, {0.0F, 0.0F, 1.0F});
    GouraudRenderer renderer(size);
    const Pixel of_near = renderer.draw(near, camera).at(80, 60);
    REQUIRE(of_near != renderer.draw(far, camera).at(80, 60));
    for (const bool near_first : {true, false}) {
      Surface both = near_first ? near : far;
      append(both, near_first ? far : near);
      CHECK(renderer.draw(both, camera).at(80, 60) == of_near);
    }
  }

  TEST_CASE("triangles that reach behind the camera are left out") {
    Camera camera;
    camera.distance_m = 0.5;
    Surface along = square(0.0F, Eigen::Vector3f::UnitZ());
    along.places[0].z() = 3.0F; // behind the eye; both triangles have this corner
    GouraudRenderer renderer(size);
    const Image empty = renderer.draw({}, camera);
    CHECK(renderer.draw(along, camera) == empty);
  }
}

} // namespace gouraud_test
