#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "viewer/pointing.hpp"

namespace tip_mover_test {

using namespace nendo;
using namespace nendo::render;
using namespace nendo::viewer;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr Size size{900, 600};

Vector2d seen_at(const Camera& camera, const Vector3d& place) {
  const Eigen::Vector4d clip =
      camera.projection(1.0 * size.width / size.height) * place.homogeneous();
  return {(1.0 + clip.x() / clip.w()) / 2 * size.width,
          (1.0 - clip.y() / clip.w()) / 2 * size.height};
}

hand::HandPose open_hand() {
  Eigen::Isometry3d wrist = Eigen::Isometry3d::Identity();
  wrist.translation() = Vector3d(0.1, 0.4, 0.2);
  return hand::HandSkeleton(Side::right).pose({}, wrist);
}

Camera above() {
  Camera camera;
  camera.target = Vector3d(0.1, 0.4, 0.1);
  camera.distance_m = 0.8;
  camera.view = {20.0, 70.0};
  return camera;
}

} // namespace

TEST_SUITE("tip_mover") {
  TEST_CASE("the fingertip at the pointer is the one that is seen there") {
    const auto pose = open_hand();
    const Camera camera = above();
    for (Eigen::Index finger = 0; finger < 5; ++finger) {
      const Vector2d pixel = seen_at(camera, pose.fingertip_positions().col(finger));
      for (const Vector2d& off : {Vector2d(0.0, 0.0), Vector2d(3.0, -3.0)})
        CHECK(tip_at(camera, pose, pixel + off, size) == static_cast<hand::Finger>(finger));
    }
    CHECK_FALSE(tip_at(camera, pose, Vector2d(-500.0, -500.0), size));
    Camera behind = camera; // looks away from the hand
    behind.target = camera.eye() + (camera.eye() - camera.target);
    CHECK_FALSE(tip_at(behind, pose, Vector2d(450.0, 300.0), size));
  }

  TEST_CASE("its target stays under the pointer, in the picture's plane, and the wheel pushes it") {
    const auto pose = open_hand();
    const Camera camera = above();
    const Vector3d tip = pose.fingertip_positions().col(1);
    PlaceMover mover;
    mover.begin(tip, Vector3d::Zero());
    CHECK(mover.place_m() == tip);
    for (int step = 0; step < 8; ++step)
      mover.shift(camera, 5.0, -3.0, size.height);
    CHECK((seen_at(camera, mover.place_m()) - seen_at(camera, tip) - Vector2d(40.0, -24.0)).norm() <
          1e-6);
    CHECK(std::abs(camera.axes().row(2).dot(mover.place_m() - tip)) < 1e-12);
    const Vector3d before = mover.place_m();
    mover.push(camera, 2.0);
    CHECK((mover.place_m() - before + 0.02 * camera.axes().row(2).transpose()).norm() < 1e-12);
    mover.shift(camera, 1e12, -1e12, 0.0);
    CHECK(mover.place_m().allFinite());
    CHECK(mover.place_m().cwiseAbs().maxCoeff() <= 2.0);
  }
}

} // namespace tip_mover_test
