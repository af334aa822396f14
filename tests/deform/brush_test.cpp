// Laws of the brushes, in double and by sums over the mesh's own triangles.

#include <nendo/deform/brush.hpp>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include <nendo/deform/triangles.hpp>
#include <nendo/deform/type2.hpp>

#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace brush_test {

using namespace nendo::deform;
using Eigen::Vector3d;

static const Mesh ball = nendo::test::sphere(60, 80, 5.0);

static double volume_of(const Mesh& mesh, const Points& vertices) {
  double sum = 0.0;
  for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& at) {
    sum += vertices.col(at[0]).dot(vertices.col(at[1]).cross(vertices.col(at[2]))) / 6.0;
  });
  return sum;
}

/// Lets one fingertip brush `from` there along that way, in 20 samples.
static Points brushed(const Mesh& mesh, Brush brush, double strength, const Vector3d& from,
                      const Vector3d& way, double radius = 2.0) {
  DeformerOptions options;
  options.supports = one_radius(radius);
  options.brushes.of_points = {brush};
  options.brushes.strength = strength;
  options.brushes.rings = std::make_shared<VertexRings>(mesh, BlockLayout(mesh.vertices));
  Type2Deformer deformer(mesh.vertices, 1, 0.05 * radius, options);
  deformer.begin(from);
  for (int k = 1; k <= 20; ++k) {
    const BlockShape before = deformer.shape();
    deformer.stroke_to(from + way * (k / 20.0));
    bool changed = false;
    for (std::size_t block = 0; block < before.block_count(); ++block)
      changed = changed || before.stamp(block) != deformer.shape().stamp(block);
    CHECK(deformer.is_brushed() == changed);
  }
  deformer.end_at(from + way);
  Points shape;
  deformer.layout().unpack(deformer.shape(), shape);
  return shape;
}

static const Vector3d top(0.0, 5.0, 0.0);
static const Vector3d along(1.0, 0.0, 0.0);

/// Of how far each vertex went out, along the sphere's normal.
static Eigen::VectorXd heights(const Points& shape) {
  return shape.colwise().norm().transpose().array() - 5.0;
}

