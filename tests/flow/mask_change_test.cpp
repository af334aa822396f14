// A loop continues with other masks of its fingertips, and with symmetry: what is held stays bit
// for bit, both sides are shaped alike, and the one history leads across all of it.

#include <cstring>
#include <doctest/doctest.h>

#include "support/any_puppet.hpp"
#include "support/clocked_loop.hpp"
#include "support/restrained_ticks.hpp"
#include "support/rounds.hpp"

namespace mask_change_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::flow;
using nendo::test::Clocked;
using nendo::test::gap;

namespace {

std::shared_ptr<const puppet::Rig> rig_of(const Result<puppet::Puppet>& puppet) {
  REQUIRE_MESSAGE(puppet, (puppet ? "" : puppet.error().message));
  return std::make_shared<const puppet::Rig>(*puppet, deform::Points(3, 0));
}

puppet::Rig masks_of(const Clocked& loop) {
  const auto& now = loop.test.loop->changes().puppet(loop.test.loop->changes().newest_puppet());
  return now ? *now : puppet::Rig(puppet::Puppet{}, deform::Points(3, 0));
}

void change(Clocked& loop, const Result<puppet::Puppet>& to) {
  REQUIRE(loop.test.loop->changes().change_puppet(rig_of(to)));
}

/// Which vertices have other bits.
std::vector<Eigen::Index> moved(const deform::Points& from, const deform::Points& to) {
  std::vector<Eigen::Index> all;
  for (Eigen::Index v = 0; v < from.cols(); ++v)
    if (std::memcmp(from.col(v).data(), to.col(v).data(), 3 * sizeof(double)) != 0)
      all.push_back(v);
  return all;
}

/// The farthest that a vertex is from the mirror image of the vertex whose image it was at first.
double asymmetry(const deform::Points& model, const deform::Points& shape) {
  double most = 0.0;
  for (Eigen::Index v = 0; v < model.cols(); ++v) {
    Eigen::Vector3d image = model.col(v);
    image.x() = -image.x();
    Eigen::Index twin = 0;
    REQUIRE((model.colwise() - image).colwise().norm().minCoeff(&twin) < 1e-12);
    Eigen::Vector3d shaped = shape.col(v);
    shaped.x() = -shaped.x();
    most = std::max(most, (shape.col(twin) - shaped).cwiseAbs().maxCoeff());
  }
  return most;
}

const std::array north{Eigen::Vector3d(0, 1, 0)};

} // namespace

