#include "edit/shape_pictures.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace shape_pictures_test {

using namespace nendo;
using namespace nendo::edit;
using Shape = ShapePictures::Shape;
using Picture = ShapePictures::Picture;

namespace {

std::shared_ptr<const flow::ModelVersion> version_of(const deform::Mesh& mesh) {
  return std::make_shared<const flow::ModelVersion>(0, mesh, deform::BlockLayout(mesh.vertices),
                                                    flow::UndoSpace{}, nullptr);
}

/// The model, `factor` times as high.
Shape stretched(const std::shared_ptr<const flow::ModelVersion>& model, double factor) {
  deform::Points vertices = model->mesh.vertices;
  vertices.row(1) *= factor;
  auto shape = std::make_shared<timeline::CachedShape>();
  shape->shape = model->layout().pack(vertices);
  shape->model = model;
  return shape;
}

std::vector<Picture> wait_for(ShapePictures& pictures, const std::vector<Shape>& shapes) {
  pictures.hurry(); // also while other tests run
  for (;;) {
    auto found = pictures.of(shapes);
    if (std::ranges::count(found, nullptr) == std::ranges::count(shapes, nullptr)) return found;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

} // namespace

TEST_SUITE("shape_pictures") {
  TEST_CASE("a picture shows its shape, of a dense model as well") {
    for (const std::uint32_t rings : {30U, 150U}) {
      const auto model = version_of(test::sphere(rings, 2 * rings, 1.0));
      ShapePictures pictures(2.0);
      const auto found = wait_for(pictures, {stretched(model, 1.0), stretched(model, 0.5)});
      const auto rows = [&](const render::Image& image) { // of the middle, that are of clay
        int count = 0;
        for (int row = 0; row < image.size().height; ++row) {
          const render::Pixel pixel = image.at(image.size().width / 2, row);
          count += pixel[0] > pixel[2] + 25 ? 1 : 0;
        }
        return count;
      };
      CHECK(found[0]->size() == ShapePictures::picture_size);
      CHECK(rows(*found[0]) == doctest::Approx(0.92 * 112).epsilon(0.06));
      CHECK(rows(*found[1]) == doctest::Approx(0.46 * 112).epsilon(0.10));
    }
  }

  TEST_CASE("none is drawn twice: neither one that was there, nor that of an equal shape") {
    const auto model = version_of(test::sphere(10, 20, 1.0));
    ShapePictures pictures(2.0);
    const std::vector<Shape> shapes{stretched(model, 1.0), stretched(model, 1.2), nullptr,
                                    stretched(model, 1.0)};
    const auto first = wait_for(pictures, shapes);
    CHECK(first[0] == first[3]);
    CHECK(first[0] != first[1]);
    CHECK(first[2] == nullptr);
    CHECK(pictures.drawn_count() == 2);
    CHECK(wait_for(pictures, shapes) == first);
    CHECK(wait_for(pictures, {shapes[1], stretched(model, 1.0)})[1] == first[0]);
    CHECK(pictures.drawn_count() == 2);
  }

  TEST_CASE("pictures of shapes that are gone, or were not seen for long, are given up") {
    const auto model = version_of(test::sphere(3, 4, 1.0));
    ShapePictures pictures(2.0);
    std::vector<Shape> all;
    for (int at = 0; at < 140; ++at)
      all.push_back(stretched(model, 1.0 + 0.01 * at));
    const std::weak_ptr<const render::Image> first = wait_for(pictures, {all[0]}).front();
    for (const Shape& shape : all)
      wait_for(pictures, {shape});
    CHECK(first.expired());
    CHECK(pictures.drawn_count() == 140);
  }

  TEST_CASE("who asks takes no lock, and does not wait for what is drawn") {
    const auto model = version_of(test::sphere(150, 300, 1.0));
    ShapePictures pictures(2.0);
    std::vector<Shape> shapes;
    for (int at = 0; at < 4; ++at)
      shapes.push_back(stretched(model, 1.0 + 0.1 * at));
    pictures.hurry();
    const test::Restraint restraint;
    CHECK(std::ranges::count(pictures.of(shapes), nullptr) == 4);
    while (std::ranges::count(pictures.of(shapes), nullptr) > 0)
      std::this_thread::yield();
    CHECK(restraint.counts().locks == 0);
  }
}

} // namespace shape_pictures_test
