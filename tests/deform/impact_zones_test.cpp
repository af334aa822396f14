#include "clay/impact_zones.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/triangles.hpp>

#include "join/self_intersections.hpp"
#include "reference/icosphere.hpp"
#include "support/clay_strokes.hpp"
#include "support/restraint.hpp"
#include "support/self_intersections.hpp"

namespace impact_zones_test {

using namespace nendo::deform;
using nendo::test::StrokeParts;

namespace {

/// A ball in blocks, with what measures it.
struct Ball {
  explicit Ball(int level)
      : mesh(nendo::reference::icosphere(level, 1.0)), corners(corners_of_triangles(mesh)),
        layout(mesh.vertices), shape(layout.pack()), volume(layout, corners),
        meetings(layout, corners), zones(layout, corners) {
    volume.volume(shape);
  }
  void move(std::size_t place, const Eigen::Vector3f& by) {
    VertexBlock& block = shape.shape.data()[place / block_size];
    block.x[place % block_size] += by.x();
    block.y[place % block_size] += by.y();
    block.z[place % block_size] += by.z();
    shape.shape.set_stamp(place / block_size, BlockShape::new_stamp());
    shape.bounds[place / block_size] = bounds_of(block);
  }
  /// Pushes a dent from above, or deepens it. It comes out below where all is more than 2.
  void dent(double depth) {
    for (std::size_t place = 0; place < layout.vertex_count(); ++place) {
      const Eigen::Vector3d at = mesh.vertices.col(layout.order()[place]);
      const auto aside = static_cast<float>(at.head<2>().norm() / 0.4);
      if (at.z() > 0.0 && aside < 1.0F)
        move(place,
             {0.0F, 0.0F, -static_cast<float>(depth / layout.unit()) * (1.0F - aside * aside)});
    }
  }
  Mesh shown() const {
    Mesh made = mesh;
    layout.unpack(shape.shape, made.vertices);
    return made;
  }

  Mesh mesh;
  std::vector<std::uint32_t> corners;
  BlockLayout layout;
  BoundedShape shape;
  VolumeKeeper volume;
  FaceMeetings meetings;
  ImpactZones zones;
};

/// The same, found by the boxes of all faces.
std::size_t meetings_of(const Ball& ball) {
  std::vector<SpacePoint> points;
  for (std::size_t place = 0; place < ball.layout.vertex_count(); ++place) {
    const Eigen::Vector3d at = vertex_at(ball.shape.shape, place).cast<double>();
    points.push_back({at.x(), at.y(), at.z()});
  }
  const std::vector<std::uint32_t> places = ball.layout.places();
  std::vector<Corners> faces;
  for (std::size_t at = 0; at < ball.corners.size(); at += 3)
    faces.push_back(
        {places[ball.corners[at]], places[ball.corners[at + 1]], places[ball.corners[at + 2]]});
  return self_intersections(points, faces).size();
}

/// A ball of clay, and violent strokes of a body on it.
struct StrokedBall {
  explicit StrokedBall(StrokeParts of) : body(std::move(of)) {}

  /// Calls `press` with each pose of the body on its way.
  template <class Press>
  void stroke(int strokes, const Press& press) {
    for (int at = 0; at < strokes; ++at)
      nendo::test::violent_stroke(
          random, body, [&](const StrokeParts& parts) { clay.begin(parts); }, press);
  }
  Mesh shown() const {
    Mesh made = mesh;
    shape.layout().unpack(clay.shape(), made.vertices);
    return made;
  }

