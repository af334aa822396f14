#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <doctest/doctest.h>

#include "render/camera.hpp"

namespace camera_test {

using namespace nendo::render;

TEST_SUITE("camera") {
  TEST_CASE("a view's name says from where one looks") {
    const auto axis = [](const char* name) -> Eigen::Vector3d {
      Camera camera;
      camera.view = *view_named(name);
      return camera.eye() / camera.distance_m;
    };
    CHECK((axis("front") - Eigen::Vector3d::UnitZ()).norm() < 1e-12);
    CHECK((axis("back") + Eigen::Vector3d::UnitZ()).norm() < 1e-12);
    CHECK((axis("right") - Eigen::Vector3d::UnitX()).norm() < 1e-12);
    CHECK((axis("left") + Eigen::Vector3d::UnitX()).norm() < 1e-12);
    CHECK((axis("top") - Eigen::Vector3d::UnitY()).norm() < 1e-12);
    CHECK((axis("45,0") - Eigen::Vector3d(1, 0, 1).normalized()).norm() < 1e-12);
    for (const char* bad :
         {"", "up", "1", "1,", ",1", "1,2,3", "nan,0", "0,91", "361,0", "1e400,0"})
      CHECK_FALSE(view_named(bad));
  }

  TEST_CASE("the axes are a right-handed frame, and pictures are made of it as OpenGL makes them") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angle(-90.0, 90.0);
    for (int round = 0; round < 50; ++round) {
      Camera camera;
      camera.view = {4 * angle(random), angle(random)};
      camera.target = {angle(random) / 90, 0.3, -0.2};
      const Eigen::Matrix3d rows = camera.axes();
      CHECK((rows * rows.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-12);
      CHECK(rows.determinant() == doctest::Approx(1.0));
      const Eigen::Vector4d middle = camera.projection(1.5) * camera.target.homogeneous();
      CHECK(std::abs(middle.x()) + std::abs(middle.y()) < 1e-9);
      CHECK(middle.w() == doctest::Approx(camera.distance_m));
      const Eigen::Vector3d above =
          camera.target + camera.tangent() * camera.distance_m * rows.row(1).transpose();
      const Eigen::Vector4d top = camera.projection(1.5) * above.homogeneous();
      CHECK(top.y() / top.w() == doctest::Approx(1.0));
    }
  }

  TEST_CASE("framing has all points in the picture, and touches its margin") {
    std::mt19937 random(2);
    std::uniform_real_distribution<float> place(-1.0F, 1.0F);
    for (int round = 0; round < 100; ++round) {
      std::vector<Eigen::Vector3f> points;
      for (int point = 0; point < 20; ++point)
        points.emplace_back(0.5F * place(random), place(random), 0.3F * place(random) + 5.0F);
      const double aspect = 0.5 + 0.02 * round;
      const View view{180.0 * static_cast<double>(place(random)),
                      90.0 * static_cast<double>(place(random))};
      const Camera camera = framing(points, view, aspect, 0.1);
      points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
      CHECK(framing(points, view, aspect, 0.1).distance_m == camera.distance_m);
      points.pop_back();
      double most = 0.0;
      for (const auto& point : points) {
        const Eigen::Vector4d clip =
            camera.projection(aspect) * point.cast<double>().eval().homogeneous();
        REQUIRE(clip.w() > 0.0);
        most = std::max({most, std::abs(clip.x() / clip.w()), std::abs(clip.y() / clip.w())});
      }
      CHECK(most == doctest::Approx(0.9).epsilon(1e-6));
    }
  }

  TEST_CASE("a mouse can do what it likes: the camera stays finite and within its limits") {
    Camera camera;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> way(-1e4, 1e4);
    for (int step = 0; step < 2000; ++step) {
      camera.orbit(way(random), way(random));
      camera.pan(way(random), way(random), 0.0);
      camera.zoom(way(random));
      REQUIRE(camera.eye().allFinite());
      REQUIRE(std::abs(camera.view.elevation_deg) <= 90.0);
      REQUIRE(camera.distance_m >= Camera::min_distance_m);
      REQUIRE(camera.distance_m <= Camera::max_distance_m);
    }
  }
}

} // namespace camera_test
