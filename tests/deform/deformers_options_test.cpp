// What Type-1 and Type-2 make of several radii and of injective links.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include <nendo/deform/type1.hpp>
#include <nendo/deform/type2.hpp>

#include "support/fields.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace deformers_options_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using nendo::test::largest;

TEST_SUITE("deformers") {
  constexpr double radius = 15.0;
  /// What float may be off on a plane of this size, over some links.
  constexpr double float_gap = 1e-5 * 50.0;

  static const Mesh& plane() {
    static const auto mesh = nendo::test::grid(50, 50.0);
    return mesh;
  }

  /// Ten fingertips on the plane, none nearer than 8 to another.
  static Points start_points() {
    Points starts(3, 10);
    for (Eigen::Index i = 0; i < 10; ++i)
      starts.col(i) << 9.0 + 8.0 * static_cast<double>(i % 5),
          16.0 + 18.0 * static_cast<double>(i / 5), 0.0;
    return starts;
  }

  /// Within the plane, so far that one field folds it.
  static Points far_ends() {
    Points ends = start_points();
    for (Eigen::Index i = 0; i < 10; ++i)
      ends.col(i) += Vector3d(6.0 * std::sin(static_cast<double>(i)),
                              14.0 * std::cos(2.0 * static_cast<double>(i)), 0.0);
    return ends;
  }

  static DeformerOptions injective(std::size_t weight_bytes = std::size_t{8} << 20) {
    return {one_radius(radius),
            {.merge_fraction = 0.05},
            {.weight_bytes = weight_bytes},
            InjectiveOptions{}};
  }

  static Points shape_of(const Type1Deformer& deformer, const BlockShape& shape) {
    Points points;
    deformer.layout().unpack(shape, points);
    return points;
  }

  static int turned_faces(const Points& vertices) {
    int count = 0;
    for (std::size_t at = 0; at < plane().face_corners.size(); at += 4) {
      const auto corner = [&](std::size_t k) -> Vector3d {
        return vertices.col(plane().face_corners[at + k]);
      };
      count += (corner(2) - corner(0)).cross(corner(3) - corner(1)).z() <= 0.0 ? 1 : 0;
    }
    return count;
  }

  /// The same in double, by the public parts.
  static Points in_double(const Points& starts, const Points& ends) {
    InjectiveChain chain(10, one_radius(radius), {.merge_fraction = 0.05}, {});
    REQUIRE(is_solved(chain.grab(starts)));
    Points shape = plane().vertices;
    for (chain.from_start(ends); chain.next();)
      displace(chain.field(), shape, shape);
    return shape;
  }

  TEST_CASE("Type-1 in links does not fold where one field does, with weights and without") {
    Type1Deformer folding(plane().vertices, 10, {one_radius(radius), {.merge_fraction = 0.05}});
    BlockShape shape;
    REQUIRE(is_solved(folding.grab(start_points())));
    folding.apply(far_ends(), shape);
    CHECK(turned_faces(shape_of(folding, shape)) > 20);
    CHECK(folding.report().links == 0);
    for (const std::size_t memory : {std::size_t{8} << 20, std::size_t{0}}) {
      Type1Deformer deformer(plane().vertices, 10, injective(memory));
      REQUIRE(is_solved(deformer.grab(start_points())));
      CHECK(is_solved(deformer.apply(far_ends(), shape)));
      const Points far = shape_of(deformer, shape);
      CHECK(turned_faces(far) == 0);
      CHECK((far - in_double(start_points(), far_ends())).cwiseAbs().maxCoeff() < float_gap);
      CHECK(deformer.report().links > 2);
      CHECK(deformer.report().bound <= 0.9 + 1e-12);
      CHECK(deformer.report().whole_bound > 0.9);
      CHECK(deformer.report().min_determinant > 0.0);
    }
  }

  TEST_CASE("Type-1 in links depends on the ends alone, and a short way is the plain field") {
    Type1Deformer plain(plane().vertices, 10, {one_radius(radius), {.merge_fraction = 0.05}});
    Type1Deformer deformer(plane().vertices, 10, injective());
    BlockShape expected, shape;
    REQUIRE(is_solved(plain.grab(start_points())));
    REQUIRE(is_solved(deformer.grab(start_points())));
    const Points near = start_points().colwise() + Vector3d(0.3, 0.2, 0.5);
    plain.apply(near, expected);
    deformer.apply(far_ends(), shape);
    CHECK(deformer.report().links > 2);
    deformer.apply(near, shape);
    CHECK(deformer.report().links == 1);
    CHECK((shape_of(deformer, shape) - shape_of(plain, expected)).cwiseAbs().maxCoeff() <
          float_gap);
    deformer.apply(start_points(), shape);
    CHECK(shape_of(deformer, shape) == plane().vertices);
  }

  TEST_CASE("a bad end leaves the last shape, of one link and of many, and a commit keeps it") {
    for (const double part : {0.02, 1.0}) {
      Type1Deformer deformer(plane().vertices, 10, injective());
      const Points ends = start_points() + part * (far_ends() - start_points());
      BlockShape good, shape;
      REQUIRE(is_solved(deformer.grab(start_points())));
      REQUIRE(is_solved(deformer.apply(ends, good)));
      for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
        Points spoilt = ends;
        spoilt(1, 3) = bad;
        CHECK(deformer.apply(spoilt, shape) == FieldStatus::not_finite);
        CHECK(shape_of(deformer, shape) == shape_of(deformer, good));
      }
      REQUIRE(is_solved(deformer.commit(ends)));
      CHECK(shape_of(deformer, deformer.rest()) == shape_of(deformer, good));
      CHECK(is_solved(deformer.apply(ends, shape)));
      CHECK(shape_of(deformer, shape) == shape_of(deformer, good));
    }
  }

  struct Stroke {
    Points shape;
    int links = 0;
    double reported = 1.0; ///< least determinant
    double found = 1.0;    ///< at the vertices
  };

  static Stroke violent_stroke(const DeformerOptions& options) {
    std::mt19937 random(91);
    std::uniform_real_distribution<double> anywhere(-5.0, 5.0);
    Type2Deformer deformer(plane().vertices, 10, 4.0, options);
    REQUIRE(deformer.begin(start_points()) == FieldStatus::ok);
    DeterminantProbe everywhere;
    everywhere.start(plane().vertices);
    Stroke stroke;
    for (int turn = 0; turn < 6; ++turn) {
      Points tips = start_points();
      for (double& coordinate : tips.topRows<2>().reshaped())
        coordinate += anywhere(random);
      CHECK(is_solved(deformer.end_at(tips).status));
      stroke.links += deformer.report().links;
      stroke.reported = std::min(stroke.reported, deformer.report().min_determinant);
      for (const CsrbfField& field : deformer.fields().fields())
        everywhere.advance(field);
    }
    deformer.layout().unpack(deformer.shape(), stroke.shape);
    stroke.found = everywhere.min_determinant();
    return stroke;
  }

  TEST_CASE("Type-2 in links does not fold under a violent stroke, and says what it took") {
    DeformerOptions options = injective();
    const Stroke on = violent_stroke(options);
    options.injective.reset();
    const Stroke off = violent_stroke(options);
    CHECK(off.shape.allFinite());
    CHECK(off.links == 0);
    CHECK(off.found < 0.0);
    CHECK(on.shape.allFinite());
    CHECK(on.links > 6);
    CHECK(on.found > 0.0);
    CHECK(on.reported > 0.0);
    // Nothing folds, but edges are chords: where the map is steep a face may still turn.
    CHECK(turned_faces(off.shape) > 20);
    CHECK(3 * turned_faces(on.shape) < turned_faces(off.shape));
  }

  TEST_CASE(
      "the fields that a call applied make the same of a copy, of either type, in links or not") {
    for (const bool links : {false, true}) {
      DeformerOptions options = injective();
      if (!links) options.injective.reset();
      const Points rest = plane().vertices;
      Type1Deformer type1(rest, 10, options);
      Type2Deformer type2(rest, 10, 0.5, options);
      Points copy1, copy2 = rest;
      BlockShape shape;
      REQUIRE(is_solved(type1.grab(start_points())));
      REQUIRE(is_solved(type2.begin(start_points())));
      CHECK(type1.fields().fields().empty());
      for (const double part : {0.01, 0.2, 0.25, 1.0}) {
        const Points tips = start_points() + part * (far_ends() - start_points());
        type1.apply(tips, shape);
        copy1 = rest;
        for (const CsrbfField& field : type1.fields().fields())
          displace(field, copy1, copy1);
        CHECK(largest(copy1 - shape_of(type1, shape)) < float_gap);
        CHECK((type1.fields().fields().size() > 1) == (links && part > 0.1));
        type2.stroke_to(tips);
        for (const CsrbfField& field : type2.fields().fields())
          displace(field, copy2, copy2);
        Points now;
        type2.layout().unpack(type2.shape(), now);
        CHECK(largest(copy2 - now) < float_gap);
      }
      CHECK(largest(copy2 - rest) > 1.0);
    }
  }

  TEST_CASE("each finger's own radius reaches its end point, in both types and in links") {
    std::vector<OwnSupport> own;
    for (Eigen::Index i = 0; i < 10; ++i)
      own.push_back({i, {6.0 + 2.0 * static_cast<double>(i % 5), 1.0}});
    for (const bool links : {false, true}) {
      DeformerOptions options{with_common(own), {}, {}, {}};
      if (links) options.injective.emplace();
      const Points ends = start_points().colwise() + Vector3d(0.5, -0.25, 1.0);
      Type1Deformer type1(plane().vertices, 10, options);
      Type2Deformer type2(plane().vertices, 10, 0.5, options);
      BlockShape shape;
      REQUIRE(is_solved(type1.grab(start_points())));
      REQUIRE(is_solved(type1.apply(ends, shape)));
      const Points first = shape_of(type1, shape);
      REQUIRE(is_solved(type2.begin(start_points())));
      type2.end_at(ends);
      Points second;
      type2.layout().unpack(type2.shape(), second);
      for (Eigen::Index i = 0; i < 10; ++i) {
        // The start points are vertices.
        const auto at = static_cast<Eigen::Index>(
            std::lround(51.0 * start_points()(1, i) + start_points()(0, i)));
        CHECK((first.col(at) - ends.col(i)).norm() < float_gap);
        CHECK((second.col(at) - ends.col(i)).norm() < float_gap);
      }
    }
  }

  TEST_CASE("neither links nor own radii allocate") {
    std::vector<OwnSupport> own;
    for (Eigen::Index i = 0; i < 10; ++i)
      own.push_back({i, {10.0 + static_cast<double>(i), 1.0}});
    DeformerOptions options = injective();
    options.undo_bytes = std::size_t{1} << 20;
    for (const Supports& supports : {one_radius(radius), with_common(own)}) {
      options.supports = supports;
      Type1Deformer type1(plane().vertices, 10, options);
      Type2Deformer type2(plane().vertices, 10, 5.0, options);
      const Points starts = start_points();
      const Points ends = far_ends();
      BlockShape out = type1.rest();
      nendo::test::RestraintCounts counts;
      {
        const nendo::test::Restraint restraint;
        type1.grab(starts);
        type1.apply(ends, out);
        type1.commit(ends);
        type1.apply(starts, out);
        type2.begin(starts);
        type2.stroke_to(ends);
        type2.end_at(starts);
        type2.go(HistoryMove::undo, ends);
        type1.go(HistoryMove::undo, ends);
        counts = restraint.counts();
      }
      CHECK(counts.allocations == 0);
      CHECK(counts.locks == 0);
    }
  }
}

} // namespace deformers_options_test