TEST_SUITE("brush") {
  TEST_CASE("every brush has a name that is read back") {
    for (std::uint8_t number = 0; number < brush_count; ++number) {
      const auto brush = static_cast<Brush>(number);
      CHECK(brush_named(name_of(brush)) == brush);
      CHECK(brush_words().find(name_of(brush)) != std::string::npos);
    }
    CHECK(brush_words().starts_with("pull, none, "));
    CHECK_FALSE(brush_named("paint"));
  }

  TEST_CASE("rings are those of the mesh") {
    const BlockLayout layout(ball.vertices);
    const VertexRings rings(ball, layout);
    std::size_t triangles = 0;
    for_each_triangle(ball, [&](const auto&) { ++triangles; });
    std::size_t corners = 0;
    Vector3d sum = Vector3d::Zero();
    for (std::size_t place = 0; place < rings.vertex_count(); ++place) {
      corners += rings.triangles(place).size();
      sum += area_normal(rings, layout.pack(), place);
      // A triangulated disc about an inner vertex has as many triangles as vertices around it.
      CHECK(rings.neighbours(place).size() == rings.triangles(place).size());
    }
    CHECK(corners == 3 * triangles);
    CHECK(sum.norm() < 1e-4); // of a closed surface
  }

  TEST_CASE("vertices at the same place share a ring, and a border is a line") {
    // Two triangles with an edge in common, whose vertices are there twice.
    Mesh mesh;
    mesh.vertices.resize(3, 6);
    mesh.vertices << 0, 1, 0, 1, 1, 0, /**/ 0, 0, 1, 0, 1, 1, /**/ 0, 0, 0, 0, 0, 0;
    mesh.face_corners = {0, 1, 2, 3, 4, 5};
    mesh.face_starts = {0, 3, 6};
    const BlockLayout layout(mesh.vertices);
    const VertexRings rings(mesh, layout);
    const auto places = layout.places();
    CHECK(rings.triangles(places[0]).size() == 1);
    for (const std::uint32_t twin : {1U, 2U, 3U, 5U}) {
      CHECK(rings.triangles(places[twin]).size() == 2);
      CHECK(rings.neighbours(places[twin]).size() == 2); // not the one across
    }
    CHECK(rings.triangles(places[1]).data() == rings.triangles(places[3]).data());
  }

  TEST_CASE("no brush leaves the shape alone, nor does one with no strength move it") {
    CHECK(brushed(ball, Brush::none, 1.0, top, along) == ball.vertices);
    CHECK(brushed(ball, Brush::inflate, 0.0, top, along) == ball.vertices);
  }

  TEST_CASE("no brush moves what is out of its reach") {
    for (std::uint8_t number = 2; number < brush_count; ++number) {
      CAPTURE(name_of(static_cast<Brush>(number)));
      const Points shape = brushed(ball, static_cast<Brush>(number), 1.0, top, along);
      CHECK(shape != ball.vertices);
      for (Eigen::Index at = 0; at < shape.cols(); ++at) {
        // Nothing moves by more than a radius, so that what it moves was within two.
        const double off = (ball.vertices.col(at) - (top + along / 2)).norm();
        if (off > 4.6) CHECK(shape.col(at) == ball.vertices.col(at));
      }
    }
  }

  TEST_CASE("inflate goes out, push goes in, and strengths below 0 turn them round") {
    const Eigen::VectorXd out = heights(brushed(ball, Brush::inflate, 1.0, top, along));
    CHECK(out.minCoeff() > -1e-3);
    CHECK(out.maxCoeff() > 0.5);
    CHECK(out.maxCoeff() < 1.0 + 1e-6); // at most the way
    const Eigen::VectorXd in = heights(brushed(ball, Brush::inflate, -1.0, top, along));
    CHECK(in.minCoeff() < -0.5);
    CHECK(heights(brushed(ball, Brush::push, 1.0, top, along)).minCoeff() < -0.5);
    CHECK(heights(brushed(ball, Brush::push, -1.0, top, along)).maxCoeff() > 0.5);
  }

  TEST_CASE("smooth keeps the volume, and takes off roughness") {
    Mesh rough = ball;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> height(0.99, 1.01);
    for (Eigen::Index at = 0; at < rough.vertices.cols(); ++at)
      rough.vertices.col(at) *= height(random);
    const Points shape = brushed(rough, Brush::smooth, 1.0, top - along * 2, along * 4);
    CHECK(std::abs(volume_of(rough, shape) / volume_of(rough, rough.vertices) - 1.0) < 1e-4);
    const BlockLayout layout(ball.vertices);
    const VertexRings rings(ball, layout);
    const auto roughness = [&](const Points& of) { // heights over those of the neighbours
      double sum = 0.0;
      for (std::size_t place = 0; place < rings.vertex_count(); ++place) {
        if (ball.vertices(1, layout.order()[place]) < 4.9) continue;
        double mean = 0.0;
        for (const std::uint32_t other : rings.neighbours(place))
          mean += of.col(layout.order()[other]).norm();
        mean /= static_cast<double>(rings.neighbours(place).size());
        sum += std::pow(of.col(layout.order()[place]).norm() - mean, 2);
      }
      return std::sqrt(sum);
    };
    CHECK(roughness(shape) < 0.5 * roughness(rough.vertices));
  }

  TEST_CASE("flatten makes the surface flatter, and a flat one stays") {
    const Points shape = brushed(ball, Brush::flatten, 1.0, top - along, along * 2);
    CHECK(heights(shape).minCoeff() < -0.02);
    const Mesh sheet = nendo::test::grid(40, 10.0);
    const Vector3d middle = sheet.vertices.rowwise().mean();
    const Points same = brushed(sheet, Brush::flatten, 1.0, middle, along);
    CHECK((same - sheet.vertices).cwiseAbs().maxCoeff() < 1e-5);
  }

  TEST_CASE("twist turns a sheet about its normal, and keeps distances from the axis") {
    const Mesh sheet = nendo::test::grid(40, 10.0);
    const Vector3d middle = sheet.vertices.rowwise().mean();
    const Vector3d up = vertex_normals(sheet).rowwise().mean().normalized();
    // The fingertip goes up from the sheet, so that the axis stays.
    const Points shape = brushed(sheet, Brush::twist, 1.0, middle, up * 0.2);
    double largest = 0.0;
    for (Eigen::Index at = 0; at < shape.cols(); ++at) {
      const Vector3d before = sheet.vertices.col(at) - middle;
      const Vector3d after = shape.col(at) - middle;
      CHECK(std::abs(before.norm() - after.norm()) < 1e-4);
      CHECK(before.cross(after).dot(up) > -1e-4);
      if (before.norm() > 0.0)
        largest = std::max(largest, before.cross(after).norm() / before.squaredNorm());
    }
    CHECK(largest > 0.05); // about way / radius
    CHECK(largest < 0.11);
  }

  TEST_CASE("scale grows, and shrinks below 0") {
    const double whole = volume_of(ball, ball.vertices);
    CHECK(volume_of(ball, brushed(ball, Brush::scale, 1.0, top * 0.9, along * 0.5)) > whole);
    CHECK(volume_of(ball, brushed(ball, Brush::scale, -1.0, top * 0.9, along * 0.5)) < whole);
  }

  TEST_CASE("pinch gathers a sheet about the fingertip, keeps it flat, and below 0 spreads it") {
    const Mesh sheet = nendo::test::grid(60, 12.0);
    const Vector3d middle = sheet.vertices.rowwise().mean();
    const Vector3d up = vertex_normals(sheet).rowwise().mean().normalized();
    for (const double strength : {0.8, -0.4}) {
      CAPTURE(strength);
      // A way along the normal leaves the line where it is.
      const Points shape = brushed(sheet, Brush::pinch, strength, middle, 0.6 * up);
      CHECK((up.transpose() * (shape - sheet.vertices)).cwiseAbs().maxCoeff() < 1e-5);
      double nearer = 0.0, farther = 0.0;
      for (Eigen::Index v = 0; v < shape.cols(); ++v) {
        const double before = (sheet.vertices.col(v) - middle).norm();
        const double change = (shape.col(v) - middle).norm() - before;
        nearer = std::min(nearer, change);
        farther = std::max(farther, change);
        // Towards the line, and not about it.
        if (before > 1e-9)
          CHECK((shape.col(v) - middle).cross(sheet.vertices.col(v) - middle).norm() <
                1e-4 * before);
      }
      CHECK((strength > 0.0 ? nearer : -farther) < -0.02);
      CHECK((strength > 0.0 ? farther : -nearer) < 1e-5);
    }
  }

  TEST_CASE("a finger pulls as alone, whatever others brush elsewhere") {
    DeformerOptions options;
    options.supports = one_radius(2.0);
    Type2Deformer alone(ball.vertices, 1, 0.1, options);
    options.brushes.of_points = {Brush::inflate, Brush::pull};
    options.brushes.rings = std::make_shared<VertexRings>(ball, alone.layout());
    Type2Deformer both(ball.vertices, 2, 0.1, options);
    Points tips(3, 2);
    tips << -top, top;
    alone.begin(top);
    both.begin(tips);
    const Points ways = along.replicate(1, 2);
    alone.end_at(top + along);
    both.end_at(tips + ways);
    CHECK(both.fields().fields().size() == alone.fields().fields().size());
    Points by_one, by_both;
    alone.layout().unpack(alone.shape(), by_one);
    both.layout().unpack(both.shape(), by_both);
    for (Eigen::Index at = 0; at < by_one.cols(); ++at)
      if (ball.vertices(1, at) > 0.0) CHECK(by_one.col(at) == by_both.col(at));
    CHECK(by_one != by_both);
  }

  TEST_CASE("a stroke of brushes is a step that can be undone and redone") {
    DeformerOptions options;
    options.undo_bytes = 1U << 20;
    options.supports = one_radius(2.0);
    options.brushes.of_points = {Brush::inflate};
    options.brushes.rings = std::make_shared<VertexRings>(ball, BlockLayout(ball.vertices));
    Type2Deformer deformer(ball.vertices, 1, 0.1, options);
    const auto shape_of = [&] {
      Points shape;
      deformer.layout().unpack(deformer.shape(), shape);
      return shape;
    };
    deformer.begin(top);
    const Points end = top + along;
    nendo::test::RestraintCounts counts;
    {
      const nendo::test::Restraint restraint;
      deformer.end_at(end);
      counts = restraint.counts();
    }
    CHECK(counts.allocations == 0);
    CHECK(counts.locks == 0);
    const Points after = shape_of();
    deformer.go(HistoryMove::undo, top);
    CHECK(shape_of() == ball.vertices);
    deformer.go(HistoryMove::redo, top);
    CHECK(shape_of() == after);
  }

  TEST_CASE("a fingertip in the far leaves all alone and finite") {
    for (std::uint8_t number = 2; number < brush_count; ++number) {
      CAPTURE(name_of(static_cast<Brush>(number)));
      const auto brush = static_cast<Brush>(number);
      const Points shape = brushed(ball, brush, 1.0, top * 3, along);
      CHECK(shape == ball.vertices);
    }
  }
}

} // namespace brush_test
