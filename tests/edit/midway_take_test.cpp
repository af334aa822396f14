// Timelines of recordings that begin in the middle of a run.

#include <filesystem>

#include <doctest/doctest.h>

#include "edit/edit_actions.hpp"
#include "session/asking_run.hpp"
#include "takes/timeline_frames.hpp"

namespace midway_take_test {

using namespace nendo;
using namespace nendo::session;
using namespace nendo::session::asking;

TEST_SUITE("midway_take") {
  TEST_CASE(
      "a recording that begins in the middle of a run becomes a timeline of its first shape") {
    Run run;
    Asker asker(Changes{{}, {flow::SetRecording{true}}, {}, {}});
    asker.min_ticks = 60;
    const auto outcome = run.follow({&asker});
    REQUIRE(outcome.recordings.size() == 1);
    edit::MakeOptions options;
    options.take = outcome.recordings[0].file;
    options.out = (run.folder.path() / "take.timeline.toml").string();
    options.tolerance = "0mm";
    auto made = edit::timeline_of_take(options);
    REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
    CHECK(made->first_shape == (run.folder.path() / "take.first.ply").string());
    CHECK(made->made.timeline.mesh == made->first_shape);
    const auto first = deform::read_mesh(made->first_shape);
    REQUIRE(first);
    CHECK((first->vertices - run.mesh.vertices).cwiseAbs().maxCoeff() > 1e-3); // shaped before
    auto frames = takes::TimelineFrames::make(made->made.timeline, made->model);
    REQUIRE(frames);
    while ((*frames)->next()) {
    }
    const auto last = deform::read_mesh(run.options.out);
    REQUIRE(last);
    const auto played = (*frames)->player().final_shape();
    REQUIRE(played.cols() == last->vertices.cols());
    CHECK((first->vertices - last->vertices).cwiseAbs().maxCoeff() > 1e-3); // shaped by the take
    CHECK((played - last->vertices).cwiseAbs().maxCoeff() < 1e-3);

    // One that begins with its model needs no such file.
    Run whole;
    whole.options.recording.file = (whole.folder.path() / "whole.nendo").string();
    REQUIRE(whole.options.recording.check(whole.options.out, flow::SwitchAction::none));
    Asker onlooker(Changes{{}});
    options.take = whole.follow({&onlooker}).recordings.at(0).file;
    options.out = (whole.folder.path() / "whole.timeline.toml").string();
    made = edit::timeline_of_take(options);
    REQUIRE(made);
    CHECK(made->first_shape.empty());
    CHECK_FALSE(std::filesystem::exists(whole.folder.path() / "whole.first.ply"));
  }
}

} // namespace midway_take_test