TEST_SUITE("mask change") {
  TEST_CASE("what is held in the middle of a stroke stays where it is, in either mode, also never "
            "folding, until it is freed") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      for (const bool injects : {false, true}) {
        CAPTURE(name_of(mode));
        CAPTURE(injects);
        test::LoopFixture fixture{.rings_of_ball = 12};
        if (injects) fixture.injective.emplace();
        Clocked loop(mode, fixture);
        loop.stroke(0, 12);
        change(loop, puppet::with_masks(masks_of(loop), north, 1.2));
        loop.tick(); // takes them, after it has made its shape
        const deform::Points before = loop.tick();
        CHECK(loop.frame().puppet == 1);
        const deform::Points after = loop.stroke(12, 30);
        const Eigen::VectorXd weights =
            puppet::mask_weights(masks_of(loop).puppet(), loop.test.model.vertices);
        std::size_t held = 0, free = 0;
        for (const Eigen::Index v : moved(before, after))
          ++(weights[v] == 0.0 ? held : free);
        CHECK(held == 0);
        CHECK(free > 20);
        CHECK((weights.array() == 0.0).count() > 10);
        change(loop, puppet::with_masks_inverted(masks_of(loop)));
        const deform::Points inverted = loop.tick();
        const deform::Points other = loop.stroke(30, 5);
        std::size_t outside = 0, inside = 0;
        for (const Eigen::Index v : moved(inverted, other))
          ++(weights[v] == 1.0 ? outside : inside);
        CHECK(outside == 0);
        CHECK(inside > 10);
        change(loop, puppet::without_any_mask(masks_of(loop)));
        const deform::Points cleared = loop.tick();
        CHECK(moved(cleared, loop.stroke(5, 25)).size() >
              static_cast<std::size_t>((weights.array() == 0.0).count()));
      }
    }
  }

  TEST_CASE("one hand shapes both sides of a symmetric model alike, with every brush") {
    for (std::uint8_t number = 0; number <= deform::brush_count; ++number) {
      const Mode mode = number == deform::brush_count ? Mode::type1 : Mode::type2;
      // The ball's quads are not cut alike on both sides, which brushes with normals would see.
      const auto brush = static_cast<deform::Brush>(number);
      if (mode == Mode::type2 && brush != deform::Brush::pull && brush != deform::Brush::scale)
        continue;
      CAPTURE(name_of(mode));
      CAPTURE(int{number});
      Clocked loop(mode);
      LoopSettings settings = loop.test.loop->changes().settings();
      if (mode == Mode::type2) settings.brushes.fill(brush);
      loop.change(settings);
      change(loop, puppet::with_symmetry(masks_of(loop), true, 0.0));
      loop.tick();
      loop.tick();
      CHECK(loop.frame().symmetric);
      CHECK(loop.frame().puppet == 1);
      // Only the right hand moves.
      for (int counts = 0; counts < 25; ++counts) {
        loop.test.rings[1]->try_push(test::bent_sample(Side::right, counts, loop.now + 11ms));
        loop.tick(11ms);
      }
      const deform::Points shape = loop.tick();
      CHECK(gap(shape, loop.test.model.vertices) > 2e-3);
      CHECK(asymmetry(loop.test.model.vertices, shape) < 1e-6);
      // The other way, it shapes one side again.
      change(loop, puppet::with_symmetry(masks_of(loop), false, 0.0));
      loop.tick();
      loop.tick();
      CHECK_FALSE(loop.frame().symmetric);
      for (int counts = 25; counts > 0; --counts) {
        loop.test.rings[1]->try_push(test::bent_sample(Side::right, counts, loop.now + 11ms));
        loop.tick(11ms);
      }
      CHECK(asymmetry(loop.test.model.vertices, loop.tick()) > 1e-3);
    }
  }

  TEST_CASE("undo goes back over strokes, masks, symmetry and settings, and redo forth again") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      CAPTURE(name_of(mode));
      Clocked loop(mode);
      std::vector<deform::Points> shapes{loop.tick()};
      std::vector<StepKind> kinds;
      const auto shape_and = [&](int from, int to, const auto& go_on, StepKind kind) {
        loop.stroke(from, to);
        REQUIRE(loop.test.commands.try_push(Request::commit));
        shapes.push_back(loop.tick());
        go_on();
        shapes.push_back(loop.tick(1100ms)); // farther apart than what is one step
        kinds.insert(kinds.end(), {StepKind::stroke, kind});
      };
      shape_and(
          0, 15, [&] { change(loop, puppet::with_masks(masks_of(loop), north, 1.0)); },
          StepKind::mask);
      shape_and(
          15, 3, [&] { change(loop, puppet::with_symmetry(masks_of(loop), true, 0.0)); },
          StepKind::symmetry);
      shape_and(
          3, 20,
          [&] {
            LoopSettings settings = loop.test.loop->changes().settings();
            settings.radius_m.fill(0.7 * settings.radius_m[0]);
            loop.change(settings);
          },
          StepKind::radius);
      shape_and(
          20, 5, [&] { change(loop, puppet::with_masks_inverted(masks_of(loop))); },
          StepKind::mask);
      shape_and(
          5, 25, [&] { change(loop, puppet::without_any_mask(masks_of(loop))); }, StepKind::mask);
      CHECK(loop.kinds() == kinds);
      CHECK(name_of(StepKind::mask) == "mask");
      CHECK(name_of(StepKind::symmetry) == "symmetry");
      const auto settled = [&](Request request) {
        REQUIRE(loop.test.commands.try_push(request));
        loop.tick();
        if (loop.frame().awaited)
          REQUIRE(loop.test.loop->changes().change_to(*loop.frame().awaited));
        loop.tick();
        return loop.tick();
      };
      for (std::size_t at = shapes.size() - 1; at > 0; --at)
        CHECK(gap(settled(Request::undo), shapes[at - 1]) < test::float_gap);
      CHECK(loop.frame().puppet == 0);
      CHECK(loop.frame().undo_steps == 0);
      for (std::size_t at = 1; at < shapes.size(); ++at)
        CHECK(gap(settled(Request::redo), shapes[at]) < test::float_gap);
      CHECK(loop.frame().puppet == 4);
    }
  }

  TEST_CASE("masks stay where they are when the model is subdivided, and a loop begins with them") {
    test::LoopFixture fixture{.rings_of_ball = 12,
                              .puppet = "version = 1\n[[masks]]\nat = [0, 1, 0]\nradius = 1.2\n"};
    Clocked loop(Mode::type1, fixture);
    CHECK(loop.test.loop->changes().first_puppet() == nullptr);
    loop.stroke(0, 20);
    const auto held = [&](const deform::Points& model) {
      const Eigen::VectorXd weights = puppet::mask_weights(masks_of(loop).puppet(), model);
      return Eigen::Array<bool, Eigen::Dynamic, 1>(weights.array() == 0.0);
    };
    const deform::Points coarse = loop.tick();
    const auto held_at_first = held(loop.test.model.vertices);
    for (const Eigen::Index v : moved(loop.test.model.vertices, coarse))
      CHECK_FALSE(held_at_first[v]);
    PendingModel finer(loop.test.loop->changes().newest_model());
    REQUIRE(loop.test.loop->changes().hold_still());
    loop.tick();
    REQUIRE(loop.test.loop->changes().is_still());
    REQUIRE(loop.test.loop->changes().change_model(finer));
    const deform::Points before = loop.tick();
    const deform::Points after = loop.stroke(20, 2);
    const deform::Points& model = loop.test.loop->changes().newest_model().mesh.vertices;
    REQUIRE(after.cols() == model.cols());
    const auto held_now = held(model);
    CHECK(held_now.count() > 2 * held_at_first.count());
    std::size_t count = 0;
    for (const Eigen::Index v : moved(before, after))
      count += held_now[v] ? 1U : 0U;
    CHECK(count == 0);
    CHECK(gap(before, after) > 1e-3);
  }

  TEST_CASE("hands that play a puppet are given no masks without points") {
    Clocked loop(Mode::type1, {.rings_of_ball = 12, .puppet = test::ball_puppet});
    const auto refused = loop.test.loop->changes().change_puppet(
        rig_of(puppet::parse_puppet("version = 1\ninverted = true\n", "masks")));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("needs points") != std::string::npos);
    CHECK(loop.test.loop->changes().next_puppet() == 1);
  }

  TEST_CASE(
      "ticks that take masks, symmetry, settings and models allocate, free and lock nothing") {
    constexpr std::uint64_t ticks = test::rounds(1500);
    test::RestraintCounts sum;
    std::uint32_t masks = 0;
    for (unsigned seed = 0; seed < 4; ++seed) {
      InputLog log;
      test::LoopUnderTest test(seed % 2 == 0 ? Mode::type1 : Mode::type2,
                               {.rings_of_ball = 6, .input_log = &log});
      test::tick_with_changes(
          test, log, ticks, seed,
          [](const auto& now, auto& random) { return test::any_masks(now, random); }, sum);
      masks += test.loop->changes().next_puppet();
    }
    CHECK(sum.allocations == 0);
    CHECK(sum.frees == 0);
    CHECK(sum.locks == 0);
    CHECK(masks > static_cast<std::uint32_t>(test::rounds(100)));
  }
}

} // namespace mask_change_test
