// Distances along a surface, the fields that are made of them, and the deformers that apply them.

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/surface_deformer.hpp>
#include <nendo/deform/type2.hpp>

#include "support/test_meshes.hpp"

namespace surface_test {

using namespace nendo;
using namespace nendo::deform;
using Eigen::Index;
using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Two sheets, the second one `gap` above the first, with the same vertices.
Mesh two_sheets(double gap) {
  const Mesh one = test::grid(20, 10.0);
  Mesh both = one;
  const auto count = static_cast<std::uint32_t>(one.vertices.cols());
  both.vertices.conservativeResize(3, 2 * count);
  both.vertices.rightCols(count) = one.vertices.colwise() + Vector3d(0.0, 0.0, gap);
  for (std::size_t face = 0; face < one.face_count(); ++face) {
    for (auto at = one.face_starts[face]; at < one.face_starts[face + 1]; ++at)
      both.face_corners.push_back(one.face_corners[at] + count);
    both.face_starts.push_back(static_cast<std::uint32_t>(both.face_corners.size()));
  }
  return both;
}

SurfaceSetup setup_on(const Mesh& mesh) {
  SurfaceSetup setup;
  for (const Vector3d& place : {Vector3d(2.1, 2.3, 0.0), Vector3d(5.0, 5.0, 0.0),
                                Vector3d(7.4, 3.2, 0.0), Vector3d(3.0, 7.7, 0.0)})
    setup.points.push_back({nearest_position(mesh, place), 4.0});
  return setup;
}

struct Made {
  explicit Made(const Mesh& model, const SurfaceSetup& setup) : layout(model.vertices) {
    auto made = SurfaceField::make(model, layout, setup);
    REQUIRE(made);
    field = *std::move(made);
  }
  Points displaced(const Points& vectors) const {
    SurfaceField::Coefficients coefficients(field->point_count());
    field->solve(vectors, coefficients);
    BlockShape shape = layout.pack();
    field->displace(coefficients, layout.pack(), shape);
    Points vertices;
    layout.unpack(shape, vertices);
    return vertices;
  }
  BlockLayout layout;
  std::shared_ptr<const SurfaceField> field;
};

/// A model whose surface points pull in type 2.
struct Stroked {
  explicit Stroked(const Mesh& model) : mesh(model), made(mesh, setup_on(mesh)), tips(3, 4) {
    DeformerOptions options;
    options.undo_bytes = std::size_t{1} << 22;
    shape = std::make_unique<SculptedShape>(made.layout, options, nullptr);
    deformer = std::make_unique<Type2Deformer>(*shape, made.field);
    for (Index i = 0; i < 4; ++i)
      tips.col(i) = setup_on(mesh).points[static_cast<std::size_t>(i)].position.in(mesh.vertices);
  }
  Points vertices() const {
    Points points;
    made.layout.unpack(deformer->shape(), points);
    return points;
  }
  /// Goes there in so many steps, by ways that a generator chooses.
  void go_to(const Points& ends, int steps, std::mt19937& random);

  Mesh mesh;
  Made made;
  Points tips;
  std::unique_ptr<SculptedShape> shape;
  std::unique_ptr<Type2Deformer> deformer;
};

Points random_vectors(Index points, std::mt19937& random) {
  Points vectors(3, points);
  for (double& coordinate : vectors.reshaped())
    coordinate = static_cast<double>(random() % 2001) / 1000.0 - 1.0;
  return vectors;
}

void Stroked::go_to(const Points& ends, int steps, std::mt19937& random) {
  for (int step = 1; step < steps; ++step) {
    const double part = static_cast<double>(step) / steps;
    const Points way = tips + part * (ends - tips) + 0.2 * random_vectors(tips.cols(), random);
    REQUIRE(deformer->stroke_to(way).status == FieldStatus::ok);
  }
  REQUIRE(deformer->end_at(ends).status == FieldStatus::ok);
  tips = ends;
}

} // namespace