  StrokeParts body;
  Mesh mesh = nendo::reference::icosphere(5, nendo::test::stroked_ball_mm);
  SculptedShape shape{mesh.vertices, {}};
  ClayDeformer clay{shape, corners_of_triangles(mesh), 1, body.size(), {.radius_mm = 30.0}};
  std::mt19937 random{2004};
};

} // namespace

TEST_SUITE("impact_zones") {
  TEST_CASE("the same pairs of faces are found as by looking at all") {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> shake(-0.02F, 0.02F);
    for (const double depth : {1.0, 1.9, 2.05, 2.4}) {
      CAPTURE(depth);
      Ball ball(4);
      const BlockShape before = ball.shape.shape;
      ball.dent(depth);
      for (std::size_t place = 0; place < ball.layout.vertex_count(); ++place)
        if (depth > 2.3) ball.move(place, {shake(random), shake(random), shake(random)});
      ball.volume.volume(ball.shape);
      ball.meetings.find(ball.shape, before, ball.volume);
      REQUIRE_FALSE(ball.meetings.is_given_up());
      CHECK(ball.meetings.pairs().size() == meetings_of(ball));
      CHECK((depth > 2.0) == !ball.meetings.pairs().empty());
    }
  }

  TEST_CASE("what met before is left as it is") {
    Ball ball(4);
    ball.dent(2.2);
    const BlockShape before = ball.shape.shape;
    ball.move(0, {0.0F, 0.0F, 1e-6F});
    ball.volume.volume(ball.shape);
    ball.meetings.find(ball.shape, before, ball.volume);
    CHECK(meetings_of(ball) > 0);
    CHECK(ball.meetings.pairs().empty());
  }

  TEST_CASE("a dent that would come out below stops before, with the least zone") {
    Ball ball(4);
    ball.dent(1.9);
    ball.zones.begin(ball.shape);
    ball.dent(0.15);
    ball.volume.volume(ball.shape);
    REQUIRE(meetings_of(ball) > 0);
    const auto moved = ball.zones.keep_apart(ball.shape, ball.volume, nullptr);
    REQUIRE(moved);
    CHECK(*moved > 0);
    CHECK(*moved < 200);
    CHECK(meetings_of(ball) == 0);
    CHECK(nendo::test::count_self_intersections(ball.shown()) == 0);
  }

  TEST_CASE("a zone with a vertex that a mask holds stays where it was") {
    Ball ball(4);
    ball.dent(1.9);
    const BlockShape before = ball.shape.shape;
    ball.zones.begin(ball.shape);
    ball.dent(0.15);
    ball.volume.volume(ball.shape);
    const VertexMask mask(ball.layout, Eigen::VectorXd::Zero(ball.mesh.vertices.cols()));
    const auto moved = ball.zones.keep_apart(ball.shape, ball.volume, &mask);
    REQUIRE(moved);
    std::size_t back = 0;
    for (std::size_t place = 0; place < ball.layout.vertex_count(); ++place)
      if (vertex_at(ball.shape.shape, place) == vertex_at(before, place)) ++back;
    CHECK(back >= *moved);
    CHECK(meetings_of(ball) == 0);
  }

  TEST_CASE("a shape that crumples all over is reverted, bit for bit") {
    Ball ball(5);
    const BlockShape before = ball.shape.shape;
    ball.zones.begin(ball.shape);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> shake(-0.2F, 0.2F);
    for (std::size_t place = 0; place < ball.layout.vertex_count(); ++place)
      ball.move(place, {shake(random), shake(random), shake(random)});
    ball.volume.volume(ball.shape);
    CHECK_FALSE(ball.zones.keep_apart(ball.shape, ball.volume, nullptr));
    for (std::size_t place = 0; place < ball.layout.vertex_count(); ++place)
      REQUIRE(vertex_at(ball.shape.shape, place) == vertex_at(before, place));
  }

  TEST_CASE("a call that is reverted has moved nothing, and its way waits") {
    StrokedBall ball(nendo::test::stroking_rod());
    const ClayDeformer& clay = ball.clay;
    int taken_back = 0;
    ball.stroke(20, [&](const StrokeParts& parts) {
      const BlockShape before = clay.shape();
      const double volume = clay.volume();
      const ClayReport report = ball.clay.press_to(parts);
      if (report.passes == 0 || report.is_moved) return;
      ++taken_back;
      CHECK(report.remaining_path_mm > 0.0);
      CHECK(clay.volume() == volume);
      CHECK(report.carried_mm == 0.0);
      for (std::size_t block = 0; block < before.block_count(); ++block)
        REQUIRE(clay.shape().stamp(block) == before.stamp(block));
    });
    CHECK(taken_back > 0);
  }

  TEST_CASE("the reported volume is the shape's, also where faces were kept apart") {
    StrokedBall ball(nendo::test::stroking_finger());
    double max_off = 0.0;
    int kept_apart = 0;
    ball.stroke(14, [&](const StrokeParts& parts) {
      if (ball.clay.press_to(parts).kept_apart == 0) return;
      ++kept_apart;
      max_off = std::max(max_off, std::abs(ball.clay.volume() / volume_of(ball.shown()) - 1.0));
    });
    CHECK(kept_apart > 0);
    CHECK(max_off < 2e-6);
  }

  TEST_CASE("strokes that tear a ball of clay leave no faces that cross, and allocate nothing") {
    std::size_t kept_apart = 0, allocations = 0;
    for (const StrokeParts& body : {nendo::test::stroking_finger(), nendo::test::stroking_rod()}) {
      StrokedBall ball(body);
      ball.stroke(14, [&](const StrokeParts& parts) {
        const nendo::test::Restraint restraint;
        kept_apart += ball.clay.press_to(parts).kept_apart;
        allocations += restraint.counts().allocations;
      });
      const Mesh made = ball.shown();
      CHECK(made.vertices.allFinite());
      CHECK(nendo::test::count_self_intersections(made) == 0);
    }
    CHECK(kept_apart > 0);
    CHECK(allocations == 0);
  }
}

} // namespace impact_zones_test
