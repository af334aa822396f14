// Fields that keep the volume: the matrices, the equations, and whole strokes.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <string_view>

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/midpoint_chain.hpp>
#include <nendo/deform/triangles.hpp>
#include <nendo/deform/type1.hpp>
#include <nendo/deform/type2.hpp>
#include <nendo/deform/volume_kernel.hpp>

#include "reference/icosphere.hpp"
#include "support/dense_field.hpp"
#include "support/jacobian_at.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace keep_volume_test {

using namespace nendo::deform;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using nendo::test::random_points;

/// By the divergence theorem, about the mean.
static double volume_of(const Mesh& mesh, const Points& vertices) {
  const Vector3d mean = vertices.rowwise().mean();
  double six = 0.0;
  for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    const auto corner = [&](std::size_t k) -> Vector3d { return vertices.col(corners[k]) - mean; };
    six += corner(0).dot(corner(1).cross(corner(2)));
  });
  return six / 6.0;
}

struct Stroke {
  std::string_view name;
  Points starts, displacements;
  double radius;
};

/// Of the unit sphere; the longest is one radius.
static std::vector<Stroke> strokes_of_sphere() {
  const double r = 0.6;
  const auto one = [](double x, double y, double z) {
    Points point(3, 1);
    point << x, y, z;
    return point;
  };
  std::vector<Stroke> strokes{{"push", one(0, 0, 1), one(0, 0, -r), r},
                              {"pull", one(0, 0, 1), one(0, 0, r), r},
                              {"aslant", one(0, 0, 1), one(0.6 * r, 0, -0.8 * r), r}};
  Stroke pinch{"pinch", Points(3, 2), Points(3, 2), r};
  pinch.starts.col(0) = Vector3d(0.3, 0, 1).normalized();
  pinch.starts.col(1) = Vector3d(-0.3, 0, 1).normalized();
  pinch.displacements << -0.35 * r, 0.35 * r, 0, 0, 0, 0;
  strokes.push_back(pinch);
  Stroke ten{"ten", Points(3, 10), Points(3, 10), r};
  std::mt19937 random(3);
  for (Eigen::Index i = 0; i < 10; ++i) {
    ten.starts.col(i) =
        Vector3d(i < 5 ? -1.0 : 1.0, 0.45 * static_cast<double>(i % 5 - 2), 0.6).normalized();
    ten.displacements.col(i) = 0.35 * r * random_points(random, 1, 1.0).col(0).normalized();
  }
  strokes.push_back(ten);
  return strokes;
}

/// Five fingertips side by side on the front of the Moai.
static Stroke stroke_of(const Mesh& moai) {
  const Box box = finite_box_of(moai.vertices);
  const Vector3d sides = box.highest - box.lowest;
  Stroke stroke{"Moai", Points(3, 5), Points(3, 5), sides.norm() / 4.0};
  for (Eigen::Index i = 0; i < 5; ++i) {
    const Vector3d wanted =
        box.lowest + sides.cwiseProduct(Vector3d(0.2 + 0.15 * static_cast<double>(i), 0.75, 1.0));
    Eigen::Index nearest = 0;
    (moai.vertices.colwise() - wanted).colwise().squaredNorm().minCoeff(&nearest);
    stroke.starts.col(i) = moai.vertices.col(nearest);
    stroke.displacements.col(i) << 0.0, 0.0, -0.35 * stroke.radius;
  }
  return stroke;
}

static CsrbfField field_of(const CsrbfOptions& options, const Points& starts,
                           const Supports& supports, const Points& displacements) {
  CsrbfSolver solver(options);
  CsrbfField field;
  REQUIRE(is_solved(solver.build(starts, supports)));
  REQUIRE(is_solved(solver.solve(displacements, field)));
  return field;
}

