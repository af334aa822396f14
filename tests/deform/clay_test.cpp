#include <nendo/deform/clay.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/triangles.hpp>

#include "reference/icosphere.hpp"
#include "support/contact_parts.hpp"
#include "support/fields.hpp"
#include "support/nasty_meshes.hpp"
#include "support/restraint.hpp"
#include "support/self_intersections.hpp"
#include "support/test_meshes.hpp"

namespace clay_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using nendo::test::cone;
using nendo::test::moved;
using nendo::test::pinch;
using Parts = std::vector<ContactPart>;

namespace {

/// A fingertip that points down, with its lowest place in the origin; millimetres.
Parts finger() {
  return {cone({0, 0, 8}, {0, 0, 40}, 8.0, 9.0)};
}

double mean_edge(const Mesh& mesh) {
  return std::sqrt(4.0 / std::sqrt(3.0) * 4.0 * std::numbers::pi * 30.0 * 30.0 /
                   static_cast<double>(mesh.face_count()));
}

Vector3d middle_of(const Mesh& mesh) {
  return mesh.vertices.rowwise().mean();
}

/// A ball of clay with a radius of 30 mm.
struct Ball {
  explicit Ball(ClayOptions options = {}, std::size_t bodies = 1, int level = 4,
                DeformerOptions history = {}, std::size_t parts_per_body = 1)
      : mesh(nendo::reference::icosphere(level, 30.0)), shape(mesh.vertices, history),
        clay(shape, corners_of_triangles(mesh), bodies, parts_per_body, options) {}

  /// Moves the body from where it is along a straight way, in `calls` calls.
  ClayReport go(Parts& parts, const Vector3d& by, int calls) {
    ClayReport worst;
    for (int call = 0; call < calls; ++call) {
      parts = moved(parts, Vector3d(by / calls));
      const ClayReport& report = clay.press_to(parts);
      CHECK(report.status == FieldStatus::ok);
      worst.penetration_mm = std::max(worst.penetration_mm, report.penetration_mm);
      worst.passes = std::max(worst.passes, report.passes);
      worst.sub_steps = std::max(worst.sub_steps, report.sub_steps);
      worst.distances = std::max(worst.distances, report.distances);
      worst.remaining_path_mm = std::max(worst.remaining_path_mm, report.remaining_path_mm);
      worst.volume_change = std::max(worst.volume_change, std::abs(report.volume_change));
      worst.held = std::max(worst.held, report.held);
      worst.carried_mm += report.carried_mm;
      worst.turned_rad += report.turned_rad;
    }
    return worst;
  }
  Mesh now() const {
    Mesh result = mesh;
    shape.layout().unpack(clay.shape(), result.vertices);
    return result;
  }
  /// How deep the deepest vertex is.
  double depth(const Parts& parts) const {
    double least = 0.0;
    const Mesh present = now();
    for (const auto vertex : present.vertices.colwise())
      least = std::min(least, nendo::test::sampled_distance(parts, vertex));
    return -least;
  }

  Mesh mesh;
  SculptedShape shape;
  ClayDeformer clay;
};

} // namespace

