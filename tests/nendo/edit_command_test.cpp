#include <cstdlib>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "render/image.hpp"
#include "support/eventually.hpp"
#include "support/memory_screen.hpp"
#include "support/program.hpp"
#include "support/restraint.hpp"
#include "timeline/timeline.hpp"

namespace edit_command_test {

using namespace nendo;
using nendo::test::contents;
using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nendo::test::TemporaryFolder;
using nlohmann::json;

namespace {

using Arguments = std::vector<std::string>;

/// A folder with a short recorded run in it, and a timeline of that.
struct EditedRun {
  TemporaryFolder folder;
  std::string take = path("take.nendo");
  std::string shape = path("clay.obj");
  std::string timeline = path("take.timeline.toml");
  json made;

  explicit EditedRun(const std::string& mode, const std::string& tolerance) {
    const auto run =
        test::nendo({"run", "--left", "sim", "--right", "sim:grasp", "--duration", "1", "--rate",
                     "20", "--mode", mode, "--out", shape, "--record", take});
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    made = json::parse(fine({"make", take, "--out", timeline, "--tolerance", tolerance, "--json"}));
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }

  static test::Finished edit(Arguments arguments) {
    arguments.insert(arguments.begin(), "edit");
    return test::nendo(arguments);
  }
  /// What it printed; it must end well.
  static std::string fine(const Arguments& arguments) {
    const auto done = edit(arguments);
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    return done.out;
  }
  json shown(const std::string& file) const { return json::parse(fine({"show", file, "--json"})); }
};

double farthest(const std::string& one, const std::string& other) {
  const auto mesh = deform::read_mesh(one);
  const auto other_mesh = deform::read_mesh(other);
  REQUIRE(mesh);
  REQUIRE(other_mesh);
  return (mesh->vertices - other_mesh->vertices).colwise().norm().maxCoeff();
}

} // namespace

TEST_SUITE("edit_command") {
  TEST_CASE("a run with a puppet is edited: its functions are listed, set and mirrored") {
    const TemporaryFolder folder;
    const auto path = [&](const char* name) { return (folder.path() / name).string(); };
    const std::string take = path("face.nendo"), file = path("face.timeline.toml");
    const auto run = test::nendo({"run", "--puppet", "face", "--left", "sim:faces", "--right",
                                  "sim:faces", "--duration", "2.2", "--rate", "30", "--out",
                                  path("face.obj"), "--record", take});
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    const auto played = [&](const std::string& of) {
      EditedRun::fine({"play", of, "--out", path("played.ply")});
      return path("played.ply");
    };
    EditedRun::fine({"make", take, "--out", file, "--tolerance", "0mm"});
    CHECK(farthest(played(file), path("face.obj")) < 1e-5); // which has six digits
    const json made = json::parse(
        EditedRun::fine({"make", take, "--out", file, "--tolerance", "10mm", "--json"}));
    CHECK(made["left"]["max_point_mm"].get<double>() <= 5.0);
    const auto functions = [&](const std::string& of) {
      return json::parse(EditedRun::fine({"show", of, "--functions", "--json"}))["functions"];
    };
    const std::string table = EditedRun::fine({"show", file, "--functions"});
    CHECK(table.find("at rest") != std::string::npos);
    const json before = functions(file);
    std::size_t named = 0; // which faces the run met depends on when it began
    for (const auto& key : before)
      for (const auto& [function, value] : key["values"].items())
        if (value.get<double>() > 0.5) {
          const char* const digit = value.get<double>() < 0.995 ? " 0." : " 1.";
          CHECK(table.find(function + digit) != std::string::npos);
          ++named;
        }
    CHECK(named > 0);
    EditedRun::fine({"mirror", file, "--out", path("mirrored.timeline.toml")});
    const json after = functions(path("mirrored.timeline.toml"));
    REQUIRE(after.size() == before.size());
    CHECK(after.back()["values"]["mouthSmileRight"] == before.back()["values"]["mouthSmileLeft"]);
    CHECK(after.back()["values"]["jawOpen"] == before.back()["values"]["jawOpen"]);
    const std::string said = EditedRun::fine(
        {"set-value", file, "--function", "mouthSmileLeft", "--key", "2", "--to", "0.5"});
    CHECK(said.find("mouthSmileLeft is 0.500 at key 2") != std::string::npos);
    CHECK(functions(file) != before);
    for (const auto& [arguments, about] :
         {std::pair{Arguments{"set-value", file, "--function", "grin", "--key", "1", "--to", "0.5"},
                    "'grin'"},
          std::pair{
              Arguments{"set-value", file, "--function", "jawOpen", "--key", "1", "--to", "7"},
              "jawOpen goes from"}}) {
      const auto refused = EditedRun::edit(arguments);
      CHECK(refused.exit_code == 2);
      CHECK(is_one_line_about(refused.err, about));
    }
    EditedRun::fine({"show", file});
  }

  TEST_CASE("a recorded run is made into keys that play to its shape") {
    for (const std::string mode : {"type1", "type2"}) {
      CAPTURE(mode);
      const EditedRun run(mode, "0mm");
      CHECK(run.made["exact"] == true);
      CHECK(run.made["left"]["max_tip_mm"] == 0.0);
      const std::string played = run.path("played.obj");
      const json report = json::parse(run.fine({"play", run.timeline, "--out", played, "--json"}));
      CHECK(report["frames"].get<int>() >= run.made["left"]["frames"].get<int>());
      CHECK(report["failed"] == 0);
      // A stroke of type 2 is sampled at deadlines, that the live loop missed.
      if (mode == "type1" || report["frames"] == run.made["left"]["frames"])
        CHECK(farthest(played, run.shape) < 1e-4);
    }
  }

  TEST_CASE(
      "keys are shown, moved, copied, deleted and brought to a place, and the file with them") {
    const EditedRun run("type1", "2mm");
    const json before = run.shown(run.timeline);
    const auto& keys = before["hands"]["right"];
    REQUIRE(keys.size() >= 3);
    CHECK(run.made["right"]["max_tip_mm"].get<double>() <= 2.0);
    CHECK(keys[0]["angles_rad"].size() == 23);
    CHECK(lines_of(run.fine({"show", run.timeline, "--finger", "index"})).size() >=
          3 + keys.size());
    const std::string other = run.path("other.timeline.toml");
    const double to_s = keys[1]["time_s"].get<double>() + 0.001;
    const std::string at = std::to_string(to_s);
    run.fine({"copy", run.timeline, "--hand", "right", "--key", "1", "--to", at, "--out", other});
    CHECK(run.shown(run.timeline) == before); // it went elsewhere
    const std::string late = std::to_string(before["duration_s"].get<double>() + 0.02);
    const auto near_end = EditedRun::edit({"copy", run.timeline, "--hand", "right", "--key", "1",
                                           "--to", late, "--out", run.path("late.timeline.toml")});
    CHECK(near_end.exit_code == 0);
    CHECK(is_one_line_about(near_end.err, "after the end"));
    CHECK(run.shown(other)["hands"]["right"].size() == keys.size() + 1);
    run.fine({"delete", other, "--hand", "right", "--key", "1"});
    run.fine({"move", other, "--hand", "right", "--key", "1", "--to", keys[1]["time_s"].dump()});
    CHECK(run.shown(other)["hands"] == before["hands"]);
    const auto tip = keys[2]["tips"]["index"];
    const std::string place = tip[0].dump() + "," + tip[1].dump() + "," + tip[2].dump();
    run.fine({"set-tip", other, "--hand", "right", "--key", "1", "--finger", "index", "--to", place,
              "--within", "500"});
    const json set = run.shown(other)["hands"]["right"][1];
    CHECK(set["tips"]["thumb"] == keys[1]["tips"]["thumb"]);
    CHECK(set["tips"]["index"] != keys[1]["tips"]["index"]);
    run.fine({"retime", other, "--scale", "2"});
    CHECK(run.shown(other)["duration_s"] == 2.0 * before["duration_s"].get<double>());
    run.fine({"blend", other, "--with", run.timeline, "--factor", "1"});
    run.fine({"add", other, "--hand", "left", "--at", "0.0123"});
    run.fine({"blend", other, "--hand", "left", "--key", "1", "--factor", "0.5"});
    run.fine({"mirror", other});
    CHECK(run.shown(other)["hands"]["right"].size() > before["hands"]["left"].size());
    const std::string picture = run.path("other.png");
    const auto drawn =
        test::nendo({"picture", other, "--time", "1", "--pixels", "96x96", "--out", picture});
    CAPTURE(drawn.err);
    CHECK(drawn.exit_code == 0);
    CHECK(contents(picture).substr(1, 3) == "PNG");
  }

  TEST_CASE("the last frame is played, and what is due there, by play and export alike") {
    const EditedRun run("type1", "2mm");
    auto timeline = timeline::read_timeline(run.timeline);
    REQUIRE(timeline);
    timeline->duration_s = 0.6; // frame 12 of 20 a second, but for rounding
    timeline->held = true;
    timeline->events = {{0.6, flow::Request::release}};
    REQUIRE(timeline::write_timeline(run.timeline, *timeline));
    const json all = json::parse(run.fine({"play", run.timeline, "--json"}));
    CHECK(all["frames"] == 13);
    CHECK(all["commits"] == 1);
    for (const auto& [until, frames] : {std::pair{"0.55", 12}, {"0.6", 13}, {"0.3", 7}}) {
      const json report = json::parse(run.fine({"play", run.timeline, "--until", until, "--json"}));
      CHECK(report["frames"] == frames);
    }
    const auto exported =
        test::nendo({"export", run.timeline, "--out", run.path("a.csv"), "--rate", "20", "--json"});
    CHECK(json::parse(exported.out)["frames"] == 13);
  }

  TEST_CASE("a play that is stopped is no success, and the file that was there stays") {
    const EditedRun run("type2", "2mm");
    run.fine({"retime", run.timeline, "--scale", "1000"});
    const std::string played = run.path("played.obj");
    test::write_file(played, "old");
    test::Program playing({"edit", "play", run.timeline, "--out", played});
    REQUIRE(playing.gets_handler_of(SIGINT));
    playing.signal(SIGINT);
    const auto done = playing.wait();
    CHECK(done.exit_code == 1);
    CHECK(is_one_line_about(done.err, "stopped before the end"));
    CHECK(contents(played) == "old");
  }

  TEST_CASE("what cannot be is one line that names the file, and the file stays") {
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    const EditedRun run("type1", "2mm");
    const std::string before = contents(run.timeline);
    const auto refuses = [&](const Arguments& arguments, const std::string& about) {
      const auto done = EditedRun::edit(arguments);
      CAPTURE(done.err);
      CHECK(done.exit_code != 0);
      CHECK(is_one_line_about(done.err, about));
      CHECK(contents(run.timeline) == before);
    };
    const std::string& file = run.timeline;
    refuses({"move", file, "--hand", "left", "--key", "999", "--to", "0.5"}, "take.timeline.toml");
    refuses({"move", file, "--hand", "left", "--key", "0", "--to", "1.2"}, "lasts from 0 to ");
    refuses({"move", file, "--hand", "upper", "--key", "0", "--to", "0.5"}, "upper");
    refuses({"delete", file, "--hand", "left", "--key", "0", "--out", "x.toml"}, "x.toml");
    refuses({"retime", file, "--scale", "-1"}, "take.timeline.toml");
    refuses({"set-tip", file, "--hand", "left", "--key", "0", "--finger", "index", "--to", "1,2"},
            "1,2");
    refuses({"set-tip", file, "--hand", "left", "--key", "0", "--finger", "index", "--to",
             "100,100,100"},
            "out of reach");
    refuses({"blend", file}, "--with");
    refuses({"make", run.take, "--out", run.path("a.timeline.toml"), "--tolerance", "1"}, "1mm");
    refuses({"play", run.take}, "take.nendo");
    refuses({"play", file, "--until", "99"}, "--until");
    refuses({"play", file, "--speed", "-1"}, "--speed");
    refuses({"show", run.path("none.timeline.toml")}, "none.timeline.toml");
#ifdef NENDO_WINDOW
    refuses({"view", run.path("none.timeline.toml")}, "none.timeline.toml");
    refuses({"view", run.take}, "take.nendo: a timeline's name ends in .timeline.toml");
    refuses({"view", file, "--out", "x.toml"}, "--out x.toml");
    refuses({"view", file, "--out", "/nowhere/x.timeline.toml"}, "--out /nowhere");
    refuses({"view", file, "--at", "99"}, "--at");
    refuses({"view", file, "--key", "1"}, "--hand");
    refuses({"view", file, "--key", "999", "--hand", "left"}, "999");
    refuses({"view", file, "--screenshot", "x.jpg"}, "--screenshot");
#endif
    refuses({"view", file}, "nendo picture"); // for want of a screen
  }

  TEST_CASE("at a speed it takes as long as people see it") {
    const EditedRun run("type1", "5mm");
    const json slow =
        json::parse(run.fine({"play", run.timeline, "--until", "0.8", "--speed", "2", "--json"}));
    CHECK(slow["elapsed_s"].get<double>() > 0.35);
    CHECK(slow["elapsed_s"].get<double>() < 30.0);
    const json fast = json::parse(run.fine({"play", run.timeline, "--until", "0.8", "--json"}));
    CHECK(fast["crc32c"] == slow["crc32c"]);
    CHECK(fast["frames"] == slow["frames"]);
  }

#ifdef NENDO_WINDOW
  TEST_CASE("the window shows the moment that is asked for, and leaves the file alone") {
    const nendo::test::MemoryScreen screen;
    // Mesa's own memory is not for our sanitizers, in a child either.
    if (!screen.is_there() || !nendo::test::restraint_is_counted) return;
    const EditedRun run("type1", "5mm");
    const std::string before = contents(run.timeline);
    const auto picture = [&](const std::string& name, const Arguments& more) {
      Arguments arguments{"view", run.timeline, "--frames", "2", "--screenshot", run.path(name)};
      arguments.insert(arguments.end(), more.begin(), more.end());
      run.fine(arguments);
      const auto image = render::read_png(run.path(name));
      REQUIRE(image);
      return *image;
    };
    const auto begin = picture("begin.png", {"--at", "0"});
    CHECK(picture("again.png", {"--at", "0"}) == begin);
    CHECK_FALSE(picture("later.png", {"--at", "0.9"}) == begin);
    CHECK_FALSE(picture("key.png", {"--hand", "right", "--key", "0", "--at", "0"}) == begin);
    CHECK(contents(run.timeline) == before);

    const std::string last = run.path("last.png");
    test::Program looking({"edit", "view", run.timeline, "--screenshot", last});
    REQUIRE(looking.gets_handler_of(SIGTERM));
    looking.signal(SIGTERM);
    CHECK(looking.wait().exit_code == 0);
    CHECK(render::read_png(last));
  }
#endif
}

} // namespace edit_command_test
