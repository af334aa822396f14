#include <nendo/deform/normals.hpp>

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <nendo/deform/simd.hpp>
#include <nendo/deform/type1.hpp>
#include <nendo/deform/type2.hpp>

#include "support/fields.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace normals_test {

using namespace nendo::deform;
using nendo::test::largest;
using nendo::test::random_points;

TEST_SUITE("normals") {
  const Mesh ball = nendo::test::sphere(20, 30, 5.0);
  const Points outward = ball.vertices.colwise().normalized();

  /// Random functions, which fold nothing.
  static CsrbfField gentle_field(unsigned seed, Wendland kernel = Wendland::c2,
                                 Eigen::Index count = 10) {
    std::mt19937 random(seed);
    CsrbfField field;
    field.kernel = kernel;
    field.centres = random_points(random, count, 5.0);
    field.coefficients = random_points(random, count, 0.25);
    field.radii = Eigen::VectorXd::LinSpaced(count, 3.0, 5.0);
    return field;
  }

  static Eigen::Vector3d image_of(const CsrbfField& field, const Eigen::Vector3d& x) {
    return x + field.displacement_at(x);
  }

  /// Central differences along two tangents.
  static Points by_differences(const CsrbfField& field, const Points& points,
                               const Points& normals) {
    constexpr double step = 1e-5;
    Points turned = normals;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Eigen::Vector3d u = step * normals.col(i).unitOrthogonal();
      const Eigen::Vector3d v = normals.col(i).cross(u);
      const Eigen::Vector3d x = points.col(i);
      const Eigen::Vector3d along_u = image_of(field, x + u) - image_of(field, x - u);
      const Eigen::Vector3d along_v = image_of(field, x + v) - image_of(field, x - v);
      turned.col(i) = along_u.cross(along_v).normalized();
    }
    return turned;
  }

  static Points turned(const CsrbfField& field, const Points& points, Points normals) {
    turn_normals(field, points, normals);
    return normals;
  }

  static Points unpacked(const BlockLayout& layout, const BlockShape& normals) {
    Points out;
    layout.unpack_vectors(normals, out);
    return out;
  }

  TEST_CASE("a turned normal is that of the surface's differences") {
    for (const auto kernel : {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6}) {
      CsrbfField field = gentle_field(71, kernel);
      field.polynomial << 0.5, 0.1, -0.2, 0.05, -1.0, 0.0, 0.1, 0.2, 0.3, -0.1, 0.2, 0.0;
      const Points exact = by_differences(field, ball.vertices, outward);
      CHECK(largest(turned(field, ball.vertices, outward) - exact) < 1e-6);
      CHECK(largest(exact - outward) > 0.2);
    }
  }

  TEST_CASE("the finer a mesh, the nearer its faces' normals come") {
    const CsrbfField field = gentle_field(72);
    const auto apart = [&](std::uint32_t rings) {
      Mesh mesh = nendo::test::sphere(rings, 2 * rings, 5.0);
      const Points normals =
          turned(field, mesh.vertices, mesh.vertices.colwise().normalized().eval());
      displace(field, Points(mesh.vertices), mesh.vertices);
      // The poles' fans are as coarse as ever.
      return largest((normals - vertex_normals(mesh)).rightCols(mesh.vertices.cols() - 2));
    };
    const double coarse = apart(40);
    const double fine = apart(160);
    CHECK(coarse < 0.05);
    CHECK(fine < coarse / 3.0);
  }

  TEST_CASE("a mirror turns normals as it turns faces over") {
    CsrbfField field = gentle_field(73);
    field.coefficients.setZero();
    field.polynomial(0, 1) = -2.0; // x becomes -x
    Mesh mirrored = ball;
    displace(field, ball.vertices, mirrored.vertices);
    const Points normals = turned(field, ball.vertices, outward);
    const Points faces = vertex_normals(mirrored);
    CHECK((normals.cwiseProduct(faces).colwise().sum().array() > 0.9).all());
  }

  TEST_CASE("in blocks, by every instruction set, normals are what double makes") {
    const BlockLayout layout(ball.vertices);
    const BoundedShape rest(layout.pack());
    const BlockShape before = layout.pack_vectors(outward);
    for (const auto name : simd_names()) {
      REQUIRE(use_simd(name));
      CAPTURE(name);
      for (const auto kernel : {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6})
        for (const double tilt : {0.0, 0.2}) {
          CsrbfField field = gentle_field(74, kernel);
          field.polynomial(2, 1) = tilt;
          BlockEvaluator evaluator(layout, 10, {});
          REQUIRE(evaluator.set_field(field));
          BlockShape after;
          evaluator.turn(rest, before, after);
          CHECK(largest(unpacked(layout, after) - turned(field, ball.vertices, outward)) < 1e-5);
        }
    }
    use_simd("");
  }

  // Fewer than three have a way of their own (few_centres-inl.hpp).
  TEST_CASE("one, two and three supports, by every instruction set, turn as double makes them") {
    const BlockLayout layout(ball.vertices);
    const BlockShape before = layout.pack_vectors(outward);
    for (const auto name : simd_names()) {
      REQUIRE(use_simd(name));
      CAPTURE(name);
      for (const auto kernel : {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6})
        for (const Eigen::Index count : {1, 2, 3}) {
          CsrbfField field = gentle_field(83, kernel, count);
          field.radii.setConstant(20.0); // each reaches all blocks
          field.coefficients *= 4.0;
          BlockEvaluator evaluator(layout, count, {});
          REQUIRE(evaluator.set_field(field));
          BoundedShape moved(layout.pack());
          BlockShape after = before;
          REQUIRE(evaluator.displace(moved, &after));
          const Points exact = turned(field, ball.vertices, outward);
          CHECK(largest(exact - outward) > 0.05);
          CHECK(largest(unpacked(layout, after) - exact) < 1e-5);
          Points places;
          Points reference;
          layout.unpack(moved.shape, places);
          displace(field, ball.vertices, reference);
          CHECK(largest(places - reference) < 1e-5 * layout.diagonal());
        }
    }
    use_simd("");
  }

  TEST_CASE(
      "radii whose powers float does not hold give what double makes, and normals of any length") {
    const BlockLayout layout(ball.vertices);
    const BlockShape before = layout.pack_vectors(100.0 * outward);
    for (const double radius : {1e-12, 1e3, 1e8, 1e12}) {
      CAPTURE(radius);
      CsrbfField field = gentle_field(81);
      field.radii.setConstant(radius);
      field.polynomial(2, 1) = 0.2;
      BlockEvaluator evaluator(layout, 10, {});
      REQUIRE(evaluator.set_field(field));
      BoundedShape moved(layout.pack());
      BlockShape after = before;
      REQUIRE(evaluator.displace(moved, &after));
      Points places;
      Points reference;
      layout.unpack(moved.shape, places);
      displace(field, ball.vertices, reference);
      CHECK(largest(places - reference) < 1e-5 * layout.diagonal());
      CHECK(largest(unpacked(layout, after) - turned(field, ball.vertices, outward)) < 1e-5);
    }
  }

  TEST_CASE("normals of large coefficients that cancel are what double makes") {
    Points starts(3, 2);
    starts << 5, 5.02, 0, 0, 0, 0;
    Points moves = Points::Zero(3, 2);
    moves(1, 1) = 0.1;
    const CsrbfField field = nendo::test::fitted({}, starts, 4.0, moves);
    REQUIRE(field.coefficients.cwiseAbs().maxCoeff() > 100.0);
    const BlockLayout layout(ball.vertices);
    BlockEvaluator evaluator(layout, 2, {});
    REQUIRE(evaluator.set_field(field));
    BlockShape after;
    evaluator.turn(BoundedShape(layout.pack()), layout.pack_vectors(outward), after);
    CHECK(largest(unpacked(layout, after) - turned(field, ball.vertices, outward)) < 1e-4);
  }

  TEST_CASE("a shape moves by the same bits with normals as without") {
    const BlockLayout layout(ball.vertices);
    for (const auto name : simd_names()) {
      REQUIRE(use_simd(name));
      CAPTURE(name);
      BoundedShape alone(layout.pack());
      BoundedShape with(layout.pack());
      BlockShape normals = layout.pack_vectors(outward);
      BlockEvaluator evaluator(layout, 10, {});
      for (const unsigned seed : {75U, 76U}) {
        REQUIRE(evaluator.set_field(gentle_field(seed)));
        REQUIRE(evaluator.displace(alone));
        REQUIRE(evaluator.displace(with, &normals));
      }
      bool same = true;
      for (std::size_t block = 0; block < layout.block_count(); ++block)
        same = same && alone.shape[block].x == with.shape[block].x &&
               alone.shape[block].y == with.shape[block].y &&
               alone.shape[block].z == with.shape[block].z &&
               alone.bounds[block].sides == with.bounds[block].sides;
      CHECK(same);
    }
    use_simd("");
  }

  TEST_CASE("what no support reaches keeps its normals, untouched, and its stamp") {
    const BlockLayout layout(ball.vertices);
    const BoundedShape rest(layout.pack());
    const BlockShape before = layout.pack_vectors(outward);
    CsrbfField field = gentle_field(77);
    field.centres.colwise() = Eigen::Vector3d(0.0, 0.0, 5.0);
    field.radii.setConstant(2.0);
    BlockShape after = before;
    for (std::size_t block = 0; block < after.block_count(); ++block)
      after.data()[block].x.fill(77.0F); // unstamped: so it shows what is written
    BlockEvaluator evaluator(layout, 10, {});
    REQUIRE(evaluator.set_field(field));
    evaluator.turn(rest, before, after);
    std::size_t kept = 0;
    for (std::size_t block = 0; block < after.block_count(); ++block)
      if (after.stamp(block) == before.stamp(block)) {
        CHECK(after[block].x[5] == 77.0F);
        ++kept;
      } else {
        CHECK(after[block].x[5] != 77.0F);
      }
    CHECK(kept > 0);
    CHECK(kept < after.block_count());
  }

  TEST_CASE("vertices without a normal, and surfaces that are crushed, keep what they had") {
    Points normals = outward;
    normals.col(3).setZero();
    CsrbfField field = gentle_field(78);
    CHECK(turned(field, ball.vertices, normals).col(3).isZero(0.0));
    const BlockLayout layout(ball.vertices);
    const BoundedShape rest(layout.pack());
    BlockEvaluator evaluator(layout, 10, {});
    BlockShape after;
    REQUIRE(evaluator.set_field(field));
    evaluator.turn(rest, layout.pack_vectors(normals), after);
    CHECK(unpacked(layout, after).col(3).isZero(0.0));
    field.coefficients.setZero();
    field.polynomial.rightCols<3>() = -Eigen::Matrix3d::Identity(); // all go to one place
    CHECK(turned(field, ball.vertices, outward) == outward);
    REQUIRE(evaluator.set_field(field));
    evaluator.turn(rest, layout.pack_vectors(outward), after);
    CHECK(largest(unpacked(layout, after) - outward) < 1e-6);
    field.polynomial.rightCols<3>().setConstant(1e30); // squares of it overflow
    REQUIRE(evaluator.set_field(field));
    evaluator.turn(rest, layout.pack_vectors(outward), after);
    CHECK(unpacked(layout, after).allFinite());
  }

  TEST_CASE("two threads turn to the same bits as one, and neither allocates") {
    std::mt19937 random(79);
    const Points points = random_points(random, 12'000, 5.0);
    const Points normals = random_points(random, 12'000, 1.0).colwise().normalized();
    const BlockLayout layout(points);
    const BoundedShape rest(layout.pack());
    const BlockShape before = layout.pack_vectors(normals);
    Points results[2];
    for (const int threads : {1, 2}) {
      BlockEvaluator evaluator(layout, 10, {.threads = threads});
      REQUIRE(evaluator.set_field(gentle_field(80)));
      BlockShape after = before;
      BoundedShape moving = rest;
      nendo::test::RestraintCounts counts;
      {
        const nendo::test::Restraint restraint;
        evaluator.turn(rest, before, after);
        evaluator.displace(moving, &after);
        counts = restraint.counts();
      }
      CHECK(counts.allocations + counts.locks == 0);
      results[threads - 1] = unpacked(layout, after);
    }
    const bool same = results[0] == results[1];
    CHECK(same);
  }

  static Points starts_on_the_ball() {
    Points starts(3, 3);
    starts << 5, 0, 0, 0, 5, 0, 0, 0, 5;
    return starts;
  }

  TEST_CASE("Type-1's normals are those of its field, also without weights and after a commit") {
    Points ends = starts_on_the_ball();
    ends(0, 0) = 5.8;
    ends(2, 1) = 0.7;
    for (const std::size_t room : {std::size_t{4} << 20, std::size_t{0}}) {
      Type1Deformer deformer(ball.vertices, 3, 4.0, {}, {.weight_bytes = room});
      deformer.carry_normals(outward);
      BlockShape shape;
      BlockShape normals;
      REQUIRE(deformer.grab(starts_on_the_ball()) == FieldStatus::ok);
      REQUIRE(deformer.apply(ends, shape) == FieldStatus::ok);
      deformer.normals(normals);
      const CsrbfField first = deformer.fields().fields().front();
      const Points once = turned(first, ball.vertices, outward);
      CHECK(largest(once - outward) > 0.1);
      CHECK(largest(unpacked(deformer.layout(), normals) - once) < 1e-5);
      REQUIRE(deformer.commit(ends) == FieldStatus::ok);
      Points committed;
      displace(first, ball.vertices, committed);
      Points farther = ends;
      farther(1, 2) = 0.9;
      REQUIRE(deformer.apply(farther, shape) == FieldStatus::ok);
      deformer.normals(normals);
      const Points twice = turned(deformer.fields().fields().front(), committed, once);
      CHECK(largest(unpacked(deformer.layout(), normals) - twice) < 1e-4);
    }
  }

  TEST_CASE("Type-1's normals follow every link of an injective way") {
    Points ends = starts_on_the_ball();
    ends(0, 0) = 8.5; // too far for one link
    DeformerOptions options{one_radius(4.0), {}, {}, InjectiveOptions{}};
    Type1Deformer deformer(ball.vertices, 3, options);
    deformer.carry_normals(outward);
    BlockShape shape;
    BlockShape normals;
    REQUIRE(is_solved(deformer.grab(starts_on_the_ball())));
    REQUIRE(is_solved(deformer.apply(ends, shape)));
    REQUIRE(deformer.report().links > 1);
    deformer.normals(normals);
    const Mesh fine = nendo::test::sphere(120, 240, 5.0);
    Type1Deformer reference(fine.vertices, 3, options);
    REQUIRE(is_solved(reference.grab(starts_on_the_ball())));
    REQUIRE(is_solved(reference.apply(ends, shape)));
    Mesh moved = fine;
    reference.layout().unpack(shape, moved.vertices);
    const Points faces = vertex_normals(moved);
    const Points ours = unpacked(deformer.layout(), normals);
    for (Eigen::Index i = 2; i < ours.cols(); ++i) {
      Eigen::Index nearest = 0;
      (fine.vertices.colwise() - ball.vertices.col(i)).colwise().squaredNorm().minCoeff(&nearest);
      CHECK(ours.col(i).dot(faces.col(nearest)) > 0.97);
    }
  }

  TEST_CASE("Type-2's normals turn with each piece") {
    Type2Deformer deformer(ball.vertices, 3, 4.0, 0.2, {});
    deformer.carry_normals(outward);
    Points tips = starts_on_the_ball();
    REQUIRE(deformer.begin(tips) == FieldStatus::ok);
    Points shape = ball.vertices;
    Points normals = outward;
    for (int piece = 0; piece < 8; ++piece) {
      tips(0, 0) += 0.1;
      tips(2, 0) += 0.1;
      REQUIRE(deformer.end_at(tips).pieces == 1);
      const CsrbfField& field = deformer.fields().fields().front();
      normals = turned(field, shape, normals);
      displace(field, Points(shape), shape);
    }
    CHECK(largest(normals - outward) > 0.2);
    CHECK(largest(unpacked(deformer.layout(), deformer.normals()) - normals) < 1e-4);
  }
}

} // namespace normals_test