TEST_SUITE("clay") {
  TEST_CASE("a body that does not move, such as a table, only holds against another") {
    ClayOptions options;
    options.still_bodies = 1;
    Ball ball(options, 2);
    ContactPart table;
    table.corner_count = 3;
    table.corners = {Vector3d(-200, -200, -40), Vector3d(200, -200, -40), Vector3d(0, 300, -40)};
    table.radii = {10.0, 10.0, 10.0};
    Parts parts = moved(finger(), Vector3d(0.0, 0.0, 35.0));
    parts.push_back(table);
    REQUIRE(is_solved(ball.clay.begin(parts)));
    const auto lower = [&](double by) {
      for (int call = 0; call < 40; ++call) {
        parts[0] = moved({parts[0]}, Vector3d(0.0, 0.0, -by / 40.0))[0];
        CHECK(is_solved(ball.clay.press_to(parts).status));
        for (const ClayContact& contact : ball.clay.contacts())
          CHECK(contact.body == 0);
      }
    };
    lower(2.0); // not yet at the ball
    CHECK(ball.now().vertices == ball.mesh.vertices);
    lower(50.0);
    const Mesh pressed = ball.now();
    CHECK(pressed.vertices.row(2).minCoeff() > -30.1);
    CHECK(std::abs(volume_of(pressed) / volume_of(ball.mesh) - 1.0) < 0.0015);
    Ball free; // of a table
    Parts alone = moved(finger(), Vector3d(0.0, 0.0, 33.0));
    REQUIRE(is_solved(free.clay.begin(alone)));
    free.go(alone, {0.0, 0.0, -50.0}, 40);
    CHECK(free.now().vertices.row(2).minCoeff() < -30.5);
    lower(-60.0);
    for (int call = 0; call < 90; ++call)
      ball.clay.press_to(parts);
    const Mesh left = ball.now();
    CHECK_FALSE(ball.clay.press_to(parts).is_moved);
    CHECK(ball.now().vertices == left.vertices);
  }

  TEST_CASE("a finger pushes the surface out of itself and folds nothing") {
    Ball ball;
    Parts parts = moved(finger(), Vector3d(0, 0, 32));
    ball.clay.begin(parts);
    CHECK(ball.go(parts, {0, 0, -1}, 3).passes == 0);
    const ClayReport down = ball.go(parts, {0, 0, -13}, 26);
    CHECK(down.penetration_mm < 0.05 * mean_edge(ball.mesh));
    CHECK(down.penetration_mm <= 0.021);
    CHECK(ball.depth(parts) < 1e-3);
    CHECK(nendo::test::count_self_intersections(ball.now()) == 0);
    // The dent is as deep as the finger has gone.
    const Mesh dented = ball.now();
    double lowest = 30.0;
    for (const auto vertex : dented.vertices.colwise())
      if (vertex.z() > 0.0 && vertex.head<2>().norm() < 2.0) lowest = std::min(lowest, vertex.z());
    CHECK(lowest < 18.3);
    CHECK(lowest > 17.0);
    const ClayReport side = ball.go(parts, {10, 0, 0}, 20);
    CHECK(side.penetration_mm <= 0.021);
    CHECK(ball.depth(parts) < 1e-3);
    CHECK(nendo::test::count_self_intersections(ball.now()) == 0);
  }

  TEST_CASE("the volume comes back where nothing touches") {
    Ball ball;
    const double whole = volume_of(ball.mesh);
    Parts parts = moved(finger(), Vector3d(0, 0, 31));
    ball.clay.begin(parts);
    for (int tick = 0; tick < 60; ++tick) {
      const ClayReport report = ball.go(parts, {0, 0, -0.25}, 1);
      const double change = volume_of(ball.now()) / whole - 1.0;
      CHECK(std::abs(change) < 5e-4);
      CHECK(std::abs(change - ball.clay.report().volume_change) < 5e-4);
      CHECK(report.volume_change < 5e-4);
    }
    ball.go(parts, {0, 0, 20}, 40);
    CHECK(std::abs(volume_of(ball.now()) / whole - 1.0) < 1e-4);
    Ball open({.keeps_volume = false});
    parts = moved(finger(), Vector3d(0, 0, 31));
    open.clay.begin(parts);
    open.go(parts, {0, 0, -15}, 60);
    CHECK(volume_of(open.now()) / whole - 1.0 < -0.02);
  }

  TEST_CASE("models of a few vertices keep their volume, however many of them are touched") {
    Mesh tetrahedron;
    tetrahedron.vertices.resize(3, 4);
    tetrahedron.vertices << 30, 30, -30, -30, 30, -30, 30, -30, 30, -30, -30, 30;
    for (const auto& face : {std::array{0U, 1U, 2U}, {0U, 3U, 1U}, {0U, 2U, 3U}, {1U, 3U, 2U}})
      nendo::test::add_face(tetrahedron, {face[0], face[1], face[2]});
    const auto box = [](const Vector3d& sides) {
      Mesh mesh = nendo::test::cube_of_cells(1);
      mesh.vertices = sides.asDiagonal() * (mesh.vertices.array() - 0.5).matrix();
      return mesh;
    };
    for (const Mesh& mesh : {tetrahedron, box({40, 40, 40}), box({60, 60, 6}), box({8, 80, 8}),
                             nendo::test::cube_of_cells(1, true)}) {
      const double size = mesh.vertices.maxCoeff() - mesh.vertices.minCoeff();
      Mesh clay = mesh;
      clay.vertices *= std::max(1.0, 40.0 / size);
      const double volume = volume_of(clay);
      REQUIRE(volume > 0.0);
      for (const bool lies_on_table : {true, false}) {
        SculptedShape shape(clay.vertices, {});
        ClayOptions options;
        options.lies_on_table = lies_on_table;
        ClayDeformer deformer(shape, corners_of_triangles(clay), 2, 1, options);
        Mesh now = clay;
        // Two fingers press each corner in turn, the whole way through, in strokes of their own.
        for (Eigen::Index corner = 0; corner < clay.vertices.cols(); ++corner) {
          const Vector3d at = now.vertices.col(corner);
          const Vector3d out = at.normalized();
          Parts parts{cone(at + 12.0 * out, at + 40.0 * out, 8.0, 9.0),
                      cone(-at - 12.0 * out, -at - 40.0 * out, 8.0, 9.0)};
          REQUIRE(is_solved(deformer.begin(parts)));
          for (int call = 0; call < 30; ++call) {
            const double inwards = call < 15 ? -1.5 : 1.5;
            parts[0] = moved({parts[0]}, Vector3d(inwards * out))[0];
            parts[1] = moved({parts[1]}, Vector3d(-inwards * out))[0];
            CHECK(is_solved(deformer.press_to(parts).status));
            shape.layout().unpack(deformer.shape(), now.vertices);
            // The clay's surface has the triangles of the rest shape. By their present positions,
            // bent quads may be divided along the other diagonal.
            const Mesh surface = in_shape(clay, now.vertices);
            CHECK(volume_of(surface) == doctest::Approx(volume).epsilon(5e-4));
          }
        }
        CHECK((now.vertices - clay.vertices).cwiseAbs().maxCoeff() > 1.0);
      }
    }
  }

  TEST_CASE("a plate does not press a model of a few vertices through the table") {
    const auto plate = [](double height) {
      ContactPart part;
      part.corner_count = 3;
      part.corners = {Vector3d(-200, height, -200), Vector3d(0, height, 300),
                      Vector3d(200, height, -200)};
      part.radii = {10.0, 10.0, 10.0};
      part.frame = Eigen::Translation3d(0.0, height, 0.0);
      return part;
    };
    for (const bool quads : {false, true}) {
      Mesh cube = nendo::test::cube_of_cells(1, quads);
      cube.vertices *= 40.0; // its floor is at a height of 0, where the table's surface is
      const double volume = volume_of(cube);
      SculptedShape shape(cube.vertices, {});
      ClayOptions options;
      options.still_bodies = 1;
      ClayDeformer deformer(shape, corners_of_triangles(cube), 2, 1, options);
      REQUIRE(is_solved(deformer.begin(Parts{plate(51.0), plate(-10.0)})));
      Points now;
      for (int call = 1; call <= 15; ++call) {
        CHECK(is_solved(deformer.press_to(Parts{plate(51.0 - call), plate(-10.0)}).status));
        shape.layout().unpack(deformer.shape(), now);
        CHECK(now.row(1).minCoeff() > -0.05);
        CHECK(volume_of(in_shape(cube, now)) == doctest::Approx(volume).epsilon(5e-4));
      }
      CHECK(now.row(1).maxCoeff() < 27.0); // the plate's surface is at 26
    }
  }

  TEST_CASE("without the volume, what is out of reach keeps its bits") {
    Ball ball({.radius_mm = 20.0, .keeps_volume = false});
    Parts parts = moved(finger(), Vector3d(0, 0, 31));
    ball.clay.begin(parts);
    ball.go(parts, {0, 0, -8}, 8);
    const Mesh now = ball.now();
    Eigen::Index kept = 0;
    for (Eigen::Index at = 0; at < now.vertices.cols(); ++at)
      if (ball.mesh.vertices(2, at) < 0.0) {
        CHECK(now.vertices.col(at) == ball.mesh.vertices.col(at));
        ++kept;
      }
    CHECK(kept > 1000);
  }

  TEST_CASE("a fast hand does not pass through a thin part") {
    // A plate of 2 mm. Its upper side has z > 0.
    Mesh plate = nendo::reference::icosphere(5, 40.0);
    plate.vertices.row(2) = plate.vertices.row(2).unaryExpr(
        [](double z) { return (z > 0.0 ? 1.0 : -1.0) * std::min(1.0, std::abs(z)); });
    SculptedShape shape(plate.vertices, {});
    ClayDeformer clay(shape, {}, 1, 1, {.radius_mm = 20.0, .max_passes = 200});
    Parts parts = moved(finger(), Vector3d(0, 0, 3));
    clay.begin(parts);
    for (int tick = 0; tick < 3; ++tick) { // 1 m/s at 90 Hz
      parts = moved(parts, Vector3d(0, 0, -11.1));
      CHECK(clay.press_to(parts).remaining_path_mm == 0.0);
    }
    Points now;
    shape.layout().unpack(clay.shape(), now);
    // Nothing is left behind, above the fingertip's lowest place.
    const double tip = parts[0].corners[0].z() - 8.0;
    int below = 0;
    for (const auto vertex : now.colwise()) {
      CHECK(nendo::test::sampled_distance(parts, vertex) > -1e-3);
      if (vertex.head<2>().norm() > 4.0) continue;
      CHECK(vertex.z() < tip + 1.5);
      ++below;
    }
    CHECK(below > 10);
  }

  TEST_CASE("a short budget shortens the hand's step and nothing else") {
    Ball ball({.max_passes = 1});
    Parts parts = moved(finger(), Vector3d(0, 0, 30.5));
    ball.clay.begin(parts);
    const ClayReport jump = ball.go(parts, {0, 0, -14}, 1);
    CHECK(jump.sub_steps == 1);
    CHECK(jump.remaining_path_mm > 10.0);
    CHECK(jump.penetration_mm <= 0.021);
    double remaining_mm = jump.remaining_path_mm;
    for (int call = 0; call < 20 && remaining_mm > 0.0; ++call) {
      const ClayReport& report = ball.clay.press_to(parts);
      CHECK(report.remaining_path_mm < remaining_mm);
      CHECK(report.penetration_mm <= 0.021);
      remaining_mm = report.remaining_path_mm;
    }
    CHECK(remaining_mm == 0.0);
    CHECK(ball.depth(parts) < 1e-3);
    CHECK(nendo::test::count_self_intersections(ball.now()) == 0);
  }

  TEST_CASE("a hand far away jumps, and touches nothing") {
    Ball ball;
    Parts parts = moved(finger(), Vector3d(500, 0, 0));
    ball.clay.begin(parts);
    const ClayReport far = ball.go(parts, {0, 500, 0}, 1);
    CHECK(far.sub_steps == 0);
    CHECK(far.remaining_path_mm == 0.0);
    CHECK(ball.now().vertices == ball.mesh.vertices);
  }

  TEST_CASE("friction takes the surface along, and slides without") {
    const auto dragged = [](double friction) {
      Ball ball({.friction = friction, .keeps_volume = false});
      Parts parts = moved(finger(), Vector3d(0, 0, 30.5));
      ball.clay.begin(parts);
      ball.go(parts, {0, 0, -4}, 16);
      const Mesh before = ball.now();
      Eigen::Index under = 0;
      for (Eigen::Index at = 0; at < before.vertices.cols(); ++at)
        if ((before.vertices.col(at) - Vector3d(0, 0, 26)).norm() <
            (before.vertices.col(under) - Vector3d(0, 0, 26)).norm())
          under = at;
      ball.go(parts, {2, 0, 0}, 20);
      return Vector3d(ball.now().vertices.col(under) - before.vertices.col(under)).x();
    };
    CHECK(dragged(1.0) > 1.5);
    CHECK(std::abs(dragged(0.0)) < 0.5);
    CHECK(dragged(0.2) < dragged(1.0));
  }

  TEST_CASE("clay on a table is dented, and clay on nothing goes away as it is") {
    for (const bool lies_on_table : {true, false}) {
      Ball ball({.keeps_volume = false, .lies_on_table = lies_on_table});
      Parts parts = moved(finger(), Vector3d(0, 0, 31));
      ball.clay.begin(parts);
      const ClayReport gone = ball.go(parts, {0, 0, -11}, 22);
      CHECK(ball.depth(parts) < 1e-3);
      const Mesh now = ball.now();
      const Vector3d middle = middle_of(now);
      const double dent = 30.0 - (now.vertices.colwise() - middle).colwise().norm().minCoeff();
      if (lies_on_table) {
        CHECK(gone.carried_mm == 0.0);
        CHECK(dent > 8.0);
      } else {
        CHECK(gone.carried_mm > 9.0);
        CHECK(middle.z() < -9.0);
        CHECK(dent < 1.0);
      }
    }
  }

  TEST_CASE("two fingers take clay along that lies on nothing") {
    Ball ball({.lies_on_table = false}, 1, 4, {}, 2);
    double gap = 62.0;
    const auto close_to = [&](double to, int calls) {
      const double from = gap;
      for (int call = 1; call <= calls; ++call) {
        gap = from + (to - from) * call / calls;
        ball.clay.press_to(pinch(gap, {-20, 0, 0}));
      }
    };
    ball.clay.begin(pinch(gap, {-20, 0, 0}));
    close_to(54.0, 20);
    const Vector3d before = middle_of(ball.now());
    CHECK(before.norm() < 1.0); // both sides yield alike
    Parts parts = pinch(gap, {-20, 0, 0});
    ball.go(parts, {0, 25, 10}, 40);
    const Vector3d by = middle_of(ball.now()) - before;
    CHECK((by - Vector3d(0, 25, 10)).norm() < 3.0);
    // They turn it.
    const Eigen::Index east = [&] {
      Eigen::Index at = 0;
      ball.now().vertices.row(0).maxCoeff(&at);
      return at;
    }();
    const Vector3d east_before = ball.now().vertices.col(east) - middle_of(ball.now());
    for (int call = 1; call <= 30; ++call)
      ball.clay.press_to(moved(parts, Eigen::Translation3d(0, 25, 10) *
                                          Eigen::AngleAxisd(0.02 * call, Vector3d::UnitZ()) *
                                          Eigen::Translation3d(0, -25, -10)));
    const Vector3d east_after = ball.now().vertices.col(east) - middle_of(ball.now());
    const double turned =
        std::atan2(east_after.y(), east_after.x()) - std::atan2(east_before.y(), east_before.x());
    CHECK(turned == doctest::Approx(0.6).epsilon(0.2));
    CHECK(nendo::test::count_self_intersections(ball.now()) == 0);
  }

  TEST_CASE("two fingers that close grab, pull, and release when they open") {
    Ball ball({.radius_mm = 18.0}, 1, 5, {}, 2);
    double gap = 60.0;
    const auto move_to = [&](double to, int calls) {
      std::size_t held = 0;
      const double from = gap;
      for (int call = 1; call <= calls; ++call) {
        gap = from + (to - from) * call / calls;
        const ClayReport& report = ball.clay.press_to(pinch(gap, {22, 0, 0}));
        CHECK(std::abs(report.volume_change) < 1.5e-3);
        held = report.held;
      }
      return held;
    };
    ball.clay.begin(pinch(gap, {22, 0, 0}));
    CHECK(move_to(16.0, 60) > 4);
    // Tremor does not release.
    std::mt19937 random(43);
    std::uniform_real_distribution<double> tremor(-0.2, 0.2);
    for (int tick = 0; tick < 100; ++tick) {
      const Vector3d by(tremor(random), tremor(random), tremor(random));
      CHECK(ball.clay.press_to(pinch(gap + tremor(random), Vector3d(22, 0, 0) + by)).held > 4);
    }
    const double before = ball.now().vertices.row(0).maxCoeff();
    Parts parts = pinch(gap, {22, 0, 0});
    const ClayReport pulled = ball.go(parts, {15, 0, 0}, 60);
    CHECK(pulled.held > 4);
    CHECK(pulled.volume_change < 1.5e-3);
    CHECK(ball.now().vertices.row(0).maxCoeff() > before + 10.0);
    CHECK(ball.now().vertices.row(0).minCoeff() < -28.0); // the rest stays
    CHECK(nendo::test::count_self_intersections(ball.now()) == 0);
    const ClayReport* last = nullptr;
    for (int call = 1; call <= 30; ++call)
      last = &ball.clay.press_to(pinch(gap + call, {37, 0, 0}));
    CHECK(last->held == 0);
    for (int wait = 0; wait < 90; ++wait)
      ball.clay.press_to(pinch(gap + 30.0, {37, 0, 0}));
    const Mesh still = ball.now();
    parts = pinch(gap + 30.0, {37, 0, 0});
    ball.go(parts, {30, 0, 0}, 20);
    CHECK((ball.now().vertices - still.vertices).colwise().norm().maxCoeff() < 0.05);
    CHECK(nendo::test::count_self_intersections(ball.now()) == 0);
  }

  TEST_CASE("a trembling finger at rest does not drill") {
    Ball ball;
    Parts parts = moved(finger(), Vector3d(0, 0, 30.5));
    ball.clay.begin(parts);
    ball.go(parts, {0, 0, -5}, 20);
    std::mt19937 random(41);
    std::uniform_real_distribution<double> tremor(-0.1, 0.1);
    const auto tremble = [&](int ticks) {
      for (int tick = 0; tick < ticks; ++tick)
        ball.clay.press_to(moved(parts, Vector3d(tremor(random), tremor(random), tremor(random))));
    };
    tremble(180);
    const Mesh before = ball.now();
    tremble(900);
    CHECK((ball.now().vertices - before.vertices).colwise().norm().maxCoeff() < 0.1);
  }

  TEST_CASE("when the hand has gone, nothing moves") {
    Ball ball;
    Parts parts = moved(finger(), Vector3d(0, 0, 31));
    ball.clay.begin(parts);
    ball.go(parts, {0, 0, -10}, 5);
    ball.go(parts, {0, 0, 40}, 5);
    for (int tick = 0; tick < 90; ++tick)
      ball.clay.press_to(parts);
    const Mesh before = ball.now();
    for (int tick = 0; tick < 90; ++tick)
      CHECK(ball.clay.press_to(parts).passes == 0);
    CHECK(ball.now().vertices == before.vertices);
  }

  TEST_CASE("a stroke is undone and done again to the last bit, and reset leads back") {
    Ball ball({}, 1, 4, {.undo_bytes = 8 << 20});
    Parts parts = moved(finger(), Vector3d(0, 0, 31));
    const Parts away = parts;
    ball.clay.begin(parts);
    ball.go(parts, {0, 0, -8}, 8);
    ball.go(parts, {0, 0, 8}, 2);
    const Mesh first = ball.now();
    ball.clay.begin(parts);
    CHECK(ball.shape.undo_steps() == 1);
    ball.go(parts, {5, 0, -8}, 8);
    const Mesh second = ball.now();
    CHECK(is_solved(ball.clay.go(HistoryMove::undo, away)));
    CHECK(ball.now().vertices == first.vertices);
    CHECK(is_solved(ball.clay.go(HistoryMove::undo, away)));
    CHECK(ball.now().vertices == ball.mesh.vertices);
    CHECK(is_solved(ball.clay.go(HistoryMove::redo, away)));
    CHECK(is_solved(ball.clay.go(HistoryMove::redo, away)));
    CHECK(ball.now().vertices == second.vertices);
    CHECK(is_solved(ball.clay.go(HistoryMove::reset, away)));
    CHECK(ball.now().vertices == ball.mesh.vertices);
    CHECK(is_solved(ball.clay.go(HistoryMove::undo, away)));
    CHECK(ball.now().vertices == second.vertices);
  }

  TEST_CASE("the same hands make the same bits") {
    std::vector<Points> ends;
    for (int run = 0; run < 2; ++run) {
      Ball ball({}, 2);
      Parts parts = moved(finger(), Vector3d(0, 0, 31));
      parts.push_back(cone({40, 0, 0}, {60, 0, 0}, 9, 9));
      ball.clay.begin(parts);
      ball.go(parts, {-8, 2, -8}, 12);
      ends.push_back(ball.now().vertices);
    }
    CHECK(ends[0] == ends[1]);
  }

  TEST_CASE("two bodies that meet leave a compromise, and report what is left") {
    Ball ball({.max_passes = 400}, 2);
    Parts parts{cone({0, 0, 39}, {0, 20, 39}, 8, 8), cone({0, 0, -39}, {0, 20, -39}, 8, 8)};
    ball.clay.begin(parts);
    for (int call = 0; call < 40; ++call) {
      parts[0].corners[0].z() -= 0.7;
      parts[0].corners[1].z() -= 0.7;
      parts[1].corners[0].z() += 0.7;
      parts[1].corners[1].z() += 0.7;
      const ClayReport& report = ball.clay.press_to(parts);
      CHECK(std::isfinite(report.penetration_mm));
    }
    CHECK(ball.now().vertices.allFinite());
    CHECK(nendo::test::count_self_intersections(ball.now()) == 0);
  }

  TEST_CASE("violent strokes fold nothing") {
    std::mt19937 random(42);
    for (int stroke = 0; stroke < 12; ++stroke) {
      Ball ball;
      const Vector3d from = nendo::test::random_points(random, 1, 1.0).col(0).normalized();
      const Vector3d to = nendo::test::random_points(random, 1, 20.0).col(0);
      // A finger of any direction, thrust at up to 1.5 m/s.
      Parts parts{cone(42.0 * from, 80.0 * from, 8, 9)};
      ball.clay.begin(parts);
      const int calls = 3 + static_cast<int>(random() % 5);
      ball.go(parts, 0.7 * (to - 42.0 * from), calls);
      for (int wait = 0; wait < 20; ++wait)
        ball.clay.press_to(parts);
      CHECK(ball.now().vertices.allFinite());
      CHECK(ball.depth(parts) < 0.03);
      CHECK(nendo::test::count_self_intersections(ball.now()) == 0);
    }
  }

  TEST_CASE("numbers that are not finite change nothing") {
    Ball ball;
    const Parts parts = moved(finger(), Vector3d(0, 0, 25));
    Parts bad = parts;
    bad[0].corners[0].x() = std::numeric_limits<double>::quiet_NaN();
    CHECK(ball.clay.begin(bad) == FieldStatus::not_finite);
    ball.clay.begin(moved(finger(), Vector3d(0, 0, 31)));
    CHECK(ball.clay.press_to(bad).status == FieldStatus::not_finite);
    bad = parts;
    bad[0].radii[0] = 0.0;
    CHECK(ball.clay.press_to(bad).status == FieldStatus::not_finite);
    bad = parts;
    bad[0].corners[1].z() = 1e200;
    CHECK(ball.clay.press_to(bad).status == FieldStatus::not_finite);
    CHECK(ball.now().vertices == ball.mesh.vertices);
    CHECK(ball.clay.press_to(parts).status == FieldStatus::ok);
    CHECK(ball.depth(parts) < 1e-3);
  }

  TEST_CASE("a hand that grabs inside of the surface pushes its way out") {
    Ball ball;
    const Parts parts = moved(finger(), Vector3d(0, 0, 25));
    ball.clay.begin(parts);
    ball.clay.press_to(parts);
    CHECK(ball.depth(parts) < 1e-3);
    CHECK(nendo::test::count_self_intersections(ball.now()) == 0);
  }

  TEST_CASE("pressing does not allocate or lock") {
    Ball ball({}, 1, 4, {.undo_bytes = 8 << 20});
    Parts parts = moved(finger(), Vector3d(0, 0, 31));
    ball.clay.begin(parts);
    int passes = 0;
    nendo::test::RestraintCounts counts;
    for (int call = 0; call < 20; ++call) {
      parts[0].corners[0] -= Vector3d(0.1, 0, 0.6);
      parts[0].corners[1] -= Vector3d(0.1, 0, 0.6);
      const nendo::test::Restraint restraint;
      passes += ball.clay.press_to(parts).passes;
      counts.allocations += restraint.counts().allocations;
      counts.frees += restraint.counts().frees;
      counts.locks += restraint.counts().locks;
    }
    CHECK(passes > 20);
    CHECK(counts.allocations == 0);
    CHECK(counts.frees == 0);
    CHECK(counts.locks == 0);
  }

  TEST_CASE("the cost grows only with what is near") {
    const auto distances = [](int level) {
      Ball ball({.keeps_volume = false}, 1, level);
      Parts parts = moved(finger(), Vector3d(0, 0, 30.5));
      ball.clay.begin(parts);
      return ball.go(parts, {0, 0, -1}, 1).distances;
    };
    // 16 times the vertices; a finger that touches a few square millimetres.
    CHECK(distances(6) < 40'000);
    CHECK(distances(6) < 10 * distances(4));
  }
}

} // namespace clay_test
