#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/triangles.hpp>

#include "reference/icosphere.hpp"
#include "support/contact_parts.hpp"
#include "support/restraint.hpp"

namespace clay_mask_test {

using namespace nendo;
using namespace nendo::deform;
using Eigen::Vector3d;
using Parts = std::vector<ContactPart>;

constexpr double radius_mm = 30.0;

/// Held where x > 5 mm, free where x < -5 mm, and more and more of each between.
double weight_at(const Vector3d& place) {
  return std::clamp((5.0 - place[0]) / 10.0, 0.0, 1.0);
}

struct MaskedBall {
  Mesh mesh = reference::icosphere(4, radius_mm);
  SculptedShape shape{mesh.vertices, DeformerOptions{.undo_bytes = 8 << 20}};
  Eigen::VectorXd weights;
  std::unique_ptr<ClayDeformer> clay;

  MaskedBall() : weights(mesh.vertices.cols()) {
    for (Eigen::Index at = 0; at < weights.size(); ++at)
      weights[at] = weight_at(mesh.vertices.col(at));
    ClayOptions options;
    options.mask = std::make_shared<VertexMask>(shape.layout(), weights);
    clay = std::make_unique<ClayDeformer>(shape, corners_of_triangles(mesh), 1, 1, options);
  }
  Mesh now() const {
    Mesh result = mesh;
    shape.layout().unpack(clay->shape(), result.vertices);
    return result;
  }
};

/// A fingertip that comes from that side, its tip 1 mm off the ball.
Parts finger_from(const Vector3d& side) {
  return {test::cone(side * (radius_mm + 9.0), side * (radius_mm + 45.0), 8.0, 9.0)};
}

Vector3d random_side(std::mt19937& random) {
  std::normal_distribution<double> number;
  const double x = number(random);
  const double y = number(random);
  return Vector3d(x, y, number(random)).normalized();
}

TEST_SUITE("clay_mask") {
  TEST_CASE(
      "what a mask holds does not move by a bit, wherever hands press, and the volume stays") {
    std::mt19937 random(12);
    MaskedBall ball;
    const double whole = volume_of(ball.mesh);
    for (int stroke = 0; stroke < 12; ++stroke) {
      const Vector3d side = random_side(random);
      Parts parts = finger_from(side);
      REQUIRE(is_solved(ball.clay->begin(parts)));
      for (const double by : {-1.0, -1.0, -1.0, -1.0, -1.0, -1.0, 2.0, 2.0, 2.0, 5.0}) {
        parts = test::moved(parts, Vector3d(by * side));
        CHECK(ball.clay->press_to(parts).status == FieldStatus::ok);
      }
      parts = test::moved(parts, Vector3d(100.0 * side));
      for (int wait = 0; wait < 200; ++wait)
        ball.clay->press_to(parts);
      const Mesh now = ball.now();
      REQUIRE(now.vertices.allFinite());
      for (Eigen::Index at = 0; at < now.vertices.cols(); ++at)
        if (ball.weights[at] <= 0.0) CHECK(now.vertices.col(at) == ball.mesh.vertices.col(at));
      CHECK(std::abs(volume_of(now) / whole - 1.0) < 1e-3);
      CHECK_FALSE(ball.clay->press_to(parts).is_moved); // long after the hand has gone
    }
    CHECK((ball.now().vertices - ball.mesh.vertices).colwise().norm().maxCoeff() > 2.0);
  }

  TEST_CASE("hands pass through what is held, and press what is free as if there were no mask") {
    MaskedBall ball;
    Parts inside = finger_from(Vector3d::UnitX());
    REQUIRE(is_solved(ball.clay->begin(inside)));
    for (int call = 0; call < 12; ++call) {
      inside = test::moved(inside, Vector3d(-1.0, 0.0, 0.0));
      const ClayReport& report = ball.clay->press_to(inside);
      CHECK(report.passes == 0);
      CHECK(report.penetration_mm == 0.0);
      CHECK(ball.clay->contacts().empty());
    }
    CHECK(ball.now().vertices == ball.mesh.vertices);

    Parts free = finger_from(-Vector3d::UnitX());
    REQUIRE(is_solved(ball.clay->begin(free)));
    for (int call = 0; call < 6; ++call) {
      free = test::moved(free, Vector3d(1.0, 0.0, 0.0));
      CHECK(ball.clay->press_to(free).penetration_mm < 0.05);
    }
    CHECK(ball.clay->contacts().size() > 0);
    CHECK(ball.now().vertices.row(0).minCoeff() > -radius_mm);
  }

  TEST_CASE("strokes at a mask are undone and done again to the last bit") {
    MaskedBall ball;
    std::vector<Points> shapes{ball.now().vertices};
    for (const double up : {1.0, -1.0, 0.6}) {
      const Vector3d side = Vector3d(-0.1, up, 0.3).normalized();
      Parts parts = finger_from(side);
      REQUIRE(is_solved(ball.clay->begin(parts)));
      for (int call = 0; call < 8; ++call)
        ball.clay->press_to(parts = test::moved(parts, Vector3d(-side)));
      for (int call = 0; call < 30; ++call)
        ball.clay->press_to(parts = test::moved(parts, Vector3d(2.0 * side)));
      ball.clay->release(true);
      shapes.push_back(ball.now().vertices);
      CHECK(shapes.back() != shapes[shapes.size() - 2]);
    }
    const Parts away = finger_from(Vector3d(0.0, 5.0, 0.0));
    for (int round = 0; round < 2; ++round) {
      for (std::size_t at = shapes.size() - 1; at-- > 0;) {
        REQUIRE(is_solved(ball.clay->go(HistoryMove::undo, away)));
        CHECK(ball.now().vertices == shapes[at]);
      }
      for (std::size_t at = 1; at < shapes.size(); ++at) {
        REQUIRE(is_solved(ball.clay->go(HistoryMove::redo, away)));
        CHECK(ball.now().vertices == shapes[at]);
      }
    }
  }

  TEST_CASE("pressing at a mask does not allocate or lock") {
    MaskedBall ball;
    Parts parts = finger_from(Vector3d(-0.2, 1.0, 0.0).normalized());
    REQUIRE(is_solved(ball.clay->begin(parts)));
    std::vector<Parts> all;
    for (int call = 0; call < 30; ++call)
      all.push_back(parts = test::moved(parts, Vector3d(0.0, call < 10 ? -0.8 : 0.5, 0.0)));
    ball.clay->press_to(all.front());
    const test::Restraint restraint;
    for (const Parts& one : all)
      ball.clay->press_to(one);
    const test::RestraintCounts counts = restraint.counts();
    CHECK(counts.allocations + counts.frees + counts.locks == 0);
  }
}

} // namespace clay_mask_test