static Points displaced(const Points& points, const Stroke& stroke, const CsrbfOptions& options) {
  MidpointChain chain(stroke.starts.cols(), one_radius(stroke.radius), options, 64);
  REQUIRE(is_solved(chain.grab(stroke.starts)));
  REQUIRE(is_solved(chain.go(stroke.displacements)));
  std::vector<CsrbfField> fields;
  while (chain.next())
    fields.push_back(chain.field());
  REQUIRE(is_solved(chain.status()));
  Points moved;
  displace(fields, points, moved);
  return moved;
}

/// Slopes of s at x by differences.
static Matrix3d differences(const CsrbfField& field, const Vector3d& x) {
  const double h = 1e-5;
  Matrix3d slopes;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    slopes.col(axis) = (8.0 * (field.displacement_at(x + h * Vector3d::Unit(axis)) -
                               field.displacement_at(x - h * Vector3d::Unit(axis))) -
                        (field.displacement_at(x + 2.0 * h * Vector3d::Unit(axis)) -
                         field.displacement_at(x - 2.0 * h * Vector3d::Unit(axis)))) /
                       (12.0 * h);
  return slopes;
}

static Points scattered(std::mt19937& random, Eigen::Index count) {
  Points points(3, count);
  for (Eigen::Index i = 0; i < count;) {
    const Vector3d point = random_points(random, 1, 1.5).col(0);
    const bool apart =
        i == 0 || (points.leftCols(i).colwise() - point).colwise().norm().minCoeff() > 0.2;
    if (apart) points.col(i++) = point;
  }
  return points;
}

