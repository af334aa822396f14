#include "session/run_models.hpp"

#include <algorithm>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>

#include "session/asking_run.hpp"
#include "support/thin_meshes.hpp"

namespace run_models_test {

using namespace nendo;
using namespace nendo::session;
using namespace nendo::session::asking;

TEST_SUITE("run_models") {
  TEST_CASE("the model becomes finer while the loop runs, and undo and redo go back and forth") {
    Run run;
    run.options.recording.file = (run.folder.path() / "take.nendo").string();
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    Asker asker(Changes{{flow::Request::release},
                        {flow::Subdivide{}},
                        {flow::SaveShape{}, change(other_settings)},
                        {flow::Request::undo, flow::Request::undo},
                        {flow::Request::redo, flow::Request::redo},
                        {record(false), flow::Request::grab},
                        {record(true), flow::Subdivide{}}});
    asker.min_ticks = 60;
    const auto outcome = run.follow({&asker});
    CHECK(asker.leaps == 0);
    CHECK(asker.prepared == std::vector<std::uint32_t>{1, 0, 1, 2});
    CHECK(asker.settled == 4);
    const auto written = deform::read_mesh(run.options.out);
    REQUIRE(written);
    CHECK(written->face_count() == 16 * run.mesh.face_count());
    const auto saved = deform::read_mesh(run.folder.path() / "out-1.ply");
    REQUIRE(saved);
    CHECK(saved->face_count() == 4 * run.mesh.face_count());
    CHECK(outcome.recordings.size() == 2);
    for (const auto& recording : outcome.recordings)
      CHECK(replay(recording.file) >= 0);
  }

  TEST_CASE("the model is refined while the loop runs, undone and redone, and the takes replay") {
    Run run;
    run.options.recording.file = (run.folder.path() / "take.nendo").string();
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    Asker asker(Changes{{flow::Request::release},
                        {flow::Refine{}},
                        {flow::SaveShape{}},
                        {flow::Request::undo},
                        {flow::Request::redo},
                        {record(false), flow::Request::grab},
                        {record(true), flow::Refine{}}});
    asker.min_ticks = 60;
    const auto outcome = run.follow({&asker});
    CHECK(asker.leaps == 0);
    REQUIRE(asker.prepared.size() >= 3);
    CHECK(asker.prepared[0] == 1);
    CHECK(asker.prepared[1] == 0);
    CHECK(asker.prepared[2] == 1);
    const auto saved = deform::read_mesh(run.folder.path() / "out-1.ply");
    REQUIRE(saved);
    CHECK(saved->face_count() != run.mesh.face_count());
    CHECK(outcome.recordings.size() == 2);
    for (const auto& recording : outcome.recordings)
      CHECK(replay(recording.file) >= 0);
  }

  TEST_CASE("a wire cuts the model while the loop runs, and takes from before and behind replay") {
    Run run;
    run.options.left = run.options.right = "sim:cut";
    run.options.loop.sculptor.mode = flow::Mode::parts;
    run.options.loop.wire_time = {0.8, 2.5};
    run.options.recording.file = (run.folder.path() / "take.nendo").string();
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    Asker asker(Changes{{}, {}, {flow::SaveShape{}}, {record(false)}, {record(true)}, {}});
    asker.min_ticks = 100;
    const auto outcome = run.follow({&asker});
    CHECK(asker.prepared == std::vector<std::uint32_t>{1});
    CHECK(std::count(asker.reports.begin(), asker.reports.end(), "the model has 2 parts now") == 1);
    const auto written = deform::read_mesh(run.options.out);
    REQUIRE(written);
    CHECK(deform::separate(*written).size() == 2);
    CHECK(deform::check_closed_manifold(*written));
    REQUIRE(outcome.recordings.size() == 2);
    for (const auto& recording : outcome.recordings)
      replay(recording.file);
  }

  TEST_CASE("the part that was taken last is copied and removed, and the takes replay") {
    Run run;
    run.options.left = run.options.right = "sim:carry";
    run.options.loop.sculptor.mode = flow::Mode::parts;
    run.options.recording.file = (run.folder.path() / "take.nendo").string();
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    Asker asker(Changes{{},
                        {},
                        {flow::EditPart{}},
                        {record(false)},
                        {record(true)},
                        {flow::EditPart{false, 1}},
                        {flow::EditPart{true, 0}},
                        {}});
    asker.min_ticks = 100;
    const auto outcome = run.follow({&asker});
    CHECK(asker.prepared == std::vector<std::uint32_t>{1, 2, 3});
    CHECK(asker.reports == std::vector<std::string>{"the model has 2 parts now",
                                                    "the model has 3 parts now",
                                                    "the model has 2 parts now"});
    const auto written = deform::read_mesh(run.options.out);
    REQUIRE(written);
    CHECK(deform::separate(*written).size() == 2);
    CHECK(written->vertices.cols() == 2 * run.mesh.vertices.cols());
    REQUIRE(outcome.recordings.size() == 2);
    for (const auto& recording : outcome.recordings)
      replay(recording.file);
  }

  TEST_CASE("what cannot be cut or joined is reported, and the run continues") {
    Run run;
    Asker asker(Changes{{flow::DrawWire{true}},
                        {flow::DrawWire{false}},
                        {flow::JoinParts{}},
                        {flow::EditPart{}},
                        {}});
    run.follow({&asker});
    CHECK(asker.prepared.empty());
    REQUIRE(asker.reports.size() == 3);
    CHECK(asker.reports[0].starts_with("the model "));
    CHECK(asker.reports[0].ends_with("; the model stays as it is"));
    CHECK(asker.reports[1] == "the model is one part, which is whole; the model stays as it is");
    CHECK(asker.reports[2] == "No hand has taken a part of this model yet; take the one that is "
                              "meant, in mode parts (m).");
  }

  TEST_CASE("the model is refined by itself where hands stretch it, and never beyond the bound") {
    Run run;
    const auto most = static_cast<std::uint32_t>(run.mesh.vertices.cols()) + 60;
    run.options.refine_to = most;
    run.options.recording.file = (run.folder.path() / "take.nendo").string();
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    // Nobody asks for it.
    Asker asker(Changes{{flow::Request::commit}, {flow::Request::commit}, {flow::Request::commit}});
    asker.min_ticks = 120;
    const auto outcome = run.follow({&asker});
    const auto written = deform::read_mesh(run.options.out);
    REQUIRE(written);
    CHECK(written->face_count() != run.mesh.face_count());
    CHECK(written->vertices.cols() <= most);
    CHECK(asker.prepared.size() > 0);
    REQUIRE(outcome.recordings.size() == 1);
    CHECK(replay(outcome.recordings[0].file) >= 0);
  }

  TEST_CASE("a wall that is thin opens by itself, once, or when it is asked for, and replays") {
    for (const bool by_itself : {true, false}) {
      CAPTURE(by_itself);
      Run run;
      run.mesh = test::dented_plate(0.4, 0.01);
      REQUIRE(deform::write_mesh(run.options.mesh, run.mesh));
      run.options.loop.held = false;
      if (by_itself) run.options.refine_to = 100000;
      run.options.changes_topology = by_itself;
      run.options.recording.file = (run.folder.path() / "take.nendo").string();
      REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
      const std::vector<flow::Command> nothing;
      const std::vector<flow::Command> asks{flow::ChangeTopology{}};
      Asker asker(by_itself ? Changes{nothing, nothing} : Changes{asks, asks});
      asker.min_ticks = 120;
      const auto outcome = run.follow({&asker});
      CHECK(asker.prepared == std::vector<std::uint32_t>{1});
      REQUIRE(asker.reports.size() == (by_itself ? 1 : 2));
      CHECK(asker.reports[0] ==
            "thin places have parted, opened or fused; the model is one part now");
      if (!by_itself)
        CHECK(asker.reports[1] ==
              "the model is nowhere thinner than its edges; the model stays as it is");
      REQUIRE(outcome.recordings.size() == 1);
      CHECK(replay(outcome.recordings[0].file) >= 0);
    }
  }

  TEST_CASE("what was undone is not forgotten because the model refines itself") {
    Run run;
    run.options.refine_to = 5000;
    Asker asker(Changes{{flow::Request::release},
                        {flow::Request::undo},
                        {flow::Request::redo},
                        {flow::Request::undo},
                        {flow::Request::redo}});
    asker.min_ticks = 80;
    const auto outcome = run.follow({&asker});
    CHECK(outcome.stats.undos == 2);
    CHECK(outcome.stats.redos == 2);
  }

  TEST_CASE("a model that a sink cannot take is not taken, and the reason is reported") {
    Run run;
    Asker asker(Changes{{flow::Subdivide{}}});
    asker.refuses = true;
    asker.min_ticks = 60;
    run.follow({&asker});
    REQUIRE(asker.reports.size() == 1);
    CHECK(asker.reports[0] == "no other model here; the model stays as it is");
    CHECK(deform::read_mesh(run.options.out)->face_count() == run.mesh.face_count());
  }
}

} // namespace run_models_test
