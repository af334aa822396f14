#include <csignal>
#include <thread>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/json_lines.hpp"
#include "support/program.hpp"

namespace recording_command_test {

using namespace nendo;
using nendo::test::contents;
using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nendo::test::TemporaryFolder;
using nlohmann::json;

namespace {

using Arguments = std::vector<std::string>;

Arguments joined(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// A folder with a short recorded run in it.
struct RecordedRun {
  TemporaryFolder folder;
  std::string take = path("take.nendo");
  std::string shape = path("clay.obj");
  test::Finished done;

  explicit RecordedRun(const Arguments& more = {})
      : done(test::nendo(joined({"run", "--left", "sim", "--right", "sim:grasp", "--duration", "1",
                                 "--json", "--out", shape, "--record", take},
                                more))) {
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
};

} // namespace

TEST_SUITE("recording_command") {
  TEST_CASE("a run that was recorded replays to the same shape, to the byte, in both modes") {
    for (const std::string mode : {"type1", "type2"}) {
      const RecordedRun run({"--mode", mode, "--filter", "one-euro"});
      const json recorded = last_object(run.done)["recordings"][0];
      CHECK(recorded["lost"] == 0);
      CHECK(recorded["failed"] == false);
      CHECK(recorded["bytes"] == std::filesystem::file_size(run.take));
      const std::string again = run.path("again.obj");
      const auto replayed =
          test::nendo({"replay", run.take, "--no-clock", "--json", "--out", again});
      CAPTURE(replayed.err);
      CHECK(replayed.exit_code == 0);
      CHECK(last_object(replayed)["same_shape"] == true);
      CHECK(last_object(replayed)["ticks"] == recorded["ticks"]);
      CHECK(contents(again) == contents(run.shape));
    }
  }

  TEST_CASE("with a clock a replay takes its time, faster or slower, from here to there") {
    const RecordedRun run;
    const auto twice = test::nendo({"replay", run.take, "--speed", "2", "--json"});
    CHECK(twice.exit_code == 0);
    CHECK(last_object(twice)["same_shape"] == true);
    CHECK(last_object(twice)["elapsed_s"].get<double>() > 0.4);
    const auto part = test::nendo({"replay", run.take, "--from", "0.4", "--to", "0.7", "--json"});
    CHECK(part.exit_code == 0);
    const json report = last_object(part);
    CHECK(report["to_the_end"] == false);
    CHECK(report["exact"] == true);
    CHECK(report["same_shape"] == nullptr);
    CHECK(report["elapsed_s"].get<double>() > 0.2);
    CHECK(report["ticks"].get<int>() > 0);
    CHECK(report["ticks"].get<int>() < 90);
  }

  TEST_CASE("a recording is a glove: monitor, run and stress take it, with its calibration") {
    const RecordedRun run({"--hand-length", "205"});
    const auto seen = test::nendo(
        {"monitor", "replay:" + run.take + "?hand=left&speed=4", "--json", "--count", "20"});
    CHECK(seen.exit_code == 0);
    CHECK(lines_of(seen.out).size() == 20);
    CHECK(last_object(seen)["hand"] == "left");
    const auto shaped = test::nendo({"run", "--right", "replay:" + run.take + "?loop=yes",
                                     "--duration", "1", "--json", "--out", run.path("b.obj")});
    CAPTURE(shaped.err);
    CHECK(shaped.exit_code == 0);
    CHECK(last_object(shaped)["right"]["hand_length_mm"].get<double>() == doctest::Approx(205.0));
    CHECK(last_object(shaped)["right"]["samples"].get<int>() > 10);
    const auto stressed =
        test::nendo({"stress", "--right", "replay:" + run.take + "?loop=yes", "-D", "1", "--json"});
    CAPTURE(stressed.err);
    CHECK(stressed.exit_code == 0);
  }

  TEST_CASE("nendo record takes samples without a loop, and info reports them") {
    const TemporaryFolder folder;
    const std::string take = (folder.path() / "gloves.nendo").string();
    const auto done = test::nendo({"record", "sim:wave?hand=left", "sim:pinch?rate=50", "--out",
                                   take, "--duration", "1s", "--json"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const auto report = test::nendo({"recording", "info", take, "--json"});
    CHECK(report.exit_code == 0);
    const json info = last_object(report);
    CHECK(info["whole"] == true);
    CHECK(info["ended"] == true);
    CHECK(info["loop"] == nullptr);
    CHECK(info["gaps"] == 0);
    REQUIRE(info["gloves"].size() == 2);
    CHECK(info["gloves"][0]["hand"] == "left");
    CHECK(info["gloves"][1]["source"] == "sim:pinch?rate=50");
    CHECK(info["gloves"][0]["samples"].get<int>() + info["gloves"][1]["samples"].get<int>() ==
          last_object(done)["samples"]);
    const auto replayed = test::nendo({"replay", take});
    CHECK(replayed.exit_code == 5);
    CHECK(is_one_line_about(replayed.err, "replay:FILE"));
    CHECK(
        test::nendo({"record", "sim", "sim", "--out", take + "2", "--duration", "1s"}).exit_code ==
        2);
  }

  TEST_CASE("check finds damage, repair saves the rest, cut makes a part") {
    const RecordedRun run;
    CHECK(test::nendo({"recording", "check", run.take}).exit_code == 0);
    std::string bytes = contents(run.take);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    const std::string bad = run.path("bad.nendo");
    test::write_file(bad, bytes);
    const auto checked = test::nendo({"recording", "check", bad});
    CHECK(checked.exit_code == 1);
    CHECK(is_one_line_about(checked.err, "repair"));
    CHECK(checked.out.find("at byte") != std::string::npos);
    const std::string mended = run.path("mended.nendo");
    const auto repaired = test::nendo({"recording", "repair", bad, "--out", mended});
    CHECK(repaired.exit_code == 0);
    CHECK(repaired.out.find("intact chunks") != std::string::npos);
    CHECK(repaired.out.find(" 0 intact chunks") == std::string::npos);
    CHECK(is_one_line_about(repaired.err, "gap"));
    CHECK(test::nendo({"recording", "check", mended}).exit_code == 0);
    CHECK(checked.err.find("behind") == std::string::npos);
    CHECK(checked.err.find("intact, to the end") != std::string::npos);
    test::write_file(bad, bytes.substr(0, bytes.size() - 1));
    const auto cut = test::nendo({"recording", "check", bad});
    CHECK(cut.exit_code == 1);
    CHECK(cut.err.find("nothing is intact after byte ") != std::string::npos);
    CHECK(cut.err.find(" of " + std::to_string(bytes.size() - 1)) != std::string::npos);
    test::write_file(bad, bytes);
    const auto copied =
        test::nendo({"recording", "repair", run.take, "--out", run.path("copy.nendo")});
    CHECK(copied.exit_code == 0);
    CHECK(copied.out.find(" 0 intact chunks") == std::string::npos);
    CHECK(is_one_line_about(copied.err, ": was intact"));
    CHECK(contents(run.path("copy.nendo")).size() == contents(run.take).size());
    CHECK(contents(bad) == bytes);
    const auto replayed = test::nendo({"replay", mended, "--no-clock", "--json"});
    CHECK(replayed.exit_code == 0);
    CHECK(last_object(replayed)["exact"] == false);
    const std::string part = run.path("part.nendo");
    CHECK(test::nendo({"recording", "cut", run.take, "--to", "0.5", "--out", part}).exit_code == 0);
    const auto beginning = test::nendo({"replay", part, "--no-clock", "--json"});
    CHECK(last_object(beginning)["exact"] == true);
    CHECK(test::nendo({"recording", "repair", bad, "--out", mended}).exit_code == 1); // is there
    const auto shaped = run.path("shaped.nendo");
    CHECK(
        test::nendo({"recording", "shapes", run.take, "--rate", "20", "--out", shaped}).exit_code ==
        0);
    const auto again = last_object(test::nendo({"replay", shaped, "--no-clock", "--json"}));
    CHECK(again["shapes"] > 5);
    CHECK(again["farthest_from_shapes"] < 1e-6);
    CHECK(again["same_shape"] == true);
    CHECK(test::nendo({"recording", "shapes", run.take, "--rate", "nan", "--out", shaped})
              .exit_code == 2);
  }

  TEST_CASE("a program that is killed leaves a recording that is whole up to the last second") {
    const TemporaryFolder folder;
    const std::string take = (folder.path() / "take.nendo").string();
    test::Program program(
        {"run", "--right", "sim", "--out", (folder.path() / "a.obj").string(), "--record", take});
    REQUIRE(test::appears(take));
    const auto empty = std::filesystem::file_size(take);
    for (int turn = 0; turn < 2000 && std::filesystem::file_size(take) < empty + 10'000; ++turn)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    program.signal(SIGKILL);
    program.wait();
    const auto checked = test::nendo({"recording", "check", take});
    CHECK(checked.exit_code == 0);
    CHECK(checked.out.find("cut off") != std::string::npos);
    CHECK(test::nendo({"replay", take, "--no-clock"}).exit_code == 0);
    const auto mended =
        test::nendo({"recording", "repair", take, "--out", (folder.path() / "m.nendo").string()});
    CHECK(mended.exit_code == 0);
    CHECK(mended.out.find(" 0 intact chunks") == std::string::npos);
    CHECK(is_one_line_about(mended.err, ": was intact"));
  }

  TEST_CASE("a recording cut off before its first chunk is no recording of 1970") {
    const RecordedRun run;
    const std::string bytes = contents(run.take);
    const std::string cut = run.path("cut.nendo");
    for (const std::size_t size : {16U, 20U, 40U, 60U}) {
      test::write_file(cut, bytes.substr(0, size));
      for (const Arguments& arguments :
           {Arguments{"recording", "info", cut},
            {"recording", "info", cut, "--json"},
            {"recording", "check", cut},
            {"replay", cut, "--no-clock"},
            {"monitor", "replay:" + cut},
            {"recording", "repair", cut, "--out", run.path("mended.nendo")}}) {
        const auto done = test::nendo(arguments);
        CAPTURE(size);
        CAPTURE(done.out);
        CHECK(done.exit_code == 5);
        CHECK(is_one_line_about(done.err, "cut.nendo"));
        CHECK(done.out.empty());
      }
    }
    std::string headless = bytes;
    headless[50] = static_cast<char>(headless[50] ^ 1); // in the chunk that reports when it was
    test::write_file(cut, headless);
    const auto report = test::nendo({"recording", "info", cut});
    CHECK(report.exit_code == 0);
    CHECK(report.out.find("1970") == std::string::npos);
    CHECK(last_object(test::nendo({"recording", "info", cut, "--json"}))["begun"].is_null());
  }

  TEST_CASE("--keep-last: a crash writes what was done last") {
    const TemporaryFolder folder;
    const auto kept = folder.path() / "clay.crash.nendo";
    test::Program program({"run", "--right", "sim", "--out", (folder.path() / "clay.obj").string(),
                           "--record", (folder.path() / "take.nendo").string(), "--keep-last",
                           "60s"});
    REQUIRE(test::appears(folder.path() / "take.nendo"));
    // Its description is written before the first tick, and chunks of ticks after that.
    const auto size = [&] { return std::filesystem::file_size(folder.path() / "take.nendo"); };
    for (int growth = 0; growth < 2; ++growth) {
      const auto before = size();
      for (int turn = 0; turn < 2000 && size() == before; ++turn)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    program.signal(SIGSEGV);
    const auto done = program.wait();
    CHECK(done.exit_code == 128 + SIGSEGV);
    CHECK(done.err.find(kept.string()) != std::string::npos);
    CHECK(test::nendo({"recording", "check", kept.string()}).exit_code == 0);
    const auto info = last_object(test::nendo({"recording", "info", kept.string(), "--json"}));
    CHECK(info["loop"]["ticks"].get<int>() > 0);
  }

  TEST_CASE("what cannot be: one line, and the right exit code") {
    const RecordedRun run;
    struct Refused {
      Arguments arguments;
      int exit_code;
      std::string about;
    };
    const std::string text = run.path("text");
    test::write_file(text, "v 0 0 0\n");
    const std::string empty = run.path("empty");
    test::write_file(empty, "");
    const std::string moved = run.path("moved.obj");
    test::write_file(moved, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (const Refused& refused : std::vector<Refused>{
             {{"run", "--right", "sim", "--record", run.take, "--out", run.shape}, 1, "--record"},
             {{"run", "--right", "sim", "--record", "/nowhere/a", "--duration", "1", "--out",
               run.shape},
              1,
              "/nowhere/a"},
             {{"run", "--right", "sim", "--keep-last", "soon", "--out", run.shape}, 2, "--keep"},
             {{"run", "--right", "sim", "--switch", "keep", "--out", run.shape}, 2, "--keep-last"},
             {{"replay", text}, 5, "no recording"},
             {{"replay", empty}, 5, "empty"},
             {{"replay", "/dev/zero"}, 5, "/dev/zero"},
             {{"replay", run.folder.path().string()}, 5, "regular file"},
             {{"replay", run.take, "--speed", "0"}, 2, "--speed"},
             {{"replay", run.take, "--from", "3", "--to", "2"}, 2, "--from"},
             {{"replay", run.take, "--from", "99", "--no-clock"}, 2, "--from 99"},
             {{"replay", run.take, "--loop", "--no-clock"}, 2, "--loop"},
             {{"replay", run.take, "--out", "shape.fbx"}, 2, ".obj, .ply or .stl"},
             {{"replay", run.take, "--no-clock", "--mesh", "/nowhere.obj"}, 5, "/nowhere.obj"},
             {{"recording", "info", text}, 5, "no recording"},
             {{"recording", "check", run.path("none")}, 5, "none"},
             {{"recording", "repair", text, "--out", run.path("x")}, 5, "nothing"},
             {{"recording", "cut", run.take, "--from", "90", "--out", run.path("y")}, 5, "info"},
             {{"recording", "repair", run.take, "--out", "/nowhere/x"}, 1, "--out /nowhere/x"},
             {{"recording", "cut", run.take, "--out", "/nowhere/x"}, 1, "--out /nowhere/x"},
             {{"recording", "shapes", run.take, "--out", "/nowhere/x"}, 1, "--out /nowhere/x"},
             {{"edit", "make", run.take, "--out", "/nowhere/x.timeline.toml"}, 1, "--out /nowhere"},
             {{"edit", "make", run.take, "--out", "x.toml"}, 2, ".timeline.toml"},
             {{"deform", moved, "--vectors", text, "--out", "/nowhere/x.obj"}, 1, "--out /nowhere"},
             {{"record", "sim", "--out", run.take}, 1, "--out"},
             {{"monitor", "replay:" + text}, 5, "no recording"}}) {
      const auto done = test::nendo(refused.arguments);
      CAPTURE(refused.arguments.front());
      CAPTURE(refused.about);
      CAPTURE(done.err);
      CHECK(done.exit_code == refused.exit_code);
      CHECK(is_one_line_about(done.err, refused.about));
    }
  }
}

} // namespace recording_command_test
