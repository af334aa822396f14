// A wire that hands draw through the model, and the versions that it makes.

#include <nendo/flow/wire_path.hpp>

#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <tuple>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>

#include "support/flow_fixtures.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"
#include "support/thin_meshes.hpp"

namespace wire_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::flow;
using deform::WirePlace;
using Eigen::Vector3d;

namespace {

WirePlace place_at(double z) {
  return {{-1.0, 0.0, z}, {1.0, 0.5, z}};
}

/// Both hands beside a ball, with index fingers that draw a wire through it along z.
class Drawing {
public:
  explicit Drawing(Mode mode = Mode::parts, const char* puppet = nullptr)
      : test_(mode, {.rings_of_ball = 16, .puppet = puppet}) {
    for (const Side side : {Side::left, Side::right}) {
      Eigen::Isometry3d& wrist = test_.placement.T_stage_wrist[Placement::index_of(side)];
      wrist.translation().x() += side == Side::left ? -0.4 : 0.4;
      wrists_[Placement::index_of(side)] = wrist;
    }
    restart();
  }
  /// With the model as it is.
  void restart() {
    test_.loop =
        std::make_unique<DeformLoop>(test_.model, test_.placement, test_.inputs, test_.options);
    go();
  }

  DeformLoop& loop() { return *test_.loop; }
  test::LoopUnderTest& test() { return test_; }
  const Frame& go(int ticks = 1) {
    for (int tick = 0; tick < ticks; ++tick) {
      now_ += 11ms;
      for (const Side side : {Side::left, Side::right})
        test_.rings[Placement::index_of(side)]->try_push(
            test::bent_sample(side, bent_[Placement::index_of(side)], now_));
      test_.loop->tick(ticks_++, now_, now_);
      test_.loop->frames().update();
    }
    return test_.loop->frames().front();
  }
  const Frame& ask(const Command& command) {
    REQUIRE(test_.commands.try_push(command));
    return go();
  }
  /// Leads the wire from one side of the ball to the other, or only to a part of the way.
  const Frame& draw(double part = 1.0) {
    constexpr int steps = 60;
    constexpr double way_m = 1.6;
    for (int step = 0; step <= steps; ++step) {
      for (const Side side : {Side::left, Side::right}) {
        Eigen::Isometry3d wrist = wrists_[Placement::index_of(side)];
        wrist.translation().z() += way_m * (0.5 - part * step / steps);
        REQUIRE(test_.commands.try_push(WristMove::to(side, wrist)));
      }
      const Frame& frame = step == 0 ? ask(DrawWire{true}) : go();
      CHECK(frame.wire.is_drawing());
      CHECK_FALSE(frame.held); // hands that draw hold nothing
    }
    return ask(DrawWire{false});
  }
  void bend(int left, int right) { bent_ = {left, right}; }
  void bend_other_than(Side side) {
    bent_[Placement::index_of(side)] = 0;
    bent_[1 - Placement::index_of(side)] = 60;
  }
  /// Leads that hand's knife through the ball, from one side to the other, from before it.
  const Frame& draw_knife(Side side) {
    constexpr int steps = 60;
    const double radius_m = 1.0 / test_.placement.units_per_metre;
    Eigen::Isometry3d& wrist = wrists_[Placement::index_of(side)];
    REQUIRE(test_.commands.try_push(WristMove::to(side, wrist)));
    const Vector3d tip =
        go(6).hands[Placement::index_of(side)].pose[hand::Joint::index_tip].translation();
    for (int step = 0; step <= steps; ++step) {
      Eigen::Isometry3d moved = wrist;
      const double x = 1.4 - 2.8 * step / steps;
      moved.translation() += radius_m * Vector3d(x, 0.1, 1.3) - tip;
      REQUIRE(test_.commands.try_push(WristMove::to(side, moved)));
      if (step == 0) go(); // the hand is there
      step == 0 ? ask(DrawWire{true, Blade::knife}) : go();
    }
    return ask(DrawWire{false});
  }
  /// Of the model, as who runs the loop does. Returns what cannot be.
  Result<void> change(const ChangeModel& change) {
    auto finer = PendingModel::make(loop().changes().newest_model(), change,
                                    loop().frames().front().wire.places());
    REQUIRE(finer);
    REQUIRE(loop().changes().hold_still());
    go();
    REQUIRE(loop().changes().is_still());
    auto changed = loop().changes().change_model(*finer);
    go();
    return changed;
  }
  void go_back(Request request) {
    const Frame& frame = ask(request);
    REQUIRE(frame.awaited.has_value());
    REQUIRE(loop().changes().change_to(*frame.awaited));
    go(2);
  }

private:
  test::LoopUnderTest test_;
  std::array<Eigen::Isometry3d, 2> wrists_;
  std::array<int, 2> bent_{};
  HostTime now_ = HostClock::now();
  std::uint64_t ticks_ = 0;
};

constexpr ChangeModel cut{0, ModelSource::cut};

} // namespace

