// Parts that hands move, against products of matrices in double precision.

#include <nendo/deform/part_mover.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "support/test_meshes.hpp"

namespace part_mover_test {

using namespace nendo;
using namespace nendo::deform;
using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

constexpr double far_apart = 3.0;

/// Balls of radius 1 in a row along x, in one mesh whose vertices take turns.
Mesh row_of_balls(int count) {
  const Mesh ball = test::sphere(9, 16, 1.0);
  Mesh row;
  row.vertices.resize(3, count * ball.vertices.cols());
  for (Eigen::Index at = 0; at < ball.vertices.cols(); ++at)
    for (int number = 0; number < count; ++number)
      row.vertices.col(count * at + number) =
          ball.vertices.col(at) + Vector3d(far_apart * number, 0.0, 0.0);
  for (int number = 0; number < count; ++number)
    for (std::size_t face = 0; face < ball.face_count(); ++face) {
      for (std::uint32_t at = ball.face_starts[face]; at < ball.face_starts[face + 1]; ++at)
        row.face_corners.push_back(static_cast<std::uint32_t>(count) * ball.face_corners[at] +
                                   static_cast<std::uint32_t>(number));
      row.face_starts.push_back(static_cast<std::uint32_t>(row.face_corners.size()));
    }
  return row;
}

Isometry3d any_motion(std::mt19937& random, double farthest) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Isometry3d motion = Isometry3d::Identity();
  motion.rotate(
      AngleAxisd(3.0 * any(random), Vector3d(any(random), any(random), 1.5).normalized()));
  motion.translation() = farthest * Vector3d(any(random), any(random), any(random));
  return motion;
}

/// Three balls, and two hands, of which each is open at first.
struct Bench {
  static constexpr int balls = 3;

  explicit Bench(std::size_t hands = 2, std::shared_ptr<const VertexMask> mask = nullptr)
      : mesh(row_of_balls(balls)), shape(mesh.vertices, options()),
        parts(std::make_shared<const ModelParts>(mesh, shape.layout())),
        mover(shape, parts, {hands, 0.3, std::move(mask)}), grips(hands) {
    REQUIRE(mover.begin(grips) == FieldStatus::ok);
  }
  static DeformerOptions options() {
    DeformerOptions options;
    options.undo_bytes = std::size_t{1} << 24;
    return options;
  }
  /// Puts a hand at the surface of a ball, and closes it.
  void take(std::size_t hand, int ball, const Vector3d& direction = Vector3d::UnitY()) {
    grips[hand].frame.translation() = Vector3d(far_apart * ball, 0.0, 0.0) + 1.1 * direction;
    move();
    grips[hand].is_closed = true;
    move();
  }
  void move() { REQUIRE(mover.move_to(grips) == FieldStatus::ok); }
  Points vertices() const {
    Points now;
    shape.layout().unpack(shape.shape(), now);
    return now;
  }
  /// The farthest that a ball's vertices are from where the motion takes them.
  double off(int ball, const Isometry3d& motion) const {
    const Points now = vertices();
    double worst = 0.0;
    for (Eigen::Index at = ball; at < now.cols(); at += balls)
      worst = std::max(worst, (now.col(at) - motion * mesh.vertices.col(at)).norm());
    return worst;
  }
  bool is_untouched(int ball) const {
    const Points now = vertices();
    for (Eigen::Index at = ball; at < now.cols(); at += balls)
      if (now.col(at) != mesh.vertices.col(at)) return false;
    return true;
  }

  Mesh mesh;
  SculptedShape shape;
  std::shared_ptr<const ModelParts> parts;
  PartMover mover;
  std::vector<PartGrip> grips;
};

constexpr double rounding = 2e-6; // of floats, at the size of the row

} // namespace

