// Laws of masks: what is held stays bit for bit, what is free moves as without a mask, and what is
// between moves by its weight, in both types, with every brush, in links, and after each step.

#include <nendo/deform/vertex_mask.hpp>

#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/type1.hpp>
#include <nendo/deform/type2.hpp>

#include "reference/icosphere.hpp"
#include "support/fields.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace vertex_mask_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using nendo::test::largest;

static const Mesh ball = nendo::test::sphere(40, 60, 5.0);

/// Held where z < -1, free where z > 1, in between halfway and more.
static Eigen::VectorXd weights_of(const Points& vertices) {
  return (0.5 + 0.5 * vertices.row(2).array()).cwiseMax(0.0).cwiseMin(1.0).transpose();
}

static Points unpacked(const BlockLayout& layout, const BlockShape& shape) {
  Points points;
  layout.unpack(shape, points);
  return points;
}

static DeformerOptions options_with(const std::shared_ptr<const VertexMask>& mask) {
  DeformerOptions options;
  options.supports = one_radius(4.0);
  options.undo_bytes = std::size_t{1} << 22;
  options.mask = mask;
  return options;
}

/// Of ten fingertips all round the ball.
static Points start_points() {
  Points starts(3, 10);
  for (Eigen::Index at = 0; at < 10; ++at)
    starts.col(at) = ball.vertices.col(7 + 211 * at);
  return starts;
}
static Points random_way(unsigned seed, double length) {
  std::mt19937 random(seed);
  return nendo::test::random_points(random, 10, length);
}

/// Of the way that is made without a mask, the weights leave their part.
static void check_held(const Points& from, const Points& whole, const Points& held, double within) {
  const Eigen::VectorXd weights = weights_of(ball.vertices);
  int still = 0, free = 0, between = 0;
  for (Eigen::Index v = 0; v < from.cols(); ++v) {
    const Vector3d way = whole.col(v) - from.col(v);
    if (weights[v] == 0.0) {
      still += std::memcmp(held.col(v).data(), from.col(v).data(), sizeof(Vector3d)) == 0 ? 0 : 1;
    } else if (weights[v] == 1.0) {
      free += held.col(v) == whole.col(v) ? 0 : 1;
    } else {
      between += (held.col(v) - from.col(v) - weights[v] * way).norm() <= within ? 0 : 1;
    }
  }
  CHECK(still == 0);
  CHECK(free == 0);
  CHECK(between == 0);
}

