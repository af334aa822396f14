#include <nendo/deform/type1.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/simd.hpp>

#include "reference/table1.hpp"
#include "support/dense_field.hpp"
#include "support/fields.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace type1_test {

using namespace nendo::deform;
using nendo::test::largest;
using nendo::test::random_points;

TEST_SUITE("type1") {
  const Points rest = nendo::test::sphere(20, 30, 5.0).vertices;

  /// Ten start points, the first of them on a vertex.
  static Points start_points() {
    std::mt19937 random(21);
    Points starts = random_points(random, 10, 5.0);
    starts.col(0) = rest.col(100);
    return starts;
  }

  static Points end_points(double length) {
    std::mt19937 random(22);
    return start_points() + random_points(random, 10, length);
  }

  static Points unpacked(const Type1Deformer& deformer, const BlockShape& shape) {
    Points out;
    deformer.layout().unpack(shape, out);
    return out;
  }

  /// Without weights, fields are evaluated instead: each law holds in both ways.
  constexpr std::initializer_list<std::size_t> weight_memories{std::size_t{64} << 20, 0};

  /// What shapes in float may be off in a model of this size: a few units of float's last place.
  constexpr double float_gap = 5e-6;

  static FieldStatus apply(Type1Deformer & deformer, const Points& ends, Points& out) {
    BlockShape shape;
    const FieldStatus status = deformer.apply(ends, shape);
    out = unpacked(deformer, shape);
    return status;
  }

  TEST_CASE("fingers that have not moved leave the rest shape bit for bit") {
    for (const auto polynomial : {Polynomial::none, Polynomial::constant, Polynomial::linear})
      for (const std::size_t memory : weight_memories) {
        Type1Deformer deformer(
            rest, 10, {one_radius(6.0), {.polynomial = polynomial}, {.weight_bytes = memory}});
        Points out;
        REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
        REQUIRE(apply(deformer, end_points(1.0), out) == FieldStatus::ok);
        CHECK(out != rest);
        REQUIRE(apply(deformer, start_points(), out) == FieldStatus::ok);
        CHECK(out == rest);
      }
  }

  TEST_CASE("a vertex at a start point goes to the end point, by whatever way") {
    Type1Deformer deformer(rest, 10, {one_radius(6.0)});
    Points straight;
    Points winding;
    REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
    apply(deformer, end_points(1.0), straight);
    CHECK((straight.col(100) - end_points(1.0).col(0)).norm() < float_gap);
    for (const double length : {9.0, 0.1, 3.0, 1.0})
      apply(deformer, end_points(length), winding);
    CHECK(winding == straight);
  }

  TEST_CASE("a commit makes the deformed shape the rest shape and the ends the starts") {
    Type1Deformer deformer(rest, 10, {one_radius(6.0)});
    Points before;
    Points after;
    REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
    apply(deformer, end_points(1.0), before);
    REQUIRE(deformer.commit(end_points(1.0)) == FieldStatus::ok);
    CHECK(unpacked(deformer, deformer.rest()) == before);
    REQUIRE(apply(deformer, end_points(1.0), after) == FieldStatus::ok);
    CHECK(after == before);
    REQUIRE(deformer.commit(end_points(1.0)) == FieldStatus::ok);
    CHECK(unpacked(deformer, deformer.rest()) == before);
  }

  TEST_CASE("before the first grab the rest shape is given, and said so") {
    Type1Deformer deformer(rest, 10, {one_radius(6.0)});
    Points out;
    CHECK(apply(deformer, end_points(1.0), out) == FieldStatus::singular);
    CHECK(out == rest);
  }

  TEST_CASE("a bad grab leaves the good one, bad ends the last good shape") {
    Type1Deformer deformer(rest, 10, {one_radius(6.0)});
    Points good;
    Points out;
    REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
    apply(deformer, end_points(1.0), good);
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
      Points spoilt = start_points();
      spoilt(1, 4) = bad;
      CHECK(deformer.grab(spoilt) == FieldStatus::not_finite);
      CHECK(deformer.commit(spoilt) == FieldStatus::not_finite);
      CHECK(apply(deformer, spoilt, out) == FieldStatus::not_finite);
      CHECK(out == good);
      CHECK(apply(deformer, end_points(1.0), out) == FieldStatus::ok);
      CHECK(out == good);
      CHECK(unpacked(deformer, deformer.rest()) == rest);
    }
  }

  TEST_CASE("a grab with two fingers in one place works and says so") {
    Points pinched = start_points();
    pinched.col(3) = pinched.col(8);
    Type1Deformer deformer(rest, 10, {one_radius(6.0)});
    Points out;
    CHECK(deformer.grab(pinched) == FieldStatus::merged);
    CHECK(apply(deformer, end_points(1.0), out) == FieldStatus::merged);
    CHECK(out.allFinite());
    CHECK(largest(out - rest) < 100.0);
  }

  TEST_CASE("every cell of the paper's table, by every instruction set, is what double makes") {
    const Points mesh = nendo::reference::table1_plane(64);
    for (const double radius : nendo::reference::table1_radii)
      for (const auto& starts :
           {nendo::reference::table1_starts(), nendo::reference::crowded_starts()})
        for (const std::size_t memory : weight_memories) {
          std::mt19937 random(23);
          const Points moves = nendo::reference::table1_displacements(random);
          CsrbfSolver solver({});
          CsrbfField field;
          REQUIRE(is_solved(solver.build(starts, Eigen::VectorXd::Constant(10, radius))));
          REQUIRE(is_solved(solver.solve(moves, field)));
          Points expected;
          displace(field, mesh, expected);
          for (const auto name : simd_names()) {
            REQUIRE(use_simd(name));
            CAPTURE(name);
            CAPTURE(radius);
            Type1Deformer deformer(mesh, 10, {one_radius(radius), {}, {.weight_bytes = memory}});
            REQUIRE(is_solved(deformer.grab(starts)));
            CHECK((deformer.weight_bytes() > 0) == (memory > 0));
            Points out;
            REQUIRE(is_solved(apply(deformer, starts + moves, out)));
            CHECK((out - expected).colwise().norm().maxCoeff() < 1e-5 * diagonal_of(mesh));
          }
        }
    use_simd("");
  }

  TEST_CASE("two threads make the same bits as one, frame after frame") {
    const Points starts = nendo::reference::table1_starts();
    for (const int cells : {88, 110}) { // 7921 vertices, too few for two with weights, and 12 321
      const Points mesh = nendo::reference::table1_plane(cells);
      for (const std::size_t memory : weight_memories) {
        CAPTURE(cells);
        CAPTURE(memory);
        Type1Deformer one(mesh, 10, {one_radius(20.0), {}, {.weight_bytes = memory}});
        Type1Deformer two(mesh, 10, {one_radius(20.0), {}, {.threads = 2, .weight_bytes = memory}});
        REQUIRE(is_solved(one.grab(starts)));
        REQUIRE(is_solved(two.grab(starts)));
        std::mt19937 random(24);
        BlockShape by_one;
        BlockShape by_two;
        for (int frame = 0; frame < 10; ++frame) {
          const Points ends = starts + nendo::reference::table1_displacements(random);
          REQUIRE(is_solved(one.apply(ends, by_one)));
          REQUIRE(is_solved(two.apply(ends, by_two)));
          const Points places = unpacked(one, by_one);
          CHECK(places != mesh);
          CHECK(unpacked(two, by_two) == places);
        }
      }
    }
  }

  TEST_CASE("weights for other kernels, for polynomials and for fingers that share a place") {
    Points starts = start_points();
    starts.col(3) = starts.col(8);
    const Points ends = starts + (end_points(1.0) - start_points());
    for (const auto kernel : {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6})
      for (const auto polynomial : {Polynomial::none, Polynomial::linear}) {
        const CsrbfOptions options{.kernel = kernel, .polynomial = polynomial};
        Type1Deformer deformer(rest, 10, {one_radius(3.0), options});
        REQUIRE(is_solved(deformer.grab(starts)));
        REQUIRE(deformer.weight_bytes() > 0);
        Points out;
        REQUIRE(is_solved(apply(deformer, ends, out)));
        Points expected;
        displace(deformer.fields().fields().front(), rest, expected);
        CHECK(largest(out - expected) < float_gap);
      }
  }

  /// W, a row per vertex: how far each start point's unit displacement moves it.
  static Eigen::MatrixXd dense_weights(const Points& mesh, const Points& starts, double radius) {
    Eigen::MatrixXd weights(mesh.cols(), starts.cols());
    for (Eigen::Index start = 0; start < starts.cols(); ++start) {
      Points unit = Points::Zero(3, starts.cols());
      unit(2, start) = 1.0;
      weights.col(start) =
          nendo::test::dense_displacements({}, starts, radius, unit, mesh).row(2).transpose();
    }
    return weights;
  }

  TEST_CASE("weights are a dense solve's to half a step, and 0 is 0") {
    constexpr double half_a_step = 0x1p-20;
    constexpr double in_float = 0x1p-22; // sums of a few, each about 1
    const Points mesh = nendo::reference::table1_plane(64);
    const Points starts = nendo::reference::table1_starts();
    for (const double radius : nendo::reference::table1_radii) {
      const Eigen::MatrixXd weights = dense_weights(mesh, starts, radius);
      for (const auto name : simd_names()) {
        REQUIRE(use_simd(name));
        CAPTURE(name);
        CAPTURE(radius);
        Type1Deformer deformer(mesh, 10, {one_radius(radius)});
        REQUIRE(is_solved(deformer.grab(starts)));
        REQUIRE(deformer.weight_bytes() > 0);
        for (Eigen::Index start = 0; start < 10; ++start) {
          Points ends = starts;
          ends(2, start) += 1.0;
          Points out;
          REQUIRE(is_solved(apply(deformer, ends, out)));
          const Eigen::VectorXd moved = (out - mesh).row(2).transpose();
          CHECK((moved - weights.col(start)).cwiseAbs().maxCoeff() < half_a_step + in_float);
          CHECK(((weights.array() != 0.0).rowwise().any() || moved.array() == 0.0).all());
        }
      }
    }
    use_simd("");
  }

  TEST_CASE("weights keep to their memory, and what no support reaches has none") {
    const Points mesh = nendo::reference::table1_plane(64);
    const auto bytes = [&](double radius, std::size_t memory) {
      Type1Deformer deformer(mesh, 10, {one_radius(radius), {}, {.weight_bytes = memory}});
      deformer.grab(nendo::reference::table1_starts());
      return deformer.weight_bytes();
    };
    const std::size_t all = bytes(80.0, std::size_t{64} << 20);
    CHECK(all > 10 * 2 * 4225); // in 16 bits, where they are near each other
    CHECK(all < 10 * 3 * 4225);
    CHECK(bytes(80.0, all) == all);
    CHECK(bytes(80.0, all - 1) == 0);
    CHECK(bytes(10.0, std::size_t{64} << 20) < all / 7);
  }

  TEST_CASE("what a release frees, and what a commit moves, is restored in an old picture") {
    // One picture, as a frame's buffer, sees a stroke, a grab elsewhere, a commit and another grab.
    const Points mesh = nendo::reference::table1_plane(64);
    Points here(3, 1);
    here << 10, 10, 1;
    Points there(3, 1);
    there << 40, 40, 1;
    const Points up = Eigen::Vector3d(0, 0, 3);
    for (const std::size_t memory : weight_memories) {
      Type1Deformer deformer(mesh, 1, {one_radius(8.0), {}, {.weight_bytes = memory}});
      BlockShape picture;
      const auto is_whole = [&] {
        BlockShape fresh;
        deformer.apply(there + up, fresh);
        return unpacked(deformer, picture) == unpacked(deformer, fresh);
      };
      deformer.grab(here);
      deformer.apply(here + up, picture);
      deformer.grab(there);
      deformer.apply(there + up, picture);
      CHECK(is_whole());
      CHECK(unpacked(deformer, picture).col(65 * 13 + 13) == mesh.col(65 * 13 + 13));
      deformer.commit(there + up);
      deformer.grab(here);
      BlockShape late = picture;
      deformer.apply(here + up, late);
      deformer.grab(there);
      deformer.apply(there + up, picture);
      CHECK(is_whole());
    }
  }

  /// Space for two commits of ten, or for none.
  static DeformerOptions with_undo(std::size_t steps) {
    DeformerOptions options;
    options.supports = one_radius(6.0);
    const std::size_t blocks = (static_cast<std::size_t>(rest.cols()) + 63) / 64;
    options.undo_bytes = steps * (blocks + 1) * 832;
    return options;
  }

  TEST_CASE(
      "undo gives the rest shape before a commit back, bit for bit, as far as memory suffices") {
    for (const std::size_t memory : {0U, 2U, 10U}) {
      Type1Deformer deformer(rest, 10, with_undo(memory));
      std::vector<Points> shapes;
      Points out;
      REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
      for (const double length : {1.0, 0.5, 2.0, 1.5}) {
        shapes.push_back(unpacked(deformer, deformer.rest()));
        REQUIRE(apply(deformer, end_points(length), out) == FieldStatus::ok);
        REQUIRE(deformer.commit(end_points(length)) == FieldStatus::ok);
      }
      CHECK(deformer.sculpted().undo_steps() == std::min<std::size_t>(memory, 4));
      apply(deformer, start_points(), out); // is dropped
      while (deformer.sculpted().undo_steps() > 0) {
        REQUIRE(deformer.go(HistoryMove::undo, start_points()) == FieldStatus::ok);
        CHECK(unpacked(deformer, deformer.rest()) == shapes.back());
        apply(deformer, start_points(), out);
        CHECK(out == shapes.back());
        shapes.pop_back();
      }
      CHECK(shapes.size() == 4 - std::min<std::size_t>(memory, 4));
      const Points last = unpacked(deformer, deformer.rest());
      CHECK(deformer.go(HistoryMove::undo, end_points(1.0)) == FieldStatus::ok);
      CHECK(unpacked(deformer, deformer.rest()) == last);
      Points nowhere = start_points();
      nowhere(0, 0) = std::nan("");
      CHECK(deformer.go(HistoryMove::undo, nowhere) == FieldStatus::not_finite);
      CHECK(unpacked(deformer, deformer.rest()) == last);
    }
  }

  TEST_CASE("take_back drops what was pulled and no commit, and redo brings it back if memory "
            "sufficed") {
    for (const bool injective : {false, true})
      for (const std::size_t memory : {0U, 1U, 10U}) {
        CAPTURE(injective);
        CAPTURE(memory);
        DeformerOptions options = with_undo(memory);
        if (injective) options.injective.emplace();
        Type1Deformer deformer(rest, 10, options);
        Points pulled;
        Points out;
        REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
        REQUIRE(apply(deformer, end_points(0.5), out) == FieldStatus::ok);
        REQUIRE(deformer.commit(end_points(0.5)) == FieldStatus::ok);
        const Points committed = unpacked(deformer, deformer.rest());
        const std::size_t steps = deformer.sculpted().undo_steps();
        apply(deformer, end_points(3.0), pulled);
        REQUIRE(pulled != committed);
        Points nowhere = start_points();
        nowhere(0, 0) = std::nan("");
        CHECK(deformer.take_back(nowhere) == FieldStatus::not_finite);
        REQUIRE(deformer.take_back(end_points(3.0)) == FieldStatus::ok);
        CHECK(unpacked(deformer, deformer.rest()) == committed);
        apply(deformer, end_points(3.0), out);
        CHECK(out == committed); // held there
        CHECK(deformer.sculpted().undo_steps() == steps);
        CHECK(deformer.sculpted().forgotten_steps() == 0);
        CHECK(deformer.sculpted().redo_steps() == (memory == 10 ? 1 : 0));
        REQUIRE(deformer.go(HistoryMove::redo, start_points()) == FieldStatus::ok);
        CHECK(unpacked(deformer, deformer.rest()) == (memory == 10 ? pulled : committed));
        if (memory == 0) continue;
        if (memory == 10)
          REQUIRE(deformer.go(HistoryMove::undo, start_points()) == FieldStatus::ok);
        REQUIRE(deformer.go(HistoryMove::undo, start_points()) == FieldStatus::ok);
        CHECK(unpacked(deformer, deformer.rest()) == unpacked(deformer, deformer.layout().pack()));
      }
  }

  TEST_CASE("no function allocates") {
    DeformerOptions options = with_undo(2);
    options.csrbf.polynomial = Polynomial::linear;
    Type1Deformer deformer(rest, 10, options);
    const Points starts = start_points();
    const Points ends = end_points(1.0);
    BlockShape out;
    deformer.apply(starts, out);
    nendo::test::RestraintCounts counts;
    {
      const nendo::test::Restraint restraint;
      deformer.grab(starts);
      deformer.apply(ends, out);
      deformer.commit(ends);
      deformer.apply(starts, out);
      deformer.go(HistoryMove::undo, starts);
      counts = restraint.counts();
    }
    CHECK(counts.allocations == 0);
  }
}

} // namespace type1_test
