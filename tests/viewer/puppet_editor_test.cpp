// A puppet made by clicks, as a window does it, without a window.

#include <cmath>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"
#include "viewer/pointing.hpp"
#include "viewer/puppet_editor.hpp"

namespace puppet_editor_test {

using namespace nendo;
using namespace nendo::viewer;
using Eigen::Vector3d;

namespace {

/// A person at a ball, whose hands move as the test requests.
struct Maker {
  deform::Mesh ball = test::ball(24);
  PuppetEditor editor;
  PuppetEditor::RigPointer in_force;
  flow::Frame frame;

  Maker() {
    editor.begin(ball, "ball.obj", nullptr);
    editor.turn(true);
    frame.ticks_run = 1;
    for (auto& hand : frame.hands)
      hand.present = true;
    look();
  }
  void look() { editor.follow(in_force, frame); }
  void bend(Side side, std::size_t finger, double rad) {
    frame.hands[flow::Placement::index_of(side)].angles.fingers[finger - 1].mcp_flexion_rad = rad;
    look();
  }
  static SurfaceHit place(const Vector3d& at) {
    return {at.normalized(), at.normalized(), deform::nearest_position(test::ball(24), at)};
  }
  /// What the loop would do.
  bool hand_over() {
    auto rig = editor.take();
    if (!rig) return false;
    in_force = std::move(rig);
    look();
    return true;
  }
  const puppet::Puppet& puppet() const { return editor.rig().puppet(); }
  double moved() {
    deform::Points vertices;
    deform::BlockLayout(ball.vertices).unpack(*editor.shape(), vertices);
    return (vertices - ball.vertices).colwise().norm().maxCoeff();
  }
};

} // namespace

TEST_SUITE("puppet editor") {
  TEST_CASE("a ray through a pixel meets what is drawn there, and the nearest of it") {
    const deform::Mesh ball = test::ball(48);
    render::Camera camera;
    camera.target = {0.1, 0.2, 0.0};
    camera.distance_m = 5.0;
    camera.view = {35.0, 20.0};
    camera.centre = 0.2;
    const render::Size size{800, 600};
    for (const Vector3d& at : {Vector3d(0, 0, 1), Vector3d(0.5, 0.6, 0.6), Vector3d(0, 1, 0.4)}) {
      const Vector3d place = at.normalized();
      const auto pixel = pixel_of(camera, place, size);
      REQUIRE(pixel);
      const auto hit = first_hit(ball, ray_at(camera, *pixel, size));
      REQUIRE(hit);
      CHECK((hit->at - place).norm() < 0.02);
      CHECK(hit->normal.dot(place) > 0.99);
      CHECK((hit->in_mesh.in(ball.vertices) - hit->at).norm() < 1e-9);
    }
    CHECK_FALSE(first_hit(ball, ray_at(camera, {2.0, 2.0}, size)));
  }

  TEST_CASE("click a place, bend a finger, drag: a puppet of two points") {
    Maker maker;
    CHECK(maker.editor.message().find("Click") != std::string::npos);
    maker.editor.place(Maker::place({0, 1, 0}));
    maker.look();
    CHECK_FALSE(maker.editor.take());
    maker.bend(Side::right, 1, 0.3); // not far enough
    CHECK(maker.editor.pending());
    maker.bend(Side::right, 1, 1.0);
    CHECK_FALSE(maker.editor.pending());
    REQUIRE(maker.hand_over());
    REQUIRE(maker.puppet().functions.size() == 1);
    CHECK(maker.puppet().functions[0].input.name() == "right.index_flexion");
    CHECK(maker.editor.message().find("right.index_flexion") != std::string::npos);
    CHECK(maker.moved() == 0.0);

    const std::size_t point = maker.editor.point();
    REQUIRE(point == 0);
    const Vector3d way = maker.editor.way_of(point);
    CHECK(way.normalized().dot(Vector3d::UnitY()) > 0.99); // out of the surface at first
    maker.editor.begin_drag(point);
    maker.editor.drag({0.1, 0.0, 0.0});
    maker.editor.drag({0.1, 0.05, 0.0});
    CHECK(maker.moved() == doctest::Approx((way + Vector3d(0.2, 0.05, 0)).norm()).epsilon(0.02));
    CHECK_FALSE(maker.editor.take()); // the loop continues meanwhile as it was
    maker.editor.end_drag();
    REQUIRE(maker.hand_over());
    CHECK((maker.editor.way_of(point) - way - Vector3d(0.2, 0.05, 0)).norm() < 1e-3);
    CHECK(maker.moved() == 0.0);

    // With shift it turns about the middle of the ball, which has no pin, in the picture's plane.
    maker.editor.begin_turn(point, {0, 0, 1});
    REQUIRE(maker.editor.dragged_turn() != nullptr);
    CHECK(maker.editor.dragged_turn()->through.norm() < 0.02);
    maker.editor.turn_by(20.0);
    maker.editor.turn_by(10.0);
    const Vector3d turned = maker.editor.way_of(point);
    CHECK(turned.norm() == doctest::Approx(2.0 * std::sin(from_degrees(15.0))).epsilon(0.02));
    CHECK(turned.x() < 0.0); // from the top, counter-clockwise
    CHECK(maker.moved() == doctest::Approx(turned.norm()).epsilon(0.02));
    CHECK_FALSE(maker.editor.take());
    maker.editor.end_drag();
    REQUIRE(maker.hand_over());
    CHECK(maker.puppet().functions[0].turn->degrees == 30.0);
    CHECK((maker.editor.way_of(point) - turned).norm() < 1e-3);
    maker.editor.begin_drag(point); // without shift, what turns is not moved
    maker.editor.drag({0.1, 0.0, 0.0});
    maker.editor.end_drag();
    CHECK_FALSE(maker.editor.take());
    CHECK(maker.editor.message().find("shift") != std::string::npos);
    maker.editor.begin_turn(point, {1, 0, 0}); // about its own axis, wherever one looks from
    maker.editor.turn_by(-50.0);
    maker.editor.end_drag();
    REQUIRE(maker.hand_over());
    CHECK(maker.puppet().functions[0].turn->degrees == -20.0);
    CHECK(maker.puppet().functions[0].turn->axis == Vector3d(0, 0, 1));

    // The other finger is already bent; what counts is what it does after the click.
    maker.editor.place(Maker::place({1, 0, 0}));
    maker.look();
    CHECK(maker.editor.pending());
    maker.bend(Side::left, 3, 0.9);
    REQUIRE(maker.hand_over());
    CHECK(maker.puppet().points.size() == 2);
    CHECK(maker.puppet().functions[1].input.name() == "left.ring_flexion");
    CHECK(puppet::parse_puppet(maker.puppet().text, "made"));
  }

  TEST_CASE("of the twins that a mirror makes, the one at the click is chosen") {
    Maker maker;
    maker.editor.place(Maker::place({0.8, 0.6, 0}));
    maker.editor.choose_input(*puppet::HandSignal::named("left.thumb_flexion"), 0.7);
    REQUIRE(maker.hand_over());
    maker.editor.toggle_mirror();
    REQUIRE(maker.hand_over());
    const auto start = [&] {
      return maker.editor.rig().starts().col(static_cast<Eigen::Index>(maker.editor.point()));
    };
    for (const double side : {-1.0, 1.0}) {
      maker.editor.place(Maker::place({0.5 * side, -0.5 * side, 0.7}));
      maker.editor.choose_input(*puppet::HandSignal::named("left.index_flexion"), 0.7);
      REQUIRE(maker.hand_over());
      REQUIRE(maker.editor.point() != PuppetEditor::none);
      CHECK(start().x() * side > 0.0);
      const auto& moves = maker.puppet().functions[maker.editor.function()].moves;
      REQUIRE(moves.size() == 1);
      CHECK(moves[0].point == maker.editor.point());
      maker.editor.place(Maker::place({0.5 * side, 0.3 * side, -0.7}));
      maker.editor.toggle_pin();
      REQUIRE(maker.hand_over());
      CHECK(start().x() * side > 0.0);
      CHECK(maker.puppet().points[maker.editor.point()].is_pin);
    }
  }

  TEST_CASE("an undo in the loop takes the editor along, but not edits that are on their way") {
    Maker maker;
    maker.editor.place(Maker::place({0, 1, 0}));
    maker.look();
    maker.editor.choose_input(*puppet::HandSignal::named("left.thumb_flexion"), 0.7);
    REQUIRE(maker.hand_over());
    const auto first = maker.in_force;
    maker.editor.toggle_mirror();
    const auto second = maker.editor.take();
    maker.editor.place(Maker::place({0, 0, 1}));
    maker.editor.toggle_pin();
    const auto third = maker.editor.take();
    REQUIRE(third);
    maker.in_force = second; // the loop has this one by now
    maker.look();
    CHECK(maker.puppet().points.size() == 2);
    maker.in_force = third;
    maker.look();
    CHECK(&maker.editor.rig() == third.get());
    maker.in_force = first; // undone
    maker.look();
    CHECK(&maker.editor.rig() == first.get());
    maker.in_force = nullptr; // to before the first edit
    maker.look();
    CHECK(maker.puppet().points.empty());
    CHECK(maker.puppet().model == "ball.obj");
    CHECK(maker.moved() == 0.0);
  }

  TEST_CASE("what cannot be done is refused, says why, and reaches no loop") {
    Maker maker;
    maker.editor.toggle_mirror();
    CHECK_FALSE(maker.editor.message().empty());
    maker.editor.toggle_brush(); // without a puppet, it paints masks of fingertips
    CHECK(maker.editor.brushes());
    maker.editor.paint(Maker::place({0, -1, 0}), false);
    maker.editor.end_stroke();
    REQUIRE(maker.hand_over());
    CHECK(maker.editor.has_masks());
    CHECK(maker.editor.shape() == nullptr); // the model is shown as the hands have shaped it
    maker.editor.paint(Maker::place({0, -1, 0}), true);
    maker.editor.end_stroke();
    REQUIRE(maker.hand_over());
    CHECK_FALSE(maker.editor.has_masks());
    maker.editor.toggle_brush();
    CHECK_FALSE(maker.editor.is_on());
    maker.editor.turn(true);
    maker.editor.place(Maker::place({0, 1, 0}));
    maker.editor.toggle_pin(); // a puppet begins with a function
    CHECK_FALSE(maker.editor.take());
    CHECK(maker.editor.message().find("pins come after") != std::string::npos);
    maker.editor.choose_input(*puppet::HandSignal::named("left.thumb_flexion"), 0.7);
    REQUIRE(maker.hand_over());
    maker.editor.toggle_pin();   // it is moved
    maker.editor.remove_point(); // it is the last
    maker.editor.rename_function("no name");
    maker.editor.place(Maker::place({1e-4, 1, 0})); // too near
    maker.editor.choose_input(*puppet::HandSignal::named("left.index_flexion"), 0.7);
    CHECK(maker.editor.message().find("too near") != std::string::npos);
    CHECK_FALSE(maker.editor.take());
    CHECK(&maker.editor.rig() == maker.in_force.get());
  }

  TEST_CASE("brush, radius and names") {
    Maker maker;
    maker.editor.place(Maker::place({0, 1, 0}));
    maker.editor.choose_input(*puppet::HandSignal::named("left.thumb_flexion"), 0.7);
    REQUIRE(maker.hand_over());
    maker.editor.rename_function("jawOpen");
    REQUIRE(maker.hand_over());
    CHECK(maker.puppet().functions[0].name == "jawOpen");
    CHECK(maker.editor.function() == 0);
    const double radius = maker.puppet().points[0].radius;
    maker.editor.scale_radius(3.0);
    CHECK_FALSE(maker.editor.take()); // the wheel may continue
    maker.editor.choose_point(0);
    REQUIRE(maker.hand_over());
    CHECK(maker.puppet().points[0].radius == doctest::Approx(radius * 1.331).epsilon(1e-3));
    maker.editor.toggle_brush();
    for (int step = 0; step < 50; ++step)
      maker.editor.paint(Maker::place({0.02 * step, -1, 0}), false);
    maker.editor.end_stroke();
    REQUIRE(maker.hand_over());
    CHECK_FALSE(maker.puppet().masks.empty());
    for (int step = 0; step < 50; ++step)
      maker.editor.paint(Maker::place({0.02 * step, -1, 0}), true);
    maker.editor.end_stroke();
    REQUIRE(maker.hand_over());
    CHECK(maker.puppet().masks.empty());
    maker.editor.toggle_brush(); // back to the points
    CHECK(maker.editor.is_on());
    CHECK_FALSE(maker.editor.brushes());
    maker.editor.turn(false);
    maker.editor.toggle_brush(); // while the puppet plays, and not to edit it
    CHECK(maker.editor.brushes());
    CHECK_FALSE(maker.editor.edits_puppet());
    maker.editor.toggle_brush();
    CHECK_FALSE(maker.editor.is_on());
  }
}

} // namespace puppet_editor_test