TEST_SUITE("surface") {
  TEST_CASE("on a plane a distance is the straight one, or a few per cent more") {
    const Mesh mesh = test::grid(40, 10.0);
    const SurfaceGraph graph(mesh);
    const SurfacePosition from = nearest_position(mesh, {3.21, 4.56, 0.0});
    const Eigen::VectorXd distances = graph.distances(from, infinity);
    const Eigen::VectorXd straight =
        (mesh.vertices.colwise() - from.in(mesh.vertices)).colwise().norm();
    CHECK((distances - straight).minCoeff() > -1e-12);
    for (Index v = 0; v < distances.size(); ++v)
      if (straight[v] > 2.0) CHECK(distances[v] <= 1.10 * straight[v]);
    const Eigen::VectorXd near = graph.distances(from, 2.0);
    for (Index v = 0; v < near.size(); ++v)
      CHECK(near[v] == (distances[v] <= 2.0 ? distances[v] : infinity));
  }

  TEST_CASE("round a sphere the way is along it, and no way leads to another part") {
    const Mesh ball = test::sphere(60, 120, 1.0);
    const Eigen::VectorXd distances =
        SurfaceGraph(ball).distances(SurfacePosition::at_vertex(0), infinity);
    CHECK(distances[1] == doctest::Approx(3.14159265).epsilon(0.01)); // pole to pole
    const Mesh sheets = two_sheets(0.01);
    const SurfaceGraph graph(sheets);
    const Eigen::VectorXd of_first = graph.distances(SurfacePosition::at_vertex(0), infinity);
    const Index half = sheets.vertices.cols() / 2;
    CHECK(of_first.head(half).maxCoeff() < infinity);
    CHECK(of_first.tail(half).minCoeff() == infinity);
    const auto parts = graph.parts();
    CHECK(parts.front() == 0);
    CHECK(parts.back() == 1);
  }

  TEST_CASE("the nearest place of a surface is the foot of the point") {
    const Mesh mesh = test::grid(7, 10.0);
    const SurfacePosition place = nearest_position(mesh, {3.3, 8.1, 2.0});
    CHECK((place.in(mesh.vertices) - Vector3d(3.3, 8.1, 0.0)).norm() < 1e-12);
    const SurfacePosition corner = nearest_position(mesh, {-4.0, -1.0, 1.0});
    CHECK(corner.in(mesh.vertices).norm() < 1e-12);
  }

  TEST_CASE("a field is the dense solution in double, and leads each point to its goal") {
    const Mesh mesh = two_sheets(0.1);
    const SurfaceSetup setup = setup_on(mesh);
    const Made made(mesh, setup);
    std::mt19937 random(1);
    const Points vectors = random_vectors(4, random);
    const SurfaceGraph graph(mesh);
    Eigen::MatrixXd functions(mesh.vertices.cols(), 4), at_points(4, 4);
    for (Index j = 0; j < 4; ++j) {
      const auto distances =
          graph.distances(setup.points[static_cast<std::size_t>(j)].position, 4.0);
      for (Index v = 0; v < distances.size(); ++v)
        functions(v, j) = wendland(Wendland::c2, distances[v] / 4.0);
    }
    for (Index i = 0; i < 4; ++i) {
      at_points.row(i).setZero();
      const SurfacePosition& place = setup.points[static_cast<std::size_t>(i)].position;
      for (std::size_t k = 0; k < 3; ++k)
        at_points.row(i) += place.weights[k] * functions.row(place.corners[k]);
    }
    const Points dense =
        mesh.vertices + (functions * at_points.fullPivLu().solve(vectors.transpose())).transpose();
    const Points moved = made.displaced(vectors);
    CHECK((moved - dense).cwiseAbs().maxCoeff() < 1e-5);
    for (Index i = 0; i < 4; ++i) {
      const SurfacePosition& place = setup.points[static_cast<std::size_t>(i)].position;
      CHECK((place.in(moved)-place.in(mesh.vertices) - vectors.col(i)).norm() < 1e-5);
    }
    const Index half = mesh.vertices.cols() / 2; // the other sheet is near, but not on the way
    CHECK(moved.rightCols(half) == mesh.vertices.rightCols(half));
    const Eigen::MatrixXf weights = made.field->weights();
    CHECK((mesh.vertices + vectors * weights.cast<double>() - moved).cwiseAbs().maxCoeff() < 1e-5);
  }

  TEST_CASE("a pinned vertex and a masked one stay, whatever the others do") {
    const Mesh mesh = test::grid(20, 10.0);
    SurfaceSetup setup = setup_on(mesh);
    setup.points.push_back({SurfacePosition::at_vertex(110), 3.0}); // the pin
    setup.mask = Eigen::VectorXd::Ones(mesh.vertices.cols());
    setup.mask[200] = 0.0;
    setup.mask[201] = 0.5;
    const Made made(mesh, setup);
    SurfaceSetup open = setup;
    open.mask.resize(0);
    const Made unmasked(mesh, open);
    std::mt19937 random(2);
    double most = 0.0;
    for (int pose = 0; pose < 10'000; ++pose) {
      Points vectors = random_vectors(5, random);
      vectors.col(4).setZero();
      const Points moved = made.displaced(vectors);
      most = std::max(most, (moved.col(110) - mesh.vertices.col(110)).norm());
      CHECK(moved.col(200) == mesh.vertices.col(200));
      if (pose > 20) continue;
      const Points free = unmasked.displaced(vectors);
      CHECK(
          (moved.col(201) - mesh.vertices.col(201) - 0.5 * (free.col(201) - mesh.vertices.col(201)))
              .norm() < 1e-5);
    }
    CHECK(most < 1e-6 * made.layout.diagonal());
    CHECK(made.displaced(Points::Zero(3, 5)) == mesh.vertices);
  }

  TEST_CASE("a part turns with its points, and one without points goes with the surface") {
    const Mesh mesh = two_sheets(0.5);
    SurfaceSetup setup = setup_on(mesh);
    setup.points.push_back({nearest_position(mesh, {5.0, 2.0, 0.0}), 3.0});
    setup.points[4].position = SurfacePosition::at_vertex(100);
    const auto half = static_cast<std::uint32_t>(mesh.vertices.cols() / 2);
    std::vector<std::uint32_t> others;
    for (std::uint32_t vertex = half; vertex < 2 * half; ++vertex)
      others.push_back(vertex);
    setup.parts = {{others, {0, 1, 2, 3}, true}};
    const Made affine(mesh, setup);
    // All points are in one plane, so that a shift and a turn in the plane are what they determine.
    Eigen::Isometry3d move = Eigen::Isometry3d::Identity();
    move.rotate(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()));
    move.translation() = Vector3d(0.2, -0.1, 0.4);
    Points vectors = Points::Zero(3, 5);
    for (Index i = 0; i < 4; ++i) {
      const Vector3d at = setup.points[static_cast<std::size_t>(i)].position.in(mesh.vertices);
      vectors.col(i) = move * at - at;
    }
    const Points moved = affine.displaced(vectors);
    for (const std::uint32_t vertex : others)
      CHECK((moved.col(vertex) - move * Vector3d(mesh.vertices.col(vertex))).norm() < 2e-5);
    setup.parts = {{others, {}, true}};
    const Points follows = Made(mesh, setup).displaced(vectors);
    const std::uint32_t below = 5 * 21 + 5; // the nearest of vertex half + below
    CHECK((follows.col(half + below) - mesh.vertices.col(half + below) - follows.col(below) +
           mesh.vertices.col(below))
              .norm() < 1e-5);
    setup.parts = {{others, {1}, false}};
    const Points mean = Made(mesh, setup).displaced(vectors);
    for (const std::uint32_t vertex : others)
      CHECK((mean.col(vertex) - mesh.vertices.col(vertex) - vectors.col(1)).norm() < 2e-5);
  }

  TEST_CASE("points that are too near to each other are refused, by their numbers") {
    const Mesh mesh = test::grid(20, 10.0);
    SurfaceSetup setup = setup_on(mesh);
    setup.points.push_back(setup.points[2]);
    setup.points.back().radius = 3.9999;
    const BlockLayout layout(mesh.vertices);
    const auto made = SurfaceField::make(mesh, layout, setup);
    REQUIRE_FALSE(made);
    CHECK(made.error().code == Errc::bad_input);
    CHECK(made.error().message.find("points 2 and 4") == 0);
  }

  TEST_CASE("commits, undos, redos and resets lead back and forth, bit for bit") {
    const Mesh mesh = test::grid(20, 10.0);
    const Made made(mesh, setup_on(mesh));
    DeformerOptions options;
    options.undo_bytes = std::size_t{1} << 22;
    SculptedShape shape(made.layout, options, nullptr);
    SurfaceDeformer deformer(shape, made.field);
    BlockShape out;
    const auto vertices = [&] {
      Points points;
      made.layout.unpack(out, points);
      return points;
    };
    Points tips(3, 4);
    for (Index i = 0; i < 4; ++i)
      tips.col(i) = setup_on(mesh).points[static_cast<std::size_t>(i)].position.in(mesh.vertices);
    CHECK(deformer.apply(tips, out) == FieldStatus::singular); // nothing is held
    CHECK(vertices() == mesh.vertices);
    REQUIRE(deformer.grab(tips) == FieldStatus::ok);
    std::mt19937 random(3);
    std::vector<Points> shapes{mesh.vertices};
    for (int step = 0; step < 4; ++step) {
      tips += 0.3 * random_vectors(4, random);
      REQUIRE(deformer.apply(tips, out) == FieldStatus::ok);
      const Points shown = vertices();
      REQUIRE(deformer.commit(tips) == FieldStatus::ok);
      REQUIRE(deformer.apply(tips, out) == FieldStatus::ok);
      CHECK(vertices() == shown); // a commit does not move anything
      shapes.push_back(shown);
    }
    for (std::size_t step = 4; step-- > 0;) {
      REQUIRE(deformer.go(HistoryMove::undo, tips) == FieldStatus::ok);
      REQUIRE(deformer.apply(tips, out) == FieldStatus::ok);
      CHECK(vertices() == shapes[step]);
    }
    REQUIRE(deformer.go(HistoryMove::redo, tips) == FieldStatus::ok);
    REQUIRE(deformer.apply(tips, out) == FieldStatus::ok);
    CHECK(vertices() == shapes[1]);
    REQUIRE(deformer.go(HistoryMove::reset, tips) == FieldStatus::ok);
    REQUIRE(deformer.apply(tips, out) == FieldStatus::ok);
    CHECK(vertices() == mesh.vertices);
    Points wrong = tips;
    wrong(1, 2) = std::nan("");
    CHECK(deformer.apply(wrong, out) == FieldStatus::not_finite);
    CHECK(vertices() == mesh.vertices);
    wrong(1, 2) = 1e90;
    CHECK(deformer.apply(wrong, out) == FieldStatus::not_finite);
    CHECK(vertices().allFinite());
  }

  TEST_CASE("a stroke of type 2 leads where type 1 leads, whatever the way and its steps") {
    for (const int steps : {1, 7, 20000}) { // of which the last ones are below float's resolution
      std::mt19937 random(5);
      Stroked one(test::grid(20, 10.0));
      REQUIRE(one.deformer->begin(one.tips) == FieldStatus::ok);
      const Points ends = one.tips + 0.4 * random_vectors(4, random);
      SculptedShape rest(one.made.layout, {}, nullptr);
      SurfaceDeformer type1(rest, one.made.field);
      BlockShape wanted;
      REQUIRE(type1.grab(one.tips) == FieldStatus::ok);
      REQUIRE(type1.apply(ends, wanted) == FieldStatus::ok);
      Points vertices;
      one.made.layout.unpack(wanted, vertices);
      one.go_to(ends, steps, random);
      CHECK(one.vertices() == vertices);
      CHECK((vertices - one.mesh.vertices).cwiseAbs().maxCoeff() > 0.1);
    }
  }

  TEST_CASE("strokes of type 2 add up, and what touches another side moves only its own") {
    const Mesh both = two_sheets(1e-3);
    Stroked one(both);
    std::mt19937 random(6);
    Points wanted = both.vertices;
    for (int stroke = 0; stroke < 3; ++stroke) {
      REQUIRE(one.deformer->begin(one.tips) == FieldStatus::ok);
      CHECK(one.shape->undo_steps() == static_cast<std::size_t>(stroke));
      const Points ends = one.tips + 0.3 * random_vectors(4, random);
      wanted += one.made.displaced(ends - one.tips) - both.vertices;
      one.go_to(ends, 50, random);
      CHECK((one.vertices() - wanted).cwiseAbs().maxCoeff() < 1e-5);
    }
    const Index sheet = both.vertices.cols() / 2;
    CHECK(one.vertices().rightCols(sheet) == both.vertices.rightCols(sheet));
    CHECK((one.vertices() - both.vertices).cwiseAbs().maxCoeff() > 0.2);
  }

  TEST_CASE("strokes of type 2 are undone, done again and reset, bit for bit") {
    Stroked one(test::grid(20, 10.0));
    std::mt19937 random(7);
    std::vector<Points> shapes{one.mesh.vertices};
    for (int stroke = 0; stroke < 4; ++stroke) {
      REQUIRE(one.deformer->begin(one.tips) == FieldStatus::ok);
      one.go_to(one.tips + 0.3 * random_vectors(4, random), 9, random);
      shapes.push_back(one.vertices());
    }
    for (std::size_t stroke = 4; stroke-- > 0;) {
      REQUIRE(one.deformer->go(HistoryMove::undo, one.tips) == FieldStatus::ok);
      CHECK(one.vertices() == shapes[stroke]);
      REQUIRE(one.deformer->stroke_to(one.tips).status == FieldStatus::ok);
      CHECK(one.vertices() == shapes[stroke]); // who holds still moves nothing
    }
    REQUIRE(one.deformer->go(HistoryMove::redo, one.tips) == FieldStatus::ok);
    CHECK(one.vertices() == shapes[1]);
    one.deformer->release(true);
    REQUIRE(one.deformer->go(HistoryMove::reset, one.tips) == FieldStatus::ok);
    CHECK(one.vertices() == one.mesh.vertices);
    Points wrong = one.tips;
    for (const double far : {std::nan(""), 1e90}) {
      wrong(1, 2) = far;
      CHECK(one.deformer->stroke_to(wrong).status == FieldStatus::not_finite);
      CHECK(one.vertices() == one.mesh.vertices);
      CHECK_FALSE(one.deformer->along()->is_moved());
    }
    one.go_to(one.tips + 0.3 * random_vectors(4, random), 3, random);
    CHECK(one.vertices().allFinite());
    CHECK(one.vertices() != one.mesh.vertices);
  }

  TEST_CASE("what a step of type 2 reports leads from the previous shape to its own") {
    Stroked one(test::grid(20, 10.0));
    std::mt19937 random(8);
    REQUIRE(one.deformer->begin(one.tips) == FieldStatus::ok);
    const SurfaceField::Terms terms = one.made.field->terms();
    Points followed = one.mesh.vertices;
    SurfaceMove move;
    for (int step = 0; step < 20; ++step) {
      const Points way = one.tips + 0.3 * random_vectors(4, random);
      REQUIRE(one.deformer->stroke_to(way).status == FieldStatus::ok);
      CHECK(one.deformer->fields().fields().empty());
      one.deformer->along()->write_move(move);
      REQUIRE(move.field == one.made.field->number());
      for (std::size_t place = 0; place + 1 < terms.starts.size(); ++place)
        for (std::uint32_t at = terms.starts[place]; at < terms.starts[place + 1]; ++at)
          followed.col(one.made.layout.order()[place]) +=
              one.made.layout.unit() *
              (terms.values[at] * move.vectors.col(terms.of_vector[at])).cast<double>();
      CHECK((one.vertices() - followed).cwiseAbs().maxCoeff() < 1e-5);
    }
  }
}

} // namespace surface_test