TEST_SUITE("part_mover") {
  TEST_CASE("parts are what edges hold together, and every vertex with a face is in one") {
    Mesh mesh = row_of_balls(4);
    const Eigen::Index count = mesh.vertices.cols();
    mesh.vertices.conservativeResize(3, count + 1);
    mesh.vertices.col(count) << 1.0, 2.0, 3.0; // in no face
    const BlockLayout layout(mesh.vertices);
    const ModelParts parts(mesh, layout);
    REQUIRE(parts.count() == 4);
    for (std::size_t place = 0; place < layout.vertex_count(); ++place) {
      const std::uint32_t vertex = layout.order()[place];
      CHECK(parts.at_place(place) == (vertex == count ? no_index : vertex % 4));
    }
    std::size_t lanes = 0;
    for (std::uint32_t part = 0; part < 4; ++part)
      for (const ModelParts::Block& block : parts.blocks_of(part))
        for (std::size_t lane = 0; lane < block_size; ++lane) {
          if ((block.lanes >> lane & 1U) == 0) continue;
          CHECK(parts.at_place(block.number * block_size + lane) == part);
          ++lanes;
        }
    CHECK(lanes == static_cast<std::size_t>(count));
  }

  TEST_CASE(
      "a part goes with the hand that holds it, by any way, and the others stay bit for bit") {
    std::mt19937 random(1);
    for (int run = 0; run < 20; ++run) {
      Bench bench;
      bench.take(0, 1);
      REQUIRE(bench.mover.held_by(0) == 1);
      const Isometry3d taken = bench.grips[0].frame;
      Isometry3d motion;
      for (int step = 0; step < 30; ++step) {
        motion = any_motion(random, 2.0);
        bench.grips[0].frame = motion * taken;
        bench.move();
      }
      CHECK(bench.off(1, motion) < rounding);
      CHECK(bench.is_untouched(0));
      CHECK(bench.is_untouched(2));
      bench.grips[0].is_closed = false;
      bench.move();
      CHECK(bench.mover.held_by(0) == no_index);
      bench.grips[0].frame = any_motion(random, 2.0);
      bench.move();
      CHECK_FALSE(bench.mover.is_moved());
      CHECK(bench.off(1, motion) < rounding);
    }
  }

  TEST_CASE("an open hand has that part in reach which it takes when it closes") {
    Bench bench(1);
    const auto in_reach_at = [&](const Vector3d& place) {
      bench.grips[0].frame.translation() = place;
      bench.move();
      return bench.mover.in_reach_of(0);
    };
    const Vector3d middle(far_apart, 0.0, 0.0); // of the second ball
    CHECK(in_reach_at(middle + 1.1 * Vector3d::UnitY()) == 1);
    CHECK(in_reach_at(middle) == 1);
    CHECK(in_reach_at(middle + 1.1 * Vector3d::UnitX() + far_apart * Vector3d::UnitX()) == 2);
    CHECK(in_reach_at(middle + 1.5 * Vector3d::UnitY()) == no_index); // beyond 0.3
    for (const Vector3d& place : {Vector3d(middle + 1.2 * Vector3d::UnitY()),
                                  Vector3d(middle + 3.0 * Vector3d::UnitY()), middle}) {
      const std::uint32_t expected = in_reach_at(place);
      bench.grips[0].is_closed = true;
      bench.move();
      CHECK(bench.mover.held_by(0) == expected);
      bench.move();
      CHECK(bench.mover.in_reach_of(0) == no_index); // a closed hand takes nothing more
      bench.grips[0].is_closed = false;
      bench.move();
    }
  }

  TEST_CASE("two hands carry two parts, each its own") {
    std::mt19937 random(2);
    Bench bench;
    bench.take(0, 0);
    bench.take(1, 2);
    const Isometry3d one = any_motion(random, 1.0), other = any_motion(random, 1.0);
    bench.grips[0].frame = one * bench.grips[0].frame;
    bench.grips[1].frame = other * bench.grips[1].frame;
    bench.move();
    CHECK(bench.off(0, one) < rounding);
    CHECK(bench.off(2, other) < rounding);
    CHECK(bench.is_untouched(1));
  }

  TEST_CASE("what two hands hold goes with both: with their common motion, and with their line") {
    std::mt19937 random(3);
    Bench bench;
    bench.take(0, 1, Vector3d::UnitY());
    bench.take(1, 1, -Vector3d::UnitY());
    REQUIRE(bench.mover.held_by(0) == 1);
    REQUIRE(bench.mover.held_by(1) == 1);
    const auto taken = bench.grips;
    for (int run = 0; run < 50; ++run) {
      const Isometry3d motion = any_motion(random, 1.0);
      for (std::size_t hand = 0; hand < 2; ++hand)
        bench.grips[hand].frame = motion * taken[hand].frame;
      bench.move();
      CHECK(bench.off(1, motion) < 3.0 * rounding);
    }
    // Like a wheel: the hands go round, and do not turn.
    const Vector3d middle(far_apart, 0.0, 0.0);
    const Isometry3d quarter = Eigen::Translation3d(middle) *
                               AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitZ()) *
                               Eigen::Translation3d(-middle);
    for (std::size_t hand = 0; hand < 2; ++hand)
      bench.grips[hand].frame.matrix() =
          (Eigen::Translation3d(quarter * taken[hand].frame.translation()) *
           Isometry3d(taken[hand].frame.linear()))
              .matrix();
    bench.move();
    CHECK(bench.off(1, quarter) < rounding);
    // About the line between them, by the mean of their turns.
    bench.grips = taken;
    bench.grips[0].frame.rotate(AngleAxisd(0.4, Vector3d::UnitY()));
    bench.grips[1].frame.rotate(AngleAxisd(0.2, Vector3d::UnitY()));
    bench.move();
    const Isometry3d mean = Eigen::Translation3d(middle) * AngleAxisd(0.3, Vector3d::UnitY()) *
                            Eigen::Translation3d(-middle);
    CHECK(bench.off(1, mean) < rounding);
    // When one releases, nothing jumps, and the other carries on.
    bench.grips[0].is_closed = false;
    bench.move();
    CHECK(bench.off(1, mean) < rounding);
    const Isometry3d more = any_motion(random, 1.0);
    bench.grips[1].frame = more * bench.grips[1].frame;
    bench.move();
    CHECK(bench.off(1, more * mean) < 2.0 * rounding);
  }

  TEST_CASE("a hand takes what is under it, and nothing that is out of its reach") {
    Bench bench;
    bench.grips[0].frame.translation() << 0.0, 1.5, 0.0; // beyond reach, outside of its box
    bench.grips[0].is_closed = true;
    bench.move();
    CHECK(bench.mover.held_by(0) == no_index);
    bench.grips[0].frame.translation() << 0.0, 0.2, 0.0; // a closed hand that comes takes nothing
    bench.move();
    CHECK(bench.mover.held_by(0) == no_index);
    bench.grips[0].is_closed = false;
    bench.move();
    bench.grips[0].is_closed = true; // inside of it
    bench.move();
    CHECK(bench.mover.held_by(0) == 0);
    for (int ball = 0; ball < Bench::balls; ++ball)
      CHECK(bench.is_untouched(ball));
  }

  TEST_CASE("each stroke is undone and done again to the same bits, and what is held is held on") {
    std::mt19937 random(5);
    Bench bench;
    const Points first = bench.vertices();
    bench.take(0, 1);
    bench.grips[0].frame = any_motion(random, 1.0) * bench.grips[0].frame;
    bench.move();
    const Points second = bench.vertices();
    REQUIRE(bench.mover.begin(bench.grips) == FieldStatus::ok);
    CHECK(bench.shape.undo_steps() == 1);
    const Isometry3d more = any_motion(random, 1.0);
    bench.grips[0].frame = more * bench.grips[0].frame;
    bench.move();
    const Points third = bench.vertices();
    REQUIRE(bench.mover.go(HistoryMove::undo, bench.grips) == FieldStatus::ok);
    CHECK(bench.vertices() == second);
    REQUIRE(bench.mover.go(HistoryMove::undo, bench.grips) == FieldStatus::ok);
    CHECK(bench.vertices() == first);
    REQUIRE(bench.mover.go(HistoryMove::redo, bench.grips) == FieldStatus::ok);
    REQUIRE(bench.mover.go(HistoryMove::redo, bench.grips) == FieldStatus::ok);
    CHECK(bench.vertices() == third);
    bench.move();
    CHECK_FALSE(bench.mover.is_moved());
    bench.grips[0].frame.translation().z() += 0.5;
    bench.move();
    CHECK((bench.vertices() - third).cwiseAbs().maxCoeff() == doctest::Approx(0.5).epsilon(1e-5));
    REQUIRE(bench.mover.go(HistoryMove::reset, bench.grips) == FieldStatus::ok);
    CHECK(bench.vertices() == first);
  }

  TEST_CASE("a part that a mask holds stays where it is") {
    const Mesh mesh = row_of_balls(Bench::balls);
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(mesh.vertices.cols());
    weights[1] = 0.0; // of the second ball
    Bench bench(2, std::make_shared<const VertexMask>(BlockLayout(mesh.vertices), weights));
    bench.take(0, 1);
    CHECK(bench.mover.held_by(0) == no_index);
    bench.take(1, 2);
    CHECK(bench.mover.held_by(1) == 2);
  }

  TEST_CASE("numbers that are none, or too large, change nothing") {
    Bench bench;
    bench.take(0, 1);
    const Points before = bench.vertices();
    for (const double wrong : {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(), 1e30}) {
      auto grips = bench.grips;
      grips[1].frame.translation().y() = wrong;
      CHECK(bench.mover.move_to(grips) == FieldStatus::not_finite);
      CHECK(bench.mover.begin(grips) == FieldStatus::not_finite);
      CHECK(bench.mover.go(HistoryMove::undo, grips) == FieldStatus::not_finite);
      CHECK(bench.mover.go(HistoryMove::reset, grips) == FieldStatus::not_finite);
      CHECK(bench.vertices() == before);
    }
    CHECK(bench.mover.move_to({}) == FieldStatus::not_finite); // not one a hand
  }
}

} // namespace part_mover_test