TEST_SUITE("keep volume") {
  TEST_CASE("the field of clay has no divergence, and that of a mixture in proportion to its air") {
    std::mt19937 random(1);
    const Points starts = scattered(random, 10);
    const Points displacements = random_points(random, 10, 0.3);
    for (const Wendland air : {Wendland::c2, Wendland::c4, Wendland::c6}) {
      for (const double keep : {1.0, 0.5, 0.01}) {
        CAPTURE(keep);
        CsrbfField field =
            field_of({.kernel = air, .keep_volume = keep}, starts, one_radius(1.2), displacements);
        CsrbfField of_air = field;
        of_air.keep_volume = 0.0;
        double divergence = 0.0;
        double gradient = 0.0;
        for (int trial = 0; trial < 300; ++trial) {
          const Vector3d x = random_points(random, 1, 1.5).col(0);
          const Matrix3d slopes = differences(field, x);
          gradient = std::max(gradient, slopes.norm());
          divergence = std::max(
              divergence, std::abs(slopes.trace() - (1.0 - keep) * differences(of_air, x).trace()));
        }
        CHECK(divergence < 1e-6 * gradient);
      }
    }
  }

  TEST_CASE("interpolates exactly, as a dense solve of the curl of the curl does") {
    std::mt19937 random(2);
    for (const Eigen::Index count : {1, 2, 10, 33, 101, 120}) {
      for (const double keep : {0.3, 1.0}) {
        CAPTURE(count);
        CAPTURE(keep);
        const CsrbfOptions options{.keep_volume = keep};
        const Points starts = scattered(random, count);
        const Points displacements = random_points(random, count, 0.5);
        const CsrbfField field = field_of(options, starts, one_radius(0.8), displacements);
        for (Eigen::Index i = 0; i < count; ++i)
          CHECK((field.displacement_at(starts.col(i)) - displacements.col(i)).norm() < 1e-12);
        const Points places = random_points(random, 50, 1.5);
        const Points expected =
            nendo::test::dense_displacements(options, starts, 0.8, displacements, places);
        Points moved;
        displace(field, places, moved);
        CHECK((moved - places - expected).cwiseAbs().maxCoeff() < 1e-10);
      }
    }
  }

  TEST_CASE("several radii, shared ones and own ones, interpolate") {
    std::mt19937 random(3);
    for (int trial = 0; trial < 20; ++trial) {
      const Points starts = scattered(random, 12);
      const Points displacements = random_points(random, 12, 0.5);
      Supports supports{{{0.4, 1.0}, {1.5, 0.2}}, {}};
      for (Eigen::Index i = 0; i < 12; i += 2)
        supports.own.push_back({i, {0.3 + 0.1 * static_cast<double>(i), 2.0}});
      const CsrbfField field = field_of({.keep_volume = 0.7}, starts, supports, displacements);
      REQUIRE(field.centres.cols() == supports.functions(12));
      for (Eigen::Index i = 0; i < 12; ++i)
        CHECK((field.displacement_at(starts.col(i)) - displacements.col(i)).norm() < 1e-10);
    }
  }

  TEST_CASE("start points that coincide share their displacements") {
    Points starts(3, 3);
    starts << 0, 0, 1, 0, 0, 0, 0, 0, 0;
    Points displacements(3, 3);
    displacements << 1, 0, 0, 0, 2, 0, 0, 0, 0;
    CsrbfSolver solver({.keep_volume = 1.0});
    CsrbfField field;
    REQUIRE(solver.build(starts, one_radius(2.0)) == FieldStatus::merged);
    REQUIRE(solver.solve(displacements, field) == FieldStatus::merged);
    CHECK((field.displacement_at(starts.col(0)) - Vector3d(0.5, 1.0, 0.0)).norm() < 1e-6);
    CHECK(field.displacement_at(starts.col(2)).norm() < 1e-6);
  }

  TEST_CASE("the Jacobian is the differences', and the Lipschitz bound holds") {
    std::mt19937 random(4);
    for (const double keep : {1.0, 0.4}) {
      const Points starts = scattered(random, 8);
      const CsrbfField field =
          field_of({.keep_volume = keep}, starts, one_radius(0.9), random_points(random, 8, 0.2));
      const double bound = lipschitz_bound(field);
      for (int trial = 0; trial < 500; ++trial) {
        const Vector3d x = random_points(random, 1, 1.5).col(0);
        const Matrix3d slopes = differences(field, x);
        CHECK((nendo::test::jacobian_at(field, x) - Matrix3d::Identity() - slopes).norm() < 1e-8);
        CHECK(std::sqrt((slopes.transpose() * slopes)
                            .eval()
                            .selfadjointView<Eigen::Lower>()
                            .eigenvalues()
                            .maxCoeff()) <= bound);
      }
    }
  }

  TEST_CASE("strokes of one radius change the volume by less than 0.03 %") {
    const Mesh ball = nendo::reference::icosphere(5, 1.0); // edges of 0.06 radii
    const double before = volume_of(ball, ball.vertices);
    for (const Stroke& stroke : strokes_of_sphere()) {
      CAPTURE(stroke.name);
      const auto change = [&](double keep) {
        const Points moved = displaced(ball.vertices, stroke, {.keep_volume = keep});
        return std::abs(volume_of(ball, moved) / before - 1.0);
      };
      MESSAGE(stroke.name, ": ", change(1.0), " of clay, ", change(0.5), ", ", change(1e-9),
              " of air");
      CHECK(change(1.0) < 3e-4);
      if (stroke.name != "aslant") CHECK(change(1e-9) > 3e-3); // what clay is measured against
    }
    const auto moai = read_mesh(std::filesystem::path(NENDO_MODELS) / "moai.obj");
    REQUIRE(moai);
    const Stroke stroke = stroke_of(*moai);
    const double whole = volume_of(*moai, moai->vertices);
    const auto change = [&](double keep) {
      const Points moved = displaced(moai->vertices, stroke, {.keep_volume = keep});
      return std::abs(volume_of(*moai, moved) / whole - 1.0);
    };
    MESSAGE("Moai: ", change(1.0), " of clay, ", change(1e-9), " of air");
    CHECK(change(1.0) < 3e-4);
    CHECK(change(1e-9) > 1e-2);
  }

  TEST_CASE("start points reach their displacements, however far") {
    for (Stroke stroke : strokes_of_sphere()) {
      CAPTURE(stroke.name);
      for (const double times : {0.1, 1.0, 3.7}) {
        Stroke longer = stroke;
        longer.displacements *= times;
        if (times > 1.0 && stroke.starts.cols() > 1) continue; // their ways may cross
        const Points ends = displaced(stroke.starts, longer, {.keep_volume = 1.0});
        CHECK((ends - stroke.starts - longer.displacements).cwiseAbs().maxCoeff() < 1e-9);
      }
    }
  }

  TEST_CASE("the shape is continuous in the way, also where another step begins") {
    const Stroke push = strokes_of_sphere()[2];
    const Mesh ball = nendo::reference::icosphere(3, 1.0);
    const auto shape = [&](double part) {
      Stroke stroke = push;
      stroke.displacements *= part;
      return displaced(ball.vertices, stroke, {.keep_volume = 1.0});
    };
    for (const double part : {0.25, 0.5, 0.75}) // whole steps
      for (const double off : {-1e-7, 1e-7})
        CHECK((shape(part + off) - shape(part)).cwiseAbs().maxCoeff() < 3e-7);
  }

  /// In float, of the model's diagonal.
  constexpr double promised = 1e-5;

  TEST_CASE("Type-1 and its fields make the shape of the chain, without allocation") {
    const Mesh ball = nendo::reference::icosphere(5, 1.0);
    const double before = volume_of(ball, ball.vertices);
    for (const Stroke& stroke : strokes_of_sphere()) {
      CAPTURE(stroke.name);
      for (const double keep : {0.5, 1.0}) {
        for (const int threads : {1, 2}) {
          DeformerOptions options{one_radius(stroke.radius), {.keep_volume = keep}};
          options.evaluation.threads = threads;
          Type1Deformer deformer(ball.vertices, stroke.starts.cols(), options);
          BlockShape out = deformer.rest();
          REQUIRE(is_solved(deformer.grab(stroke.starts)));
          nendo::test::RestraintCounts counts;
          for (const double part : {0.3, 1.3, 1.0}) {
            const Points ends = stroke.starts + part * stroke.displacements;
            const nendo::test::Restraint restraint;
            REQUIRE(is_solved(deformer.apply(ends, out)));
            counts = restraint.counts();
          }
          CHECK(counts.allocations == 0);
          CHECK(counts.locks == 0);
          Points shape;
          deformer.layout().unpack(out, shape);
          const Points expected = displaced(ball.vertices, stroke, {.keep_volume = keep});
          CHECK((shape - expected).cwiseAbs().maxCoeff() < promised * diagonal_of(ball.vertices));
          Points copy;
          displace(deformer.fields().fields(), ball.vertices, copy);
          CHECK((shape - copy).cwiseAbs().maxCoeff() < promised * diagonal_of(ball.vertices));
          if (keep == 1.0) CHECK(std::abs(volume_of(ball, shape) / before - 1.0) < 3e-4);
        }
      }
    }
  }

  TEST_CASE("Type-1 goes back to the rest shape, commits, and undoes") {
    const Mesh ball = nendo::reference::icosphere(4, 1.0);
    const Stroke stroke = strokes_of_sphere()[4];
    DeformerOptions options{one_radius(stroke.radius), {.keep_volume = 1.0}};
    options.undo_bytes = std::size_t{8} << 20;
    Type1Deformer deformer(ball.vertices, stroke.starts.cols(), options);
    BlockShape out = deformer.rest();
    Points first, shape;
    deformer.layout().unpack(out, first);
    const Points ends = stroke.starts + stroke.displacements;
    REQUIRE(is_solved(deformer.grab(stroke.starts)));
    REQUIRE(is_solved(deformer.apply(ends, out)));
    REQUIRE(is_solved(deformer.apply(stroke.starts, out)));
    deformer.layout().unpack(out, shape);
    CHECK(shape == first);
    REQUIRE(is_solved(deformer.apply(ends, out)));
    Points moved;
    deformer.layout().unpack(out, moved);
    Points bad = ends;
    bad(0, 0) = std::nan("");
    CHECK(deformer.apply(bad, out) == FieldStatus::not_finite);
    deformer.layout().unpack(out, shape);
    CHECK(shape == moved);
    REQUIRE(is_solved(deformer.commit(ends)));
    deformer.layout().unpack(deformer.rest(), shape);
    CHECK(shape == moved);
    REQUIRE(is_solved(deformer.go(HistoryMove::undo, ends)));
    deformer.layout().unpack(deformer.rest(), shape);
    CHECK(shape == first);
    REQUIRE(is_solved(deformer.go(HistoryMove::redo, ends)));
    deformer.layout().unpack(deformer.rest(), shape);
    CHECK(shape == moved);
  }

  TEST_CASE("Type-2 keeps the volume, and its fields lead from shape to shape") {
    const Mesh ball = nendo::reference::icosphere(5, 1.0);
    const double before = volume_of(ball, ball.vertices);
    for (const Stroke& stroke : strokes_of_sphere()) {
      CAPTURE(stroke.name);
      for (const double piece : {0.05, 0.4}) { // the latter in two steps
        CAPTURE(piece);
        Type2Deformer deformer(ball.vertices, stroke.starts.cols(), piece * stroke.radius,
                               {one_radius(stroke.radius), {.keep_volume = 1.0}});
        REQUIRE(is_solved(deformer.begin(stroke.starts)));
        Points copy = ball.vertices;
        nendo::test::RestraintCounts counts;
        for (int tick = 1; tick <= 20; ++tick) {
          const Points tips = stroke.starts + tick / 20.0 * stroke.displacements;
          {
            const nendo::test::Restraint restraint;
            const StrokeResult result =
                tick == 20 ? deformer.end_at(tips) : deformer.stroke_to(tips);
            REQUIRE(is_solved(result.status));
            counts = restraint.counts();
          }
          CHECK(counts.allocations == 0);
          displace(deformer.fields().fields(), copy, copy);
        }
        Points shape;
        deformer.layout().unpack(deformer.shape(), shape);
        CHECK((shape - copy).cwiseAbs().maxCoeff() < promised * diagonal_of(ball.vertices));
        CHECK(std::abs(volume_of(ball, shape) / before - 1.0) < 3e-4);
      }
    }
  }

  TEST_CASE("what the brush presses in comes out nearby") {
    const Mesh ball = nendo::reference::icosphere(5, 1.0);
    const double before = volume_of(ball, ball.vertices);
    const auto change = [&](double keep) {
      DeformerOptions options{one_radius(0.6), {.keep_volume = keep}};
      options.brushes.of_points = {Brush::push};
      options.brushes.strength = 1.0;
      options.brushes.rings = std::make_shared<const VertexRings>(ball, BlockLayout(ball.vertices));
      Type2Deformer deformer(ball.vertices, 1, 0.03, options);
      Points tip(3, 1);
      tip << 0.0, 0.0, 1.0;
      REQUIRE(is_solved(deformer.begin(tip)));
      for (int tick = 1; tick <= 20; ++tick) {
        tip << 0.0, 0.015 * tick, std::sqrt(1.0 - std::pow(0.015 * tick, 2)); // over the surface
        deformer.stroke_to(tip);
      }
      Points shape;
      deformer.layout().unpack(deformer.shape(), shape);
      CHECK((shape - ball.vertices).colwise().norm().maxCoeff() > 0.1);
      return std::abs(volume_of(ball, shape) / before - 1.0);
    };
    MESSAGE("push: ", change(1.0), " of clay, ", change(0.0), " of air");
    CHECK(change(1.0) < 1e-3);
    CHECK(change(0.0) > 5e-3);
  }

  TEST_CASE("more points than the equations take are refused") {
    std::mt19937 random(5);
    CsrbfSolver solver({.keep_volume = 1.0});
    const Points many = random_points(random, CsrbfSolver::max_volume_points + 1, 100.0);
    CHECK(solver.build(many, one_radius(1.0)) == FieldStatus::too_dense);
  }
}

} // namespace keep_volume_test
