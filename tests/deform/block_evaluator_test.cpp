#include "field/block_evaluator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include <doctest/doctest.h>

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/simd.hpp>

#include "reference/table1.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace block_evaluator_test {

using namespace nendo::deform;
using nendo::test::random_points;

TEST_SUITE("block_evaluator") {
  /// What the evaluation in blocks promises of displace() in double: of the model's diagonal.
  constexpr double promised = 1e-5;

  static CsrbfField solved(const Points& starts, const Points& moves, const Eigen::VectorXd& radii,
                           CsrbfOptions options = {}) {
    CsrbfSolver solver(options);
    CsrbfField field;
    REQUIRE(is_solved(solver.build(starts, radii)));
    REQUIRE(is_solved(solver.solve(moves, field)));
    return field;
  }

  /// A field that is no solution: random centres and coefficients.
  static CsrbfField random_field(Eigen::Index entries, double radius, unsigned seed) {
    std::mt19937 random(seed);
    CsrbfField field;
    field.centres = random_points(random, entries, 5.0);
    field.coefficients = random_points(random, entries, 0.5);
    field.radii = Eigen::VectorXd::Constant(entries, radius);
    for (Eigen::Index i = 0; i < entries; i += 3)
      field.radii[i] *= 1.5;
    return field;
  }

  static Points in_blocks(const CsrbfField& field, const Points& mesh, int threads = 1) {
    const BlockLayout layout(mesh);
    BoundedShape shape(layout.pack());
    BlockEvaluator evaluator(layout, field.centres.cols(), {.threads = threads});
    REQUIRE(evaluator.set_field(field));
    REQUIRE(evaluator.displace(shape));
    Points out;
    layout.unpack(shape.shape, out);
    return out;
  }

  static Points in_double(const CsrbfField& field, const Points& mesh) {
    Points out;
    displace(field, mesh, out);
    return out;
  }

  /// Of the model's diagonal.
  static double apart(const CsrbfField& field, const Points& mesh) {
    const Points gap = in_blocks(field, mesh) - in_double(field, mesh);
    return gap.colwise().norm().maxCoeff() / diagonal_of(mesh);
  }

  TEST_CASE("there are instruction sets to choose from, and no others") {
    CHECK_FALSE(simd_names().empty());
    for (const auto name : simd_names())
      CHECK(use_simd(name));
    CHECK_FALSE(use_simd("abacus"));
    CHECK(use_simd(""));
  }

  TEST_CASE("every cell of the paper's table, by every instruction set, is what double makes") {
    for (const auto& [of_cells, middles] :
         {std::pair{32, false}, {64, false}, {128, false}, {128, true}}) {
      const int cells = of_cells; // Clang 14 captures no structured bindings
      const Points mesh = nendo::reference::table1_plane(cells, middles);
      for (const double radius : nendo::reference::table1_radii) {
        std::mt19937 random(7);
        const Eigen::VectorXd radii = Eigen::VectorXd::Constant(10, radius);
        for (const auto& starts :
             {nendo::reference::table1_starts(), nendo::reference::crowded_starts()}) {
          const auto moves = nendo::reference::table1_displacements(random);
          const CsrbfField field = solved(starts, moves, radii);
          CAPTURE(cells);
          CAPTURE(radius);
          for (const auto name : simd_names()) {
            if (cells > 64 && name != simd_names().front()) continue; // small ones suffice
            REQUIRE(use_simd(name));
            CAPTURE(name);
            CHECK(apart(field, mesh) < promised);
          }
        }
      }
    }
    use_simd("");
  }

  TEST_CASE("all kernels, radii of their own and polynomials are what double makes") {
    const Points mesh = nendo::test::sphere(30, 50, 5.0).vertices;
    for (const auto name : simd_names()) {
      REQUIRE(use_simd(name));
      CAPTURE(name);
      for (const auto kernel : {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6}) {
        CsrbfField field = random_field(12, 3.0, 51);
        field.kernel = kernel;
        CHECK(apart(field, mesh) < 1e-6);
        field.polynomial << 0.5, 0.1, -0.2, 0.3, -1.0, 0.0, 0.1, 0.2, 0.3, -0.1, 0.2, 0.0;
        CHECK(apart(field, mesh) < 1e-6);
      }
    }
    use_simd("");
  }

  TEST_CASE("as many supports as vectors hold, fewer and more, are what double makes") {
    const Points mesh = nendo::test::sphere(30, 50, 5.0).vertices;
    for (const auto name : simd_names()) {
      REQUIRE(use_simd(name));
      for (unsigned count = 1; count <= 40; ++count) {
        CAPTURE(name);
        CAPTURE(count);
        CHECK(apart(random_field(static_cast<Eigen::Index>(count), 2.0, 60 + count), mesh) < 1e-6);
      }
    }
    use_simd("");
  }

  TEST_CASE("thousands of small supports, and supports larger than any model") {
    std::mt19937 random(52);
    const Points mesh = random_points(random, 3000, 5.0);
    for (const auto name : simd_names()) {
      REQUIRE(use_simd(name));
      CAPTURE(name);
      CHECK(apart(random_field(3000, 0.7, 53), mesh) < 1e-6);
      CHECK(apart(random_field(40, 1e12, 54), mesh) < 1e-6);
      CHECK(apart(random_field(1, 1e-30, 55), mesh) == 0.0);
    }
    use_simd("");
    CHECK(apart(random_field(70'000, 0.05, 56), random_points(random, 300, 5.0)) < 1e-6);
  }

  TEST_CASE("coefficients of thousands that cancel lose nothing") {
    // Two points that nearly coincide and part: their coefficients are 1e4 times the displacement.
    Points starts(3, 2);
    starts << 0, 0.02, 0, 0, 0, 0;
    Points moves = Points::Zero(3, 2);
    moves(0, 1) = 0.05;
    const CsrbfField field = solved(starts, moves, Eigen::VectorXd::Constant(2, 4.0));
    REQUIRE(field.coefficients.cwiseAbs().maxCoeff() > 100.0);
    const Points mesh = nendo::test::sphere(30, 50, 1.0).vertices;
    for (const auto name : simd_names()) {
      REQUIRE(use_simd(name));
      CHECK(apart(field, mesh) < promised);
    }
    use_simd("");
  }

  TEST_CASE("models far from zero, tiny ones and huge ones lose nothing") {
    const Points mesh = nendo::test::sphere(20, 30, 5.0).vertices;
    for (const double scale : {1e-30, 1.0, 1e30})
      for (const double shift : {0.0, 1e5}) {
        const Points moved = scale * (mesh.array() + shift).matrix();
        CsrbfField field = random_field(10, 4.0, 57);
        field.centres = scale * (field.centres.array() + shift).matrix();
        field.radii *= scale;
        field.coefficients *= scale;
        CAPTURE(scale);
        CAPTURE(shift);
        CHECK(apart(field, moved) < 1e-6);
      }
  }

  TEST_CASE("a block that nothing reaches is not written, and vertices there stay bit for bit") {
    const Points mesh = nendo::reference::table1_plane(64);
    const BlockLayout layout(mesh);
    const BoundedShape rest(layout.pack());
    CsrbfField field = random_field(1, 6.0, 58);
    field.centres.setZero(); // a corner
    BlockShape out = rest.shape;
    for (std::size_t block = 0; block < out.block_count(); ++block)
      out.data()[block].x.fill(77.0F);
    BlockEvaluator evaluator(layout, 1, {});
    REQUIRE(evaluator.set_field(field));
    REQUIRE(evaluator.displace(rest, out));
    std::size_t written = 0;
    for (std::size_t block = 0; block < out.block_count(); ++block)
      written += out[block].x[0] == 77.0F ? 0U : 1U;
    CHECK(written > 0);
    CHECK(written < out.block_count() / 10);
    BlockShape whole; // what was not there is copied
    REQUIRE(evaluator.displace(rest, whole));
    Points moved;
    layout.unpack(whole, moved);
    for (Eigen::Index i = 0; i < mesh.cols(); ++i)
      if ((mesh.col(i) - field.centres.col(0)).norm() >= field.radii[0])
        CHECK(moved.col(i) == mesh.col(i));
    CHECK((moved - mesh).cwiseAbs().maxCoeff() > 0.1);
  }

  TEST_CASE("bounds follow a shape that is displaced again and again") {
    const Points mesh = nendo::test::sphere(20, 30, 5.0).vertices;
    const BlockLayout layout(mesh);
    BoundedShape shape(layout.pack());
    BlockEvaluator evaluator(layout, 10, {});
    for (unsigned step = 0; step < 20; ++step) {
      REQUIRE(evaluator.set_field(random_field(10, 3.0, step)));
      REQUIRE(evaluator.displace(shape));
    }
    for (std::size_t block = 0; block < shape.shape.block_count(); ++block) {
      const VertexBlock& vertices = shape.shape[block];
      const auto& sides = shape.bounds[block].sides;
      std::size_t axis = 0;
      for (const auto* const row : {&vertices.x, &vertices.y, &vertices.z}) {
        const auto [low, high] = std::minmax_element(row->begin(), row->end());
        CHECK(sides[axis] == *low);
        CHECK(sides[axis + 4] == -*high);
        ++axis;
      }
    }
  }

  TEST_CASE("two threads make the same bits as one") {
    std::mt19937 random(59);
    // Too few for two, the fewest that are shared, a last piece of one vertex, many pieces.
    for (const Eigen::Index vertices : {3071, 3072, 4097, 5000, 20'000}) {
      CAPTURE(vertices);
      const Points mesh = random_points(random, vertices, 5.0);
      for (const Eigen::Index entries : {10, 200}) {
        const CsrbfField field = random_field(entries, 2.0, 60);
        CHECK(in_blocks(field, mesh, 2) == in_blocks(field, mesh, 1));
      }
    }
  }

  TEST_CASE("a shape too large for the caches goes elsewhere by the same bits as in its place") {
    const Points mesh = nendo::reference::table1_plane(650); // 424 000 vertices
    const BlockLayout layout(mesh);
    BoundedShape shape(layout.pack());
    for (const auto name : simd_names()) {
      REQUIRE(use_simd(name));
      CAPTURE(name);
      for (const double coefficient : {0.5, 3000.0}) { // by sums in float, and in double
        BlockEvaluator evaluator(layout, 10, {.threads = 2});
        CsrbfField field = random_field(10, 8.0, 65);
        field.centres.array() += 20.0;
        field.coefficients *= coefficient;
        REQUIRE(evaluator.set_field(field));
        BlockShape elsewhere = shape.shape;
        REQUIRE(evaluator.displace(shape, elsewhere));
        REQUIRE(evaluator.displace(shape));
        std::size_t same = 0;
        for (std::size_t block = 0; block < elsewhere.block_count(); ++block)
          same += elsewhere[block].x == shape.shape[block].x &&
                          elsewhere[block].y == shape.shape[block].y &&
                          elsewhere[block].z == shape.shape[block].z
                      ? 1U
                      : 0U;
        CHECK(same == elsewhere.block_count());
      }
    }
    use_simd("");
  }

  TEST_CASE("fields that are not finite or too large are refused, and nothing moves") {
    const Points mesh = nendo::test::sphere(10, 12, 5.0).vertices;
    const BlockLayout layout(mesh);
    BoundedShape shape(layout.pack());
    BlockEvaluator evaluator(layout, 4, {});
    const auto refused = [&](CsrbfField field) {
      const bool taken = evaluator.set_field(field) && evaluator.displace(shape);
      Points out;
      layout.unpack(shape.shape, out);
      const bool still = out == mesh; // the matrices would fill a screen
      CHECK(still);
      return !taken;
    };
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e60}) {
      CsrbfField field = random_field(4, 3.0, 61);
      field.coefficients(1, 2) = bad;
      CHECK(refused(field));
      field = random_field(4, 3.0, 61);
      field.polynomial(1, 2) = bad;
      CHECK(refused(field));
    }
    CsrbfField field = random_field(4, 3.0, 61);
    field.centres(0, 0) = std::nan("");
    CHECK(refused(field));
    field = random_field(4, 3.0, 61);
    field.radii[3] = std::nan("");
    CHECK(refused(field));
  }

  TEST_CASE("a shape that grows without end stays finite, and is recognised when it cannot grow") {
    const BlockLayout layout(nendo::test::sphere(10, 12, 5.0).vertices);
    BoundedShape shape(layout.pack());
    BlockEvaluator evaluator(layout, 1, {});
    CsrbfField field = random_field(1, 3.0, 62);
    field.coefficients.setZero();
    field.polynomial.rightCols<3>().setConstant(1e3);
    REQUIRE(evaluator.set_field(field));
    int steps = 0;
    while (steps < 100 && evaluator.displace(shape))
      ++steps;
    CHECK(steps > 5);
    CHECK(steps < 100);
    Points out;
    layout.unpack(shape.shape, out);
    CHECK(out.allFinite());
  }

  TEST_CASE("neither a new field nor its evaluation allocates, with one thread or two") {
    std::mt19937 random(63);
    const BlockLayout layout(random_points(random, 5000, 5.0));
    BoundedShape shape(layout.pack());
    BlockShape out = shape.shape;
    const CsrbfField field = random_field(50, 2.0, 64);
    for (const int threads : {1, 2}) {
      BlockEvaluator evaluator(layout, 50, {.threads = threads});
      nendo::test::RestraintCounts counts;
      {
        const nendo::test::Restraint restraint;
        evaluator.set_field(field);
        evaluator.displace(shape, out);
        evaluator.displace(shape);
        out.follow(shape.shape);
        counts = restraint.counts();
      }
      CHECK(counts.allocations + counts.locks == 0);
    }
  }

  TEST_CASE("pairs of blocks and supports are those that a look at every vertex finds, or more") {
    const Points mesh = nendo::test::sphere(20, 30, 5.0).vertices;
    const BlockLayout layout(mesh);
    const BoundedShape rest(layout.pack());
    const CsrbfField field = random_field(10, 4.0, 81);
    std::size_t pairs = 0;
    for (std::size_t block = 0; block < layout.block_count(); ++block)
      for (Eigen::Index i = 0; i < field.centres.cols(); ++i) {
        bool reached = false;
        for (std::size_t at = block * block_size;
             at < std::min((block + 1) * block_size, layout.vertex_count()); ++at) {
          const auto vertex = static_cast<Eigen::Index>(layout.order()[at]);
          reached = reached || (mesh.col(vertex) - field.centres.col(i)).norm() < field.radii[i];
        }
        pairs += reached ? 1U : 0U;
      }
    for (const auto name : simd_names()) {
      REQUIRE(use_simd(name));
      BlockEvaluator evaluator(layout, 10, {});
      REQUIRE(evaluator.set_field(field));
      CHECK(evaluator.count_pairs(rest) >= pairs);
      CHECK(evaluator.count_pairs(rest) < 2 * pairs);
    }
    use_simd("");
  }
}

} // namespace block_evaluator_test
