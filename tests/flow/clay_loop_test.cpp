// Hands that press clay, in a loop.

#include <cmath>
#include <memory>

#include <doctest/doctest.h>

#include <nendo/flow/clay_hands.hpp>

#include "support/flow_fixtures.hpp"

namespace clay_loop_test {

using namespace nendo;
using namespace nendo::flow;
using namespace std::chrono_literals;
using deform::Points;
using test::LoopUnderTest;

namespace {

/// Both hands come from beside the ball, press it, and go back, in so many ticks.
class Presses {
public:
  /// Edges that are refined, all of them, get `edge` long, in model units; 0: as they are.
  explicit Presses(Mode mode = Mode::clay, float edge = 0.0F) : test_(mode, {.rings_of_ball = 32}) {
    if (edge > 0.0F)
      test_.model.detail.assign(static_cast<std::size_t>(test_.model.vertices.cols()),
                                {edge, true});
    for (const HandInput& hand : test_.inputs) {
      const std::size_t slot = Placement::index_of(hand.side);
      beside_[slot] = beside(test_.model, test_.placement.units_per_metre, hand.skeleton(hand.side),
                             hand::joint_angles(hand.first, hand::default_calibration()),
                             test_.placement.T_stage_wrist[slot], 0.02);
    }
    test_.placement.T_stage_wrist = beside_; // where hands begin that must not tear the model
    test_.loop =
        std::make_unique<DeformLoop>(test_.model, test_.placement, test_.inputs, test_.options);
    go(0.0, 2);
  }