TEST_SUITE("vertex mask") {
  TEST_CASE("a mask has parts only where something is held") {
    const BlockLayout layout(ball.vertices);
    const Eigen::VectorXd weights = weights_of(ball.vertices);
    const VertexMask mask(layout, weights);
    std::size_t parts = 0;
    for (std::size_t block = 0; block < layout.block_count(); ++block) {
      const float* const held = mask.of_block(block);
      parts += held != nullptr ? 1 : 0;
      for (std::size_t lane = 0; lane < block_size; ++lane) {
        const std::size_t place = block * block_size + lane;
        if (place >= layout.vertex_count()) continue;
        CHECK((held == nullptr ? 1.0F : held[lane]) ==
              static_cast<float>(weights[layout.order()[place]]));
      }
    }
    CHECK(parts == mask.parts().size());
    CHECK(parts > 3);
    CHECK(parts < layout.block_count());
    CHECK(VertexMask(layout, Eigen::VectorXd::Ones(ball.vertices.cols())).parts().empty());
  }

  TEST_CASE("in type 1 the weights leave their part, with weights and without, and it is linear") {
    const BlockLayout layout(ball.vertices);
    const auto mask = std::make_shared<VertexMask>(layout, weights_of(ball.vertices));
    for (const std::size_t bytes : {std::size_t{4} << 20, std::size_t{0}}) {
      CAPTURE(bytes);
      DeformerOptions with = options_with(mask), without = options_with(nullptr);
      with.evaluation.weight_bytes = without.evaluation.weight_bytes = bytes;
      Type1Deformer held(ball.vertices, 10, with), plain(ball.vertices, 10, without);
      CHECK(held.is_masked());
      CHECK_FALSE(plain.is_masked());
      const Points starts = start_points();
      REQUIRE(is_solved(held.grab(starts)));
      REQUIRE(is_solved(plain.grab(starts)));
      BlockShape shape, whole;
      const Points way = random_way(1, 0.5);
      for (const double part : {0.5, 1.0}) {
        held.apply(starts + part * way, shape);
        plain.apply(starts + part * way, whole);
        check_held(ball.vertices, unpacked(layout, whole), unpacked(layout, shape), 2e-6);
      }
      const Points moved = unpacked(layout, shape) - ball.vertices;
      held.apply(starts + 2.0 * way, shape);
      CHECK(largest(unpacked(layout, shape) - ball.vertices - 2.0 * moved) < 1e-5);
      // What is drawn is what is committed, and undo and redo find it again.
      const BlockShape drawn = shape;
      REQUIRE(is_solved(held.commit(starts + 2.0 * way)));
      CHECK(unpacked(layout, held.rest()) == unpacked(layout, drawn));
      REQUIRE(is_solved(held.go(HistoryMove::undo, starts)));
      CHECK(unpacked(layout, held.rest()) == ball.vertices);
      REQUIRE(is_solved(held.go(HistoryMove::redo, starts)));
      CHECK(unpacked(layout, held.rest()) == unpacked(layout, drawn));
    }
  }

  TEST_CASE("what is held stays in links and when the stroke ends") {
    const BlockLayout layout(ball.vertices);
    DeformerOptions with =
        options_with(std::make_shared<VertexMask>(layout, weights_of(ball.vertices)));
    with.injective.emplace();
    DeformerOptions without = with;
    without.mask = nullptr;
    Type1Deformer held(ball.vertices, 10, with), plain(ball.vertices, 10, without);
    const Points starts = start_points(), ends = starts + random_way(2, 3.0);
    REQUIRE(is_solved(held.grab(starts)));
    REQUIRE(is_solved(plain.grab(starts)));
    BlockShape shape, whole;
    held.apply(ends, shape);
    plain.apply(ends, whole);
    CHECK(held.report().links > 1);
    // Free vertices have met the same links; between, a link finds others where they were held.
    check_held(ball.vertices, unpacked(layout, whole), unpacked(layout, shape), 10.0);
    held.release(true);
    CHECK(unpacked(layout, held.rest()) == unpacked(layout, shape));
  }

  TEST_CASE("in type 2, and with every brush, what is held stays bit for bit") {
    const BlockLayout layout(ball.vertices);
    const auto mask = std::make_shared<VertexMask>(layout, weights_of(ball.vertices));
    const auto all_free =
        std::make_shared<VertexMask>(layout, Eigen::VectorXd::Ones(ball.vertices.cols()));
    const auto rings = std::make_shared<VertexRings>(ball, layout);
    for (std::uint8_t number = 0; number < brush_count; ++number) {
      const auto brush = static_cast<Brush>(number);
      CAPTURE(name_of(brush));
      const auto shaped = [&](const std::shared_ptr<const VertexMask>& by) {
        DeformerOptions options = options_with(by);
        options.brushes.of_points.assign(10, brush);
        options.brushes.rings = rings;
        Type2Deformer deformer(ball.vertices, 10, 0.2, options);
        const Points starts = start_points(), way = random_way(3, 1.0);
        std::vector<Points> samples;
        for (int k = 1; k <= 10; ++k)
          samples.emplace_back(starts + (k / 10.0) * way);
        deformer.begin(starts);
        {
          const nendo::test::Restraint restraint;
          for (const Points& tips : samples)
            deformer.stroke_to(tips);
          CHECK(restraint.counts().allocations == 0);
        }
        deformer.end_at(starts + way);
        return unpacked(layout, deformer.shape());
      };
      const Points held = shaped(mask), whole = shaped(nullptr);
      CHECK(shaped(all_free) == whole);
      const Eigen::VectorXd weights = weights_of(ball.vertices);
      int moved = 0, still = 0;
      for (Eigen::Index v = 0; v < held.cols(); ++v) {
        const bool same =
            std::memcmp(held.col(v).data(), ball.vertices.col(v).data(), sizeof(Vector3d)) == 0;
        if (weights[v] == 0.0) still += same ? 0 : 1;
        if (weights[v] > 0.0) moved += same ? 0 : 1;
      }
      CHECK(still == 0);
      CHECK((brush == Brush::none) == (moved == 0));
      if (brush != Brush::none) CHECK(largest(held - whole) > 1e-3);
    }
  }

  TEST_CASE("points that are mirrored leave a symmetric model symmetric, with every brush") {
    const Mesh round = nendo::reference::icosphere(4, 5.0); // whose triangles are symmetric, too
    const BlockLayout layout(round.vertices);
    const auto rings = std::make_shared<VertexRings>(round, layout);
    const auto flipped = [](const Points& points) {
      Points other = points;
      other.row(0) *= -1.0;
      return other;
    };
    std::vector<Eigen::Index> twins(static_cast<std::size_t>(round.vertices.cols()));
    for (std::size_t v = 0; v < twins.size(); ++v) {
      const Vector3d image = flipped(round.vertices.col(static_cast<Eigen::Index>(v)));
      const double least = (round.vertices.colwise() - image).colwise().norm().minCoeff(&twins[v]);
      REQUIRE(least < 1e-12);
    }
    for (std::uint8_t number = 0; number < brush_count; ++number) {
      const auto brush = static_cast<Brush>(number);
      CAPTURE(name_of(brush));
      DeformerOptions options = options_with(nullptr);
      options.supports = one_radius(2.5);
      options.csrbf.merge_fraction = 0.05;
      options.brushes.of_points.assign(10, brush);
      options.brushes.rings = rings;
      options.brushes.are_mirrored = true;
      Type2Deformer deformer(round.vertices, 10, 0.1, options);
      // Five of one hand, some so near to the plane that both sides overlap.
      Points hand(3, 5), way(3, 5);
      hand << 0.4, 1.0, 3.0, 0.0, 2.0, 4.9, 0, -4, 0, 0, 0.5, 4.8, 0, 5.0, -4.5;
      way << 0.5, -0.3, 0.4, 0.0, -0.5, 0.6, 0.2, -0.4, 0.5, 0.1, 0.2, 0.5, 0.3, 0.7, -0.4;
      Points starts(3, 10), ends(3, 10);
      starts << hand, flipped(hand);
      ends << hand + way, flipped(hand + way);
      deformer.begin(starts);
      for (int k = 1; k <= 10; ++k)
        deformer.stroke_to(starts + (k / 10.0) * (ends - starts));
      deformer.end_at(ends);
      const Points shape = unpacked(layout, deformer.shape());
      double gap = 0.0;
      for (Eigen::Index v = 0; v < shape.cols(); ++v)
        gap = std::max(
            gap, largest(flipped(shape.col(v)) - shape.col(twins[static_cast<std::size_t>(v)])));
      CHECK(gap < 1e-6 * layout.diagonal());
      const double least = brush == Brush::smooth ? 0.002 : 0.02; // a round ball is smooth
      if (brush != Brush::none) CHECK(largest(shape - round.vertices) > least);
    }
  }
}

} // namespace vertex_mask_test
