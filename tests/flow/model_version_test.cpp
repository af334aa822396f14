// A loop continues with another version of its model: nothing of the shape and of the hands' way is
// lost, and undo and redo go through all versions.

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

#include "support/clocked_loop.hpp"

namespace model_version_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::flow;
using nendo::test::gap;

namespace {

struct Versioned : test::Clocked {
  explicit Versioned(Mode mode) : Clocked(mode, {.rings_of_ball = 10}) {}

  DeformLoop& loop() { return *test.loop; }
  deform::Points commit() {
    REQUIRE(test.commands.try_push(Request::commit));
    return tick();
  }
  /// With hands that rest.
  deform::Points subdivide() {
    PendingModel finer(loop().changes().newest_model());
    REQUIRE(loop().changes().hold_still());
    tick();
    REQUIRE(loop().changes().is_still());
    REQUIRE(loop().changes().change_model(finer));
    return tick();
  }
};

/// Of the vertices that a subdivided model has in common with the previous one.
double old_gap(const deform::Points& finer, const deform::Points& before) {
  return gap(finer.leftCols(before.cols()), before);
}

} // namespace

TEST_SUITE("model_version") {
  TEST_CASE("subdividing moves nothing, and the hands continue with what they hold") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      CAPTURE(name_of(mode));
      Versioned run(mode);
      run.stroke(0, 15);
      const deform::Points before = run.commit();
      CHECK(gap(before, run.test.model.vertices) > 1e-2);
      const deform::Points finer = run.subdivide();
      CHECK(run.frame().model == 1);
      CHECK(run.frame().held);
      REQUIRE(finer.cols() > 3 * before.cols());
      CHECK(old_gap(finer, before) == 0.0);
      for (int tick = 0; tick < 3; ++tick)
        CHECK(gap(run.bent(14), finer) < 1e-6);
      CHECK(gap(run.stroke(15, 30), finer) > 1e-2); // the hands still hold it
      CHECK(run.loop().final_mesh().face_count() ==
            run.loop().changes().newest_model().mesh.face_count());
    }
  }

  TEST_CASE("however late the model comes, none of the hands' work meanwhile is lost") {
    for (const Mode mode : {Mode::type1, Mode::type2})
      for (const int late : {0, 1, 7, 40}) {
        CAPTURE(name_of(mode));
        CAPTURE(late);
        Versioned run(mode);
        Versioned reference(mode); // which commits where the other holds still, and keeps its model
        reference.now = run.now;
        run.stroke(0, 10);
        reference.stroke(0, 10);
        PendingModel finer(run.loop().changes().newest_model());
        REQUIRE(run.loop().changes().hold_still());
        const deform::Points still = run.bent(10);
        REQUIRE(reference.test.commands.try_push(Request::commit));
        CHECK(gap(reference.bent(10), still) == 0.0);
        for (int tick = 0; tick < late; ++tick) {
          CHECK(gap(run.bent(11 + tick), still) == 0.0);
          reference.bent(11 + tick);
        }
        REQUIRE(run.loop().changes().change_model(finer));
        CHECK(old_gap(run.bent(11 + late), still) == 0.0);
        reference.bent(11 + late);
        // In type 1 a shape depends on the places alone; in type 2 the way is cut elsewhere.
        const deform::Points shape = run.bent(12 + late);
        const deform::Points wanted = reference.bent(12 + late);
        CHECK(old_gap(shape, wanted) < (mode == Mode::type1 ? test::float_gap : 0.02));
        CHECK(gap(wanted, still) > (late < 7 ? -1.0 : 1e-3));
      }
  }

  TEST_CASE("requests while the loop holds still are done when it continues") {
    Versioned run(Mode::type1);
    run.stroke(0, 10);
    PendingModel finer(run.loop().changes().newest_model());
    REQUIRE(run.loop().changes().hold_still());
    CHECK_FALSE(run.loop().changes().hold_still());
    const deform::Points still = run.bent(10);
    CHECK_FALSE(run.loop().changes().hold_still());
    LoopSettings settings = run.loop().changes().settings();
    settings.radius_m.fill(0.3);
    REQUIRE(run.loop().changes().change_settings(settings));
    REQUIRE(run.test.commands.try_push(Request::release));
    CHECK(gap(run.bent(15), still) == 0.0);
    CHECK(run.frame().held);
    REQUIRE(run.loop().changes().change_model(finer));
    run.bent(16);
    CHECK(run.loop().changes().settings() == settings);
    const deform::Points kept = run.bent(17);
    CHECK_FALSE(run.frame().held);
    CHECK(run.frame().settings == settings);
    CHECK(old_gap(kept, still) > 1e-3); // what was shaped until the hands release
    CHECK(gap(run.bent(30), kept) == 0.0);
    CHECK(run.kinds() ==
          std::vector{StepKind::stroke, StepKind::subdivide, StepKind::radius, StepKind::stroke});
  }

  TEST_CASE("a model that is not wanted after all leaves the loop as it was") {
    for (const bool refused : {false, true}) {
      Versioned run(Mode::type1);
      run.stroke(0, 10);
      PendingModel finer(run.loop().changes().newest_model());
      REQUIRE(run.loop().changes().hold_still());
      const deform::Points still = run.bent(10);
      std::uint32_t seen = 0;
      if (refused)
        CHECK_FALSE(run.loop().changes().change_model(
            finer, [&](const ModelVersion& version) -> Result<void> {
              seen = version.number;
              return Error{Errc::failed, "not wanted"};
            }));
      else
        run.loop().changes().keep_model();
      CHECK(seen == (refused ? 1 : 0));
      CHECK(gap(run.bent(11), still) == 0.0);
      CHECK(gap(run.bent(20), still) > 1e-3);
      CHECK(run.frame().model == 0);
      CHECK_FALSE(run.loop().changes().model(1));
      run.commit();
      CHECK(run.kinds() == std::vector{StepKind::stroke, StepKind::stroke});
      run.subdivide();
      CHECK(run.frame().model == 1); // no number is left out
    }
  }

  TEST_CASE("undo and redo go through versions, settings and strokes, bit for bit") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      CAPTURE(name_of(mode));
      Versioned run(mode);
      std::vector<deform::Points> shapes{run.bent(0)};
      const auto keep = [&](const deform::Points& shape) { shapes.push_back(shape); };
      run.stroke(0, 10);
      keep(run.commit());
      keep(run.subdivide());
      run.stroke(9, 20);
      keep(run.commit());
      LoopSettings settings = run.loop().changes().settings();
      settings.radius_m.fill(0.3);
      REQUIRE(run.loop().changes().change_settings(settings));
      keep(run.tick());
      keep(run.subdivide());
      run.stroke(19, 5);
      keep(run.commit());
      const std::vector kinds{StepKind::stroke, StepKind::subdivide, StepKind::stroke,
                              StepKind::radius, StepKind::subdivide, StepKind::stroke};
      REQUIRE(run.kinds() == kinds);
      CHECK(run.frame().undo_steps == kinds.size());
      for (int times = 0; times < 3; ++times) {
        for (std::size_t at = kinds.size(); at-- > 0;) {
          const deform::Points shape = run.step(Request::undo);
          REQUIRE(shape.cols() == shapes[at].cols());
          CHECK(gap(shape, shapes[at]) == 0.0);
          CHECK(run.frame().undo_steps == at);
          CHECK(run.frame().redo_steps == kinds.size() - at);
          CHECK(run.kinds() == kinds);
          CHECK(run.frame().steps.undoable == at);
        }
        CHECK(run.frame().model == 0);
        CHECK(run.loop().changes().settings() != settings);
        for (std::size_t at = 0; at < kinds.size(); ++at) {
          const deform::Points shape = run.step(Request::redo);
          REQUIRE(shape.cols() == shapes[at + 1].cols());
          CHECK(gap(shape, shapes[at + 1]) == 0.0);
          CHECK(run.frame().redo_steps == kinds.size() - at - 1);
          CHECK(run.kinds() == kinds);
        }
        CHECK(run.frame().model == 2);
        CHECK(run.loop().changes().settings() == settings);
      }
    }
  }

  TEST_CASE("a step after an undo forgets the versions that were undone") {
    Versioned run(Mode::type1);
    run.stroke(0, 10);
    run.commit();
    run.subdivide();
    run.subdivide();
    run.step(Request::undo);
    run.step(Request::undo);
    CHECK(run.frame().redo_steps == 2);
    CHECK(run.loop().changes().model(2));
    run.stroke(9, 20);
    run.commit();
    CHECK(run.frame().redo_steps == 0);
    CHECK(run.kinds() == std::vector{StepKind::stroke, StepKind::stroke});
    const deform::Points before = run.bent(19);
    const deform::Points finer = run.subdivide();
    CHECK(run.frame().model == 3);
    CHECK(old_gap(finer, before) == 0.0);
    run.tick();
    run.loop().changes().is_changing();
    CHECK(run.loop().changes().model(0));
    CHECK_FALSE(run.loop().changes().model(1));
    CHECK_FALSE(run.loop().changes().model(2));
    CHECK_FALSE(run.loop().changes().change_to({run.loop().changes().settings(), 1, 0}));
    run.step(Request::undo);
    CHECK(gap(run.tick(), before) == 0.0);
  }

  TEST_CASE("an undo that waits for a version undoes what is committed meanwhile in its place") {
    Versioned run(Mode::type1);
    run.stroke(0, 10);
    const deform::Points before = run.commit();
    const deform::Points finer = run.subdivide();
    REQUIRE(run.test.commands.try_push(Request::undo));
    run.tick();
    REQUIRE(run.frame().awaited);
    REQUIRE(run.loop().changes().change_to(*run.frame().awaited));
    REQUIRE(run.test.commands.try_push(Request::commit)); // in the tick that takes the version
    const deform::Points committed = run.bent(20);
    CHECK(gap(committed, finer) > 1e-3);
    CHECK(run.frame().model == 1); // the version is refused
    CHECK(run.frame().undos == 0);
    CHECK(run.frame().shape_jumps == 0);
    CHECK(gap(run.tick(), finer) == 0.0);
    CHECK(run.frame().undos == 1);
    CHECK(run.frame().model == 1);
    CHECK_FALSE(run.loop().changes().is_changing());
    CHECK(gap(run.step(Request::undo), before) == 0.0);
    CHECK(run.frame().undos == 2);
    CHECK(run.frame().model == 0);
    CHECK(old_gap(run.step(Request::redo), before) == 0.0);
    CHECK(gap(run.step(Request::redo), committed) == 0.0);
  }

  TEST_CASE("a reset goes back to the subdivided model before the hands") {
    Versioned run(Mode::type2);
    run.stroke(0, 10);
    run.commit();
    const deform::Points finer = run.subdivide();
    run.stroke(9, 20);
    CHECK(gap(run.step(Request::reset), run.loop().changes().newest_model().mesh.vertices) == 0.0);
    CHECK(gap(run.step(Request::undo), finer) > 1e-3); // the stroke
    run.step(Request::undo);
    CHECK(gap(run.tick(), finer) == 0.0);
  }

  TEST_CASE("what type 1 holds goes before an undo of a version, and the hands grab there") {
    Versioned run(Mode::type1);
    run.stroke(0, 10);
    const deform::Points before = run.commit();
    const deform::Points finer = run.subdivide();
    run.stroke(9, 25);
    CHECK(gap(run.step(Request::undo), finer) == 0.0);
    CHECK(gap(run.step(Request::undo), before) == 0.0);
    CHECK(run.frame().held);
    CHECK(gap(run.stroke(25, 40), before) > 1e-3);
    CHECK(run.frame().redo_steps == 2);
    CHECK(run.step(Request::redo).cols() > before.cols());
  }
}

} // namespace model_version_test