  LoopUnderTest& test() noexcept { return test_; }
  /// Puts the hands a part of the way from beside the ball into it.
  const Frame& go(double part, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
      for (const Side side : {Side::left, Side::right}) {
        if (left_rests && side == Side::left) continue;
        Eigen::Isometry3d wrist = beside_[Placement::index_of(side)];
        wrist.translation().x() += (side == Side::left ? 1.0 : -1.0) * 0.06 * part;
        test_.commands.try_push(WristMove::to(side, wrist));
      }
      now_ += 10ms;
      test_.bend(0, now_);
      test_.loop->tick(ticks_++, now_, now_);
      test_.loop->frames().update();
    }
    return frame();
  }
  /// In and out, and away for long enough to end the stroke.
  void press(double part = 1.0) {
    constexpr int steps = 20;
    for (int step = 1; step <= steps; ++step)
      go(part * step / steps, 1);
    for (int step = steps; step >= 0; --step)
      go(part * step / steps, 1);
    go(0.0, 60);
  }
  std::shared_ptr<const puppet::Rig> rig_of(const char* text) const {
    return std::make_shared<const puppet::Rig>(*puppet::parse_puppet(text, "a test's"),
                                               test_.model);
  }
  void ask(Request request) { test_.commands.try_push(request); }
  /// Edges there are split and collapsed, as who runs the loop does it. Hands stay at that part.
  void refine(double part) {
    DeformLoop& loop = *test_.loop;
    auto finer =
        PendingModel::make(loop.changes().newest_model(), {0, ModelSource::refined, 100'000});
    REQUIRE(finer);
    REQUIRE(loop.changes().hold_still());
    go(part, 1);
    REQUIRE(loop.changes().change_model(*finer));
    go(part, 1);
  }
  void change_to(Mode mode) {
    LoopSettings settings = test_.loop->changes().settings();
    settings.mode = mode;
    REQUIRE(test_.loop->changes().change_settings(settings));
  }
  const Frame& frame() { return test_.loop->frames().front(); }
  Points shape() { return test_.vertices_of(frame()); }

  bool left_rests = false; ///< where it begins

private:
  LoopUnderTest test_;
  std::array<Eigen::Isometry3d, 2> beside_;
  HostTime now_ = HostClock::now();
  std::uint64_t ticks_ = 0;
};

double farthest(const Points& a, const Points& b) {
  return (a - b).colwise().norm().maxCoeff();
}

/// How far the shape of a model that is symmetric about x = 0 is from its own image.
double asymmetry(const Points& model, const Points& shape) {
  const Eigen::Vector3d mirrored(-1.0, 1.0, 1.0);
  double worst = 0.0;
  for (Eigen::Index at = 0; at < model.cols(); ++at) {
    Eigen::Index other = 0;
    (model.colwise() - mirrored.cwiseProduct(model.col(at))).colwise().norm().minCoeff(&other);
    worst = std::max(worst, (shape.col(other) - mirrored.cwiseProduct(shape.col(at))).norm());
  }
  return worst;
}

} // namespace

TEST_SUITE("clay_loop") {
  TEST_CASE("hands beside the model leave it as it is, and their loads are felt nowhere") {
    Presses presses;
    CHECK(presses.shape() == presses.test().model.vertices);
    const Frame& frame = presses.go(0.0, 10);
    CHECK(frame.clay.is_clay);
    CHECK(frame.clay.touching == 0);
    CHECK(frame.contacts.count == 0);
    CHECK(frame.undo_steps == 0);
    for (const std::size_t body : {0U, 1U})
      for (const float touch : touch_of(frame.contacts.all(), body))
        CHECK(touch == 0.0F);
  }

  TEST_CASE("beside() keeps all vertices as far from the hand as was asked for") {
    const deform::Mesh ball = test::ball(24);
    const hand::HandSkeleton skeleton(Side::right);
    const Eigen::Isometry3d at_its_side(Eigen::Translation3d(0.4, 0.0, 0.0));
    for (const double clear_m : {0.0, 0.01, 0.05}) {
      const Eigen::Isometry3d wrist = beside(ball, 2.5, skeleton, {}, at_its_side, clear_m);
      hand::HandBody body(skeleton);
      body.follow(skeleton.pose({}, wrist));
      double min_m = 1.0;
      for (const auto vertex : ball.vertices.colwise())
        min_m = std::min(min_m, body.nearest(vertex / 2.5).distance_m);
      CHECK(min_m >= clear_m - 1e-9);
      CHECK(min_m < clear_m + 0.05);
    }
  }

  TEST_CASE("a press moves the surface, keeps the volume, and the frame has its place") {
    Presses presses;
    std::uint32_t most = 0;
    for (int step = 1; step <= 20; ++step) {
      const Frame& frame = presses.go(step / 20.0, 1);
      most = std::max(most, frame.clay.touching);
      CHECK(frame.fields.fields().empty());
      const double units = presses.test().placement.units_per_metre;
      for (const deform::ClayContact& contact : frame.contacts.all()) {
        CHECK(contact.load_mm > 0.0F);
        CHECK(strength_of(contact) > 0.0F);
        CHECK(strength_of(contact) <= 1.0F);
        REQUIRE(contact.body < 2);
        hand::HandBody body{hand::HandSkeleton(contact.body == 0 ? Side::left : Side::right)};
        body.follow(frame.hands[contact.body].pose);
        CHECK(std::abs(body.nearest(contact.place / units).distance_m) < 0.002);
      }
      if (frame.clay.touching > 0) CHECK(frame.undo_steps == 1);
    }
    CHECK(most > 3);
    presses.press();
    const Frame& frame = presses.frame();
    CHECK(frame.clay.touching == 0);
    CHECK(farthest(presses.shape(), presses.test().model.vertices) > 0.02);
    CHECK(std::abs(frame.clay.volume_part() - 1.0) < 1e-3);
    CHECK(frame.clay.first_volume == doctest::Approx(4.0 / 3.0 * 3.14159).epsilon(0.05));
  }

  TEST_CASE(
      "a stroke is a contact until the hands have left, and undo and redo go there and back") {
    Presses presses;
    const Points first = presses.shape();
    presses.press();
    const Points once = presses.shape();
    CHECK(presses.frame().undo_steps == 1);
    CHECK(presses.frame().steps.count == 1);
    CHECK_FALSE(presses.frame().steps.in_hand);
    presses.press(1.3); // farther than where the clay fits the hands already
    const Points twice = presses.shape();
    REQUIRE(farthest(once, twice) > 0.0);
    CHECK(presses.frame().undo_steps == 2);
    presses.ask(Request::undo);
    presses.go(0.0, 1);
    CHECK(presses.shape() == once);
    presses.ask(Request::undo);
    presses.go(0.0, 1);
    CHECK(presses.shape() == first);
    CHECK(presses.frame().redo_steps == 2);
    for (const Points* wanted : {&once, &twice}) {
      presses.ask(Request::redo);
      presses.go(0.0, 1);
      CHECK(presses.shape() == *wanted);
    }
  }

  TEST_CASE("an undo while hands press takes the contact back, and they press on") {
    Presses presses;
    const Points first = presses.shape();
    presses.go(0.3, 1);
    presses.go(0.6, 1);
    REQUIRE(presses.frame().clay.touching > 0);
    presses.ask(Request::undo);
    presses.ask(Request::release);
    presses.go(0.6, 1);
    presses.go(0.6, 2);
    CHECK(presses.frame().steps.undoable + presses.frame().redo_steps > 0);
    CHECK(presses.shape().allFinite());
    while (presses.frame().undo_steps > 0) {
      presses.ask(Request::undo);
      presses.go(0.6, 1);
    }
    CHECK(presses.shape() == first);
  }

  TEST_CASE("hands that have released clay go through it") {
    Presses presses;
    presses.ask(Request::release);
    presses.press();
    CHECK(presses.shape() == presses.test().model.vertices);
    CHECK(presses.frame().clay.is_clay);
    CHECK(presses.frame().clay.touching == 0);
  }

  TEST_CASE("modes change live, keep the shape, and are steps of their own") {
    Presses presses(Mode::type1);
    presses.go(0.0, 120);
    presses.change_to(Mode::clay);
    presses.go(0.0, 2);
    CHECK(presses.frame().settings.mode == Mode::clay);
    CHECK(presses.frame().clay.is_clay);
    const Points before = presses.shape();
    presses.press();
    const Points pressed = presses.shape();
    REQUIRE(farthest(before, pressed) > 0.01);
    presses.change_to(Mode::type2);
    presses.go(0.0, 2);
    CHECK(presses.shape() == pressed);
    CHECK_FALSE(presses.frame().clay.is_clay);
    presses.ask(Request::undo);
    for (int tick = 0; tick < 3; ++tick) {
      presses.go(0.0, 1);
      if (const auto awaited = presses.frame().awaited)
        static_cast<void>(presses.test().loop->changes().change_to(*awaited));
    }
    CHECK(presses.frame().settings.mode == Mode::clay);
    CHECK(presses.shape() == pressed);
    presses.ask(Request::undo);
    presses.go(0.0, 1);
    CHECK(presses.shape() == before);
  }

  TEST_CASE("the same hands make the same shape, bit for bit") {
    Presses one;
    Presses other;
    one.press();
    other.press();
    CHECK(one.shape() == other.shape());
  }

  TEST_CASE("with symmetry one hand presses both sides, and without it its own") {
    Presses presses;
    presses.left_rests = true;
    const Points& model = presses.test().model.vertices;
    presses.press();
    const double alone = asymmetry(model, presses.shape());
    CHECK(alone > 0.02);
    presses.ask(Request::reset);
    presses.go(0.0, 2);
    REQUIRE(presses.test().loop->changes().change_puppet(
        presses.rig_of("version = 1\nmirror = \"x\"\n")));
    presses.press();
    CHECK(presses.frame().symmetric);
    CHECK(farthest(presses.shape(), model) > 0.02);
    CHECK(asymmetry(model, presses.shape()) < 0.01 * alone);
    const Points pressed = presses.shape();
    presses.ask(Request::undo);
    presses.go(0.0, 2);
    CHECK(presses.shape() == model);
    presses.ask(Request::redo);
    presses.go(0.0, 2);
    CHECK(presses.shape() == pressed);
    REQUIRE(presses.test().loop->changes().change_puppet(presses.rig_of("version = 1\n")));
    presses.go(0.0, 2);
    CHECK_FALSE(presses.frame().symmetric);
  }

  TEST_CASE("clay begins with symmetry as well") {
    LoopUnderTest test(Mode::type1, {.puppet = "version = 1\nmirror = \"x\"\n"});
    LoopSettings settings = test.loop->changes().settings();
    settings.mode = Mode::clay;
    CHECK(test.loop->changes().change_settings(settings));
  }

  TEST_CASE("clay that is refined while hands press it keeps its volume") {
    Presses presses(Mode::clay, 0.04F);
    const double whole = presses.frame().clay.volume;
    CHECK(whole > 0.0);
    presses.go(0.6, 1);
    CHECK(presses.frame().clay.touching > 0);
    const double first = presses.frame().clay.first_volume;
    presses.refine(0.6);
    CHECK(presses.frame().model == 1);
    CHECK(presses.frame().clay.first_volume == first); // whatever other triangles enclose at rest
    presses.go(0.6, 20);
    presses.go(0.0, 60);
    CHECK(presses.frame().clay.volume == doctest::Approx(whole).epsilon(2e-5));
    CHECK(presses.frame().clay.volume_part() == doctest::Approx(1.0).epsilon(2e-5));
  }

  TEST_CASE("masks come and go while hands press, and what they hold keeps its bits") {
    Presses presses;
    const deform::Points& model = presses.test().model.vertices;
    REQUIRE(presses.test().loop->changes().change_puppet(
        presses.rig_of("version = 1\n[[masks]]\nat = [0, 0, 0]\nradius = 9\n")));
    presses.press();
    CHECK(farthest(presses.shape(), model) == 0.0); // all of it is held
    REQUIRE(presses.test().loop->changes().change_puppet(
        presses.rig_of("version = 1\n[[masks]]\nat = [0, 9, 0]\nradius = 0.1\n")));
    presses.press();
    CHECK(farthest(presses.shape(), model) > 0.02);
  }

  TEST_CASE("a puppet's points do not press") {
    LoopUnderTest test(Mode::type1, {.puppet = test::ball_puppet});
    LoopSettings settings = test.loop->changes().settings();
    settings.mode = Mode::clay;
    CHECK_FALSE(test.loop->changes().change_settings(settings));
    Presses presses;
    const auto refused =
        presses.test().loop->changes().change_puppet(presses.rig_of(test::ball_puppet));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("type 1") != std::string::npos);
  }
}

} // namespace clay_loop_test