TEST_SUITE("wire") {
  TEST_CASE("a path has places that are a step apart, its first and its last, and never too many") {
    WirePath path;
    path.draw_to(place_at(0.0)); // not drawing
    CHECK(path.places().empty());
    for (const int count : {2, 50, 127, 128, 129, 255, 256, 1000, 5000}) {
      CAPTURE(count);
      path.begin(0.06);
      CHECK(path.is_drawing());
      const std::uint32_t before = path.completed();
      for (int at = 0; at < count; ++at) {
        path.draw_to(place_at(0.066 * at));
        path.draw_to(place_at(0.066 * at + 0.006)); // nearer than a step
      }
      path.draw_to(place_at(std::numeric_limits<double>::quiet_NaN()));
      path.end();
      CHECK_FALSE(path.is_drawing());
      CHECK(path.completed() == before + 1);
      const auto places = path.places();
      REQUIRE(places.size() >= 2);
      CHECK(places.size() <= WirePath::max_places);
      CHECK(places.size() >= std::min<std::size_t>(static_cast<std::size_t>(count), 60));
      CHECK(places.front().from.z() == 0.0);
      CHECK(places.back().from.z() == doctest::Approx(0.066 * (count - 1) + 0.006));
      for (std::size_t at = 1; at < places.size(); ++at)
        CHECK(places[at].from.z() > places[at - 1].from.z());
    }
    path.begin(0.002); // of a long wire places are farther apart, and it is thinned out evenly
    for (int at = 0; at < 1000; ++at)
      path.draw_to(place_at(0.066 * at));
    path.end();
    double least = std::numeric_limits<double>::max(), most = 0.0;
    for (std::size_t at = 1; at + 1 < path.places().size(); ++at) {
      const double way = path.places()[at].from.z() - path.places()[at - 1].from.z();
      least = std::min(least, way);
      most = std::max(most, way);
    }
    CHECK(most < 2.5 * least);

    path.begin(0.01);
    path.draw_to(place_at(0.0));
    const std::uint32_t before = path.completed();
    path.end(); // it has been at one place alone
    CHECK(path.completed() == before);
  }

  TEST_CASE("hands that tremble at rest draw no wire, and on their way a smooth one") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> tremor(-0.01, 0.01);
    const auto near = [&](double z) {
      deform::WirePlace place = place_at(z);
      for (Eigen::Vector3d* const end : {&place.from, &place.to})
        *end += Eigen::Vector3d(tremor(random), tremor(random), tremor(random));
      return place;
    };
    WirePath path;
    path.begin(0.002);
    for (int tick = 0; tick < 300; ++tick)
      path.draw_to(near(0.0));
    CHECK(path.places().size() == 1);
    for (int tick = 0; tick <= 200; ++tick)
      path.draw_to(near(0.01 * tick));
    for (int tick = 0; tick < 300; ++tick)
      path.draw_to(near(2.0));
    path.end();
    const auto places = path.places();
    REQUIRE(places.size() > 20);
    CHECK(places.size() < 80);
    CHECK(places.back().from.z() == doctest::Approx(2.0).epsilon(0.02));
    for (std::size_t at = 1; at < places.size(); ++at) {
      const Eigen::Vector3d way = places[at].from - places[at - 1].from;
      CHECK(way.z() > 0.0);
      const bool is_end = at == 1 || at + 1 == places.size();
      CHECK(std::abs(way.y()) < (is_end ? 0.5 : 0.15) * way.z());
    }
  }

  TEST_CASE("a wire that is drawn through the model cuts it, is undone, and is done again") {
    Drawing hands;
    CHECK(hands.go().wire.completed() == 0);
    const Frame& drawn = hands.draw();
    CHECK(drawn.wire.completed() == 1);
    CHECK(drawn.held);
    CHECK(drawn.wire.places().size() > 20);
    CHECK(hands.test().vertices_of(drawn) == hands.test().model.vertices);
    REQUIRE(hands.change(cut));
    const ModelVersion& version = hands.loop().changes().newest_model();
    CHECK(version.number == 1);
    CHECK(deform::check_closed_manifold(version.mesh));
    const auto parts = deform::separate(version.mesh);
    REQUIRE(parts.size() == 2);
    double volume = 0.0;
    for (const deform::Mesh& part : parts) {
      CHECK(deform::check_closed_manifold(part));
      volume += deform::volume_of(part);
    }
    CHECK(volume == doctest::Approx(deform::volume_of(hands.test().model)).epsilon(1e-9));
    CHECK(hands.go().parts.count == 2);
    const auto& steps = hands.go().steps;
    CHECK(steps.all()[steps.undoable - 1].kind == StepKind::cut);
    const auto again = rebuild(hands.test().model, *version.origin);
    REQUIRE(again);
    CHECK(again->vertices == version.mesh.vertices);
    CHECK(again->face_corners == version.mesh.face_corners);
    hands.go_back(Request::undo);
    CHECK(hands.go().model == 0);
    CHECK(hands.test().vertices_of(hands.go()) == hands.test().model.vertices);
    hands.go_back(Request::redo);
    CHECK(hands.go().model == 1);
    CHECK(hands.go().parts.count == 2);
  }

  TEST_CASE("a wire that does not go through says why, and the model stays as it is") {
    Drawing hands;
    CHECK(hands.draw(0.5).wire.completed() == 1);
    const auto refused = hands.change(cut);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.starts_with("the model "));
    CHECK(hands.go(3).model == 0);
    CHECK(hands.test().vertices_of(hands.go()) == hands.test().model.vertices);
    hands.draw(1.0); // and then another one cuts
    CHECK(hands.change(cut));
    CHECK(hands.go(2).model == 1);
  }

  TEST_CASE("parts that overlap are joined as they are now, and one that is whole stays") {
    Drawing hands;
    const auto whole = hands.change({0, ModelSource::joined});
    REQUIRE_FALSE(whole);
    CHECK(whole.error().message == "the model is one part, which is whole");
    hands.draw();
    REQUIRE(hands.change(cut));
    const auto apart = hands.change({0, ModelSource::joined}); // they touch, and do not overlap
    CHECK((!apart || deform::separate(hands.loop().changes().newest_model().mesh).size() == 1));
  }

  TEST_CASE(
      "balls that overlap become one, which has the union's volume, and come back by an undo") {
    Drawing hands;
    deform::Mesh& model = hands.test().model;
    const deform::Mesh ball = test::sphere(16, 24, 1.0);
    model = ball;
    const auto count = static_cast<std::uint32_t>(ball.vertices.cols());
    model.vertices.conservativeResize(3, 2 * count);
    model.vertices.rightCols(count) = ball.vertices.colwise() + Vector3d(1.1, 0.13, 0.07);
    for (std::size_t face = 0; face < ball.face_count(); ++face) {
      for (std::uint32_t at = ball.face_starts[face]; at < ball.face_starts[face + 1]; ++at)
        model.face_corners.push_back(count + ball.face_corners[at]);
      model.face_starts.push_back(static_cast<std::uint32_t>(model.face_corners.size()));
    }
    hands.restart();
    CHECK(hands.go().parts.count == 2);
    const deform::Points before = hands.test().vertices_of(hands.go());
    REQUIRE(hands.change({0, ModelSource::joined}));
    const ModelVersion& version = hands.loop().changes().newest_model();
    CHECK(hands.go().parts.count == 1);
    CHECK(deform::check_closed_manifold(version.mesh));
    // Of two balls of radius 1, d apart, the part in common is pi (4 + d) (2 - d)^2 / 12.
    const double d = Vector3d(1.1, 0.13, 0.07).norm();
    const double common = std::numbers::pi * (4.0 + d) * (2.0 - d) * (2.0 - d) / 12.0;
    CHECK(deform::volume_of(version.mesh) ==
          doctest::Approx(2.0 * deform::volume_of(ball) - common).epsilon(0.02));
    const auto& steps = hands.go().steps;
    CHECK(steps.all()[steps.undoable - 1].kind == StepKind::join);
    const auto again = rebuild(model, *version.origin);
    REQUIRE(again);
    CHECK(again->vertices == version.mesh.vertices);
    hands.go_back(Request::undo);
    CHECK(hands.go().parts.count == 2);
    CHECK(hands.test().vertices_of(hands.go()) == before);
  }

  TEST_CASE("a neck that is thin parts, which is undone, done again, and made again") {
    Drawing hands;
    const auto thick = hands.change({0, ModelSource::topology});
    REQUIRE_FALSE(thick);
    CHECK(thick.error().message == "the model is nowhere thinner than its edges");
    hands.test().model = test::hourglass(0.2);
    hands.restart();
    CHECK(hands.go().parts.count == 1);
    const deform::Points before = hands.test().vertices_of(hands.go());
    REQUIRE(hands.change({0, ModelSource::topology}));
    const ModelVersion& version = hands.loop().changes().newest_model();
    CHECK(hands.go().parts.count == 2);
    CHECK(version.mesh.detail.size() == static_cast<std::size_t>(version.mesh.vertices.cols()));
    const auto& steps = hands.go().steps;
    CHECK(steps.all()[steps.undoable - 1].kind == StepKind::topology);
    const auto again = rebuild(version.before->mesh, *version.origin);
    REQUIRE(again);
    CHECK(again->vertices == version.mesh.vertices);
    hands.go_back(Request::undo);
    CHECK(hands.test().vertices_of(hands.go()) == before);
    hands.go_back(Request::redo);
    CHECK(hands.go().parts.count == 2);
  }

  TEST_CASE("a puppet's model is cut as the puppet holds it, plays on, and rests as before") {
    Drawing hands(Mode::type1, test::ball_puppet);
    const deform::Points rest = hands.loop().changes().newest_model().mesh.vertices;
    hands.bend(40, 40);
    hands.go(20);
    hands.draw();
    const deform::Points played = hands.test().vertices_of(hands.go(20));
    REQUIRE((played - rest).cwiseAbs().maxCoeff() > 0.01);
    REQUIRE(hands.change(cut));
    const Frame& frame = hands.go(5);
    const ModelVersion& version = hands.loop().changes().newest_model();
    REQUIRE(frame.model == version.number);
    CHECK(deform::separate(version.mesh).size() == 2);
    CHECK(deform::check_closed_manifold(version.mesh));
    // Old vertices keep their rest, and are where the puppet had them.
    CHECK(version.mesh.vertices.leftCols(rest.cols()) == rest);
    const deform::Points now = hands.test().vertices_of(frame);
    CHECK(now.leftCols(rest.cols()) == played);
    // New ones rest among the old: as far from the shape as these.
    const deform::Points ways = version.mesh.vertices - now;
    CHECK(ways.cwiseAbs().maxCoeff() <= ways.leftCols(rest.cols()).cwiseAbs().maxCoeff() + 1e-3);
    const auto again = rebuild(version.before->mesh, *version.origin);
    REQUIRE(again);
    CHECK(again->vertices == version.mesh.vertices);
    hands.go_back(Request::undo);
    CHECK(hands.test().vertices_of(hands.go()) == played);
    hands.go_back(Request::redo);
    CHECK(hands.test().vertices_of(hands.go()) == now);

    hands.bend(0, 60);
    const deform::Points moved = hands.test().vertices_of(hands.go(30));
    CHECK((moved - now).cwiseAbs().maxCoeff() > 0.01);
    CHECK(moved.allFinite());
  }

  TEST_CASE("a knife leads from the index finger that points more on, and cuts what it sweeps") {
    for (const Side side : {Side::left, Side::right}) {
      CAPTURE(static_cast<int>(side));
      Drawing hands;
      hands.bend_other_than(side);
      const Frame& drawn = hands.draw_knife(side);
      const auto& pose = drawn.hands[Placement::index_of(side)].pose;
      const double units = hands.test().placement.units_per_metre;
      const deform::WirePlace& last = drawn.wire.places().back();
      CHECK(last.from.isApprox(units * pose[hand::Joint::index_tip].translation(), 1e-12));
      const Vector3d finger = pose[hand::Joint::index_tip].translation() -
                              pose[hand::Joint::index_proximal].translation();
      CHECK((last.to - last.from).normalized().dot(finger.normalized()) > 1.0 - 1e-12);
      CHECK((last.to - last.from).norm() ==
            doctest::Approx(deform::diagonal_of(hands.test().model.vertices)));
      REQUIRE(hands.change(cut));
      const auto parts = deform::separate(hands.loop().changes().newest_model().mesh);
      REQUIRE(parts.size() == 2);
      for (const deform::Mesh& part : parts) // neither is a crumb
        CHECK(deform::volume_of(part) > 0.2 * deform::volume_of(hands.test().model));
    }
  }

  TEST_CASE("a part is copied and removed, which is undone, done again, and made again") {
    Drawing hands;
    hands.draw();
    REQUIRE(hands.change(cut));
    const deform::Points before = hands.test().vertices_of(hands.go(2));
    for (const auto& [source, kind, parts] : {std::tuple{ModelSource::copied, StepKind::copy, 3U},
                                              {ModelSource::removed, StepKind::remove, 1U}}) {
      ChangeModel edit{0, source};
      edit.part = 1;
      REQUIRE(hands.change(edit));
      const ModelVersion& version = hands.loop().changes().newest_model();
      CHECK(hands.go().parts.count == parts);
      CHECK(deform::check_closed_manifold(version.mesh));
      const auto& steps = hands.go().steps;
      CHECK(steps.all()[steps.undoable - 1].kind == kind);
      const auto again = rebuild(version.before->mesh, *version.origin);
      REQUIRE(again);
      CHECK(again->vertices == version.mesh.vertices);
      hands.go_back(Request::undo);
      CHECK(hands.go().parts.count == 2);
      CHECK(hands.test().vertices_of(hands.go()) == before);
      hands.go_back(Request::redo);
      CHECK(hands.go().parts.count == parts);
      hands.go_back(Request::undo);
    }
    ChangeModel none{0, ModelSource::removed};
    none.part = 7;
    const auto refused = hands.change(none);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message == "the model has no such part");
    CHECK(hands.test().vertices_of(hands.go()) == before);
  }

  TEST_CASE("drawing allocates nothing and takes no lock") {
    Drawing hands;
    test::RestraintCounts counts;
    {
      const test::Restraint restraint;
      hands.draw();
      hands.draw(0.3);
      hands.draw_knife(Side::right);
      counts = restraint.counts();
    }
    CHECK(counts.allocations == 0);
    CHECK(counts.frees == 0);
    CHECK(counts.locks == 0);
    CHECK(hands.go().wire.completed() == 3);
  }
}

} // namespace wire_test
