#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "support/csv_table.hpp"
#include "support/glb_reader.hpp"
#include "support/program.hpp"

namespace export_command_test {

using namespace nendo;
using nendo::test::contents;
using nendo::test::is_one_line_about;
using nlohmann::json;

namespace {

/// A folder with a short recorded run in it.
struct RecordedRun {
  explicit RecordedRun(const std::string& mode) {
    const auto done = test::nendo({"run", "--left", "sim:pinch", "--right", "sim:grasp", "--mode",
                                   mode, "--duration", "1", "--out", path("clay.ply"), "--record",
                                   path("take.nendo"), "--no-injective"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  test::Finished export_to(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"export", path("take.nendo"), "--out", path(out), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::nendo(arguments);
  }
  test::TemporaryFolder folder;
};

} // namespace

TEST_SUITE("export_command") {
  TEST_CASE("a brush that moves the shape without fields counts as no undo") {
    const test::TemporaryFolder folder;
    const auto at = [&](const char* name) { return (folder.path() / name).string(); };
    const auto run = test::nendo({"run", "--left", "sim:grasp", "--mode", "type2", "--brush",
                                  "inflate", "--duration", "0.5", "--out", at("clay.ply"),
                                  "--record", at("take.nendo"), "--json"});
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    REQUIRE(test::nendo({"export", at("take.nendo"), "--out", at("take.csv")}).exit_code == 0);
    auto table = test::csv_columns(contents(at("take.csv")));
    REQUIRE(table["undos"].size() > 10);
    for (const std::string& undos : table["undos"])
      CHECK(undos == "0");
  }

  TEST_CASE("every format of a run comes out, and the last frame is the run's own shape") {
    const RecordedRun run("type1");
    const auto shape = deform::read_mesh(run.path("clay.ply"));
    REQUIRE(shape);
    const double near = 1e-5 * deform::diagonal_of(shape->vertices);
    const auto done = run.export_to("take.glb", {"--every-frame"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const json report = json::parse(done.out);
    CHECK(report["morphs"]["by"] == "control vectors");
    CHECK(report["morphs"]["greatest_error"].get<double>() < 1e-5);
    CHECK(report["frames"].get<int>() > 10);
    CHECK_FALSE(report.contains("rate_hz"));
    const test::Glb glb(contents(run.path("take.glb")));
    CHECK((glb.vertices(0, 1e6) - shape->vertices).colwise().norm().maxCoeff() < near);
    for (const std::string out : {"a.pc2", "a.mdd", "hands.bvh", "a.csv", "a.mcap", "a-%03d.obj"}) {
      const auto other = run.export_to(out);
      CAPTURE(other.err);
      CHECK(other.exit_code == 0);
      CHECK(std::filesystem::exists(json::parse(other.out)["result"].get<std::string>()));
    }
    CHECK(run.export_to("cache.dat", {"--format", "pc2", "--rate", "10"}).exit_code == 0);
    CHECK(contents(run.path("cache.dat")).starts_with("POINTCACHE2"));
    const auto plain = test::nendo({"export", run.path("take.nendo"), "--out", run.path("b.glb")});
    CHECK(plain.out.find(" morph targets of the control vectors") != std::string::npos);
  }

  TEST_CASE("every format says whether something was missing in the recording") {
    const RecordedRun run("type1");
    const std::string whole = contents(run.path("take.nendo"));
    std::string damaged = whole;
    const std::size_t input_log = damaged.find("TAPE");
    REQUIRE(input_log != std::string::npos);
    damaged[input_log + 40] = static_cast<char>(damaged[input_log + 40] ^ 1);
    for (const std::string out :
         {"a.glb", "a.pc2", "a.mdd", "hands.bvh", "a.csv", "a.mcap", "a-%03d.obj"}) {
      CAPTURE(out);
      test::write_file(run.path("take.nendo"), whole);
      const auto exact = run.export_to(out);
      REQUIRE(exact.exit_code == 0);
      CHECK(exact.err.empty());
      CHECK(json::parse(exact.out)["exact"] == true);
      test::write_file(run.path("take.nendo"), damaged);
      const auto other = run.export_to(out);
      REQUIRE(other.exit_code == 0);
      CHECK(is_one_line_about(other.err, "something is missing"));
      CHECK(json::parse(other.out)["exact"] == false);
    }
  }

  TEST_CASE("Type-2 keeps within its tolerance, and says so") {
    const RecordedRun run("type2");
    const auto done = run.export_to("take.glb", {"--tolerance", "1e-3", "--no-hands"});
    REQUIRE(done.exit_code == 0);
    const json report = json::parse(done.out);
    CHECK(report["morphs"]["by"] == "key shapes");
    CHECK(report["morphs"]["greatest_error"].get<double>() < 1.01e-3);
    CHECK_FALSE(test::Glb(contents(run.path("take.glb"))).json.contains("skins"));
  }

  TEST_CASE("what was chosen for an animator is said, and a millimetre is the same part of all") {
    const RecordedRun run("type2");
    const auto plain = test::nendo({"export", run.path("take.nendo"), "--out", run.path("a.glb")});
    CAPTURE(plain.out);
    CHECK(plain.out.find("24 per second (--rate)") != std::string::npos);
    CHECK(plain.out.find("1 % of the model's diagonal") != std::string::npos);
    CHECK(plain.out.find("(--tolerance)") != std::string::npos);
    const json report = json::parse(run.export_to("b.glb").out);
    CHECK(contents(run.path("a.glb")) == contents(run.path("b.glb")));
    CHECK(report["rate_hz"] == 24.0);
    CHECK(report["morphs"]["tolerance"] == doctest::Approx(0.01));
    CHECK(report["frames"].get<int>() >= 20);
    CHECK(report["frames"].get<int>() <= 26);
    const json percent = json::parse(run.export_to("c.glb", {"--tolerance", "0.2%"}).out);
    CHECK(percent["morphs"]["tolerance"] == doctest::Approx(0.002));
    const json millimetre = json::parse(run.export_to("d.glb", {"--tolerance", "1mm"}).out);
    const json tenth = json::parse(run.export_to("e.glb", {"--tolerance", "0.01cm"}).out);
    CHECK(millimetre["morphs"]["tolerance"].get<double>() ==
          doctest::Approx(10.0 * tenth["morphs"]["tolerance"].get<double>()));
    // The longest side of the Moai's box is 0.8 m on the stage, so its diagonal is a little more.
    const double diagonal_m = 1e-3 / millimetre["morphs"]["tolerance"].get<double>();
    CHECK(diagonal_m > 0.8);
    CHECK(diagonal_m < 0.8 * 1.74);
  }

  TEST_CASE(
      "a run in which a wire cuts comes out with the cut's material, and so does a timeline") {
    const test::TemporaryFolder folder;
    const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
    const auto ran =
        test::nendo({"run", NENDO_MODELS "/moai.obj", "--mode", "parts", "--left", "sim:cut",
                     "--right", "sim:cut", "--wire", "0.8s:2.5s", "--duration", "3.5", "--out",
                     path("cut.obj"), "--record", path("cut.nendo")});
    CAPTURE(ran.err);
    REQUIRE(ran.exit_code == 0);
    CHECK(ran.err.find("the model has 2 parts now") != std::string::npos);
    const auto written = deform::read_mesh(path("cut.obj"));
    REQUIRE(written);
    CHECK(written->look.materials.back().name == "cut");
    const auto done = test::nendo({"export", path("cut.nendo"), "--out", path("cut.glb")});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const test::Glb glb(contents(path("cut.glb")));
    CHECK(glb.json["meshes"].size() == 4); // before, behind, and both hands
    const auto& materials = glb.json["materials"];
    CHECK(std::any_of(materials.begin(), materials.end(),
                      [](const json& material) { return material["name"] == "cut"; }));
    const auto made =
        test::nendo({"edit", "make", path("cut.nendo"), "--out", path("cut.timeline.toml")});
    CAPTURE(made.err);
    REQUIRE(made.exit_code == 0);
    const auto played =
        test::nendo({"edit", "play", path("cut.timeline.toml"), "--out", path("played.obj")});
    CAPTURE(played.err);
    REQUIRE(played.exit_code == 0);
    const auto again = deform::read_mesh(path("played.obj"));
    REQUIRE(again);
    REQUIRE(again->vertices.cols() == written->vertices.cols());
    CHECK((again->vertices - written->vertices).cwiseAbs().maxCoeff() <
          1e-4 * deform::diagonal_of(written->vertices)); // no one has moved a part yet
    CHECK(again->look.materials.back().name == "cut");
    const auto late =
        test::nendo({"run", "--wire", "5:6", "--duration", "1", "--out", path("none.obj")});
    CHECK(late.exit_code == 2);
    CHECK(is_one_line_about(late.err, "--wire 5:6: ends after the run"));
    for (const char* wrong : {"1s", "2s:1s", "x:2s", ":2s", "-1s:2s"}) {
      CAPTURE(wrong);
      const auto bad = test::nendo({"run", "--wire", wrong, "--out", path("none.obj")});
      CHECK(bad.exit_code == 2);
      CHECK(is_one_line_about(bad.err, "--wire"));
    }
  }

  TEST_CASE("a puppet's targets are named, and where they cannot be, that is said") {
    const test::TemporaryFolder folder;
    const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
    for (const std::string mode : {"type1", "type2"}) {
      CAPTURE(mode);
      const auto ran = test::nendo({"run", "--puppet", "face", "--left", "sim:faces", "--right",
                                    "sim:faces", "--mode", mode, "--duration", "1.5", "--out",
                                    path(mode + ".ply"), "--record", path(mode + ".nendo")});
      CAPTURE(ran.err);
      REQUIRE(ran.exit_code == 0);
      const auto done = test::nendo({"export", path(mode + ".nendo"), "--out", path("face.glb")});
      CAPTURE(done.out);
      REQUIRE(done.exit_code == 0);
      const bool named = done.out.find("12 morph targets, named after the puppet's functions") !=
                         std::string::npos;
      const bool says_why =
          done.out.find("not named after the puppet's functions, because") != std::string::npos;
      CHECK(named == (mode == "type1"));
      CHECK(says_why == (mode == "type2"));
      const test::Glb glb(contents(path("face.glb")));
      const std::vector<std::string> names = glb.json["meshes"][0]["extras"]["targetNames"];
      const auto is_there = std::count(names.begin(), names.end(), "mouthSmileLeft") == 1;
      CHECK(is_there == (mode == "type1"));
    }
  }

  TEST_CASE("what nendo record wrote comes out: every sample, and the hands") {
    const test::TemporaryFolder folder;
    const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
    const std::string take = path("rec.nendo");
    const json recorded = json::parse(test::nendo({"record", "sim:pinch?hand=left", "sim:grasp",
                                                   "--duration", "1s", "--out", take, "--json"})
                                          .out);
    const auto export_to = [&](const std::string& out, std::vector<std::string> more = {}) {
      std::vector<std::string> arguments{"export", take, "--out", path(out), "--json"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      return test::nendo(arguments);
    };
    const auto table = export_to("rec.csv");
    CAPTURE(table.err);
    REQUIRE(table.exit_code == 0);
    CHECK(table.err.empty()); // a simulated hand is what the default calibration is made for
    CHECK(json::parse(table.out)["frames"] == recorded["samples"]);
    const std::string text = contents(path("rec.csv"));
    CHECK(std::count(text.begin(), text.end(), '\n') ==
          1 + recorded["samples"].get<std::ptrdiff_t>());
    CHECK(text.find("index_mcp_count") != std::string::npos);
    CHECK(text.find("index_mcp_deg") != std::string::npos);
    CHECK(text.find("measured_s") != std::string::npos);
    REQUIRE(export_to("rec.bvh").exit_code == 0);
    CHECK(std::filesystem::exists(path("rec-left.bvh")));
    CHECK(std::filesystem::exists(path("rec-right.bvh")));
    REQUIRE(export_to("rec.glb").exit_code == 0);
    CHECK(test::Glb(contents(path("rec.glb"))).json["skins"].size() == 2);
    for (const std::string out : {"rec.pc2", "rec-%04d.obj"}) {
      const auto refused = export_to(out);
      CHECK(refused.exit_code == 5);
      CHECK(is_one_line_about(refused.err, "nendo run"));
    }
    CHECK(is_one_line_about(export_to("x.csv", {"--rate", "10"}).err, "--rate"));
  }

  TEST_CASE(
      "a replayed sample has its original times, those of the table, and when it came again") {
    const test::TemporaryFolder folder;
    const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
    // So long that a first sample that is late, on a busy machine, makes it little shorter.
    REQUIRE(
        test::nendo({"record", "sim", "--duration", "2s", "--out", path("rec.nendo")}).exit_code ==
        0);
    REQUIRE(test::nendo({"export", path("rec.nendo"), "--out", path("rec.csv")}).exit_code == 0);
    constexpr int samples = 160;
    const auto shown = test::nendo({"monitor", "replay:" + path("rec.nendo") + "?speed=4", "--json",
                                    "--raw", "--count", std::to_string(samples)});
    CAPTURE(shown.err);
    REQUIRE(shown.exit_code == 0);
    std::istringstream table(contents(path("rec.csv")));
    std::istringstream lines(shown.out);
    std::string row;
    std::string line;
    std::getline(table, row); // the head
    double base_s = 0.0;      // the host's clock at the beginning of the recording
    double first_replayed_s = 0.0;
    double recorded_s = 0.0; // from the first to the last
    for (int at = 0; at < samples; ++at) {
      REQUIRE(std::getline(table, row));
      REQUIRE(std::getline(lines, line));
      const json sample = json::parse(line);
      const double time_s = sample["time_s"];
      if (at == 0) base_s = time_s - std::stod(row);
      if (at == 0) first_replayed_s = sample["replayed_s"];
      recorded_s = at == 0 ? -std::stod(row) : recorded_s;
      if (at + 1 == samples) recorded_s += std::stod(row);
      CHECK(std::abs(time_s - base_s - std::stod(row)) < 1e-6);
      const double measured_s = std::stod(row.substr(row.find(',') + 1));
      CHECK(std::abs(sample["measured_s"].get<double>() - base_s - measured_s) < 1e-6);
      CHECK(sample["replayed_s"].get<double>() > time_s); // by the same clock, and later
    }
    const double took_s = json::parse(line)["replayed_s"].get<double>() - first_replayed_s;
    CHECK(recorded_s > 1.0);
    CHECK(took_s >= recorded_s / 4.0 * 0.8); // a quarter of the recorded time, and no less
    const auto live = test::nendo({"monitor", "sim", "--json", "--count", "1"});
    CHECK_FALSE(json::parse(live.out).contains("replayed_s"));
  }

  TEST_CASE("a run's samples come out as a table, too, as many as the recording counts") {
    const RecordedRun run("type1");
    const json info =
        json::parse(test::nendo({"recording", "info", run.path("take.nendo"), "--json"}).out);
    std::uint64_t samples = 0;
    for (const auto& glove : info["gloves"])
      samples += glove["samples"].get<std::uint64_t>();
    const auto done = run.export_to("samples.csv", {"--samples"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    CHECK(json::parse(done.out)["frames"] == samples);
    CHECK(is_one_line_about(run.export_to("a.glb", {"--samples"}).err, "--samples"));
  }

  TEST_CASE("a hand that was recorded without a calibration is named, and has no angles") {
    const test::TemporaryFolder folder;
    const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
    test::Program unit({"emulate", "--link", path("glove"), "--duration", "20s"});
    for (int tries = 0; tries < 500 && !std::filesystem::exists(path("glove")); ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const auto recorded = test::nendo({"record", "serial:" + path("glove"), "--calibration", "none",
                                       "--duration", "500ms", "--out", path("rec.nendo")});
    CAPTURE(recorded.err);
    REQUIRE(recorded.exit_code == 0);
    const auto done = test::nendo({"export", path("rec.nendo"), "--out", path("rec.csv")});
    CHECK(done.exit_code == 0);
    CHECK(is_one_line_about(done.err, "without a calibration"));
    const auto hands = test::nendo({"export", path("rec.nendo"), "--out", path("rec.bvh")});
    CHECK(hands.exit_code == 0);
    CHECK(is_one_line_about(hands.err, "average hand"));
  }

  TEST_CASE("wrong usage and files that are no takes are one line each") {
    const test::TemporaryFolder folder;
    const std::string text = (folder.path() / "a.nendo").string();
    test::write_file(text, "no recording");
    const auto run = [&](std::vector<std::string> more) {
      std::vector<std::string> arguments{"export", text};
      arguments.insert(arguments.end(), more.begin(), more.end());
      return test::nendo(arguments);
    };
    struct Row {
      std::vector<std::string> arguments;
      int exit_code;
      const char* about;
    };
    for (const Row& row : std::initializer_list<Row>{
             {{"--out", "a.glb"}, 5, "a.nendo"},
             {{"--out", "a.fbx"}, 2, "--out a.fbx"},
             {{"--out", "/nowhere/a.glb"}, 1, "/nowhere"},
             {{"--out", "a.obj"}, 2, "%04d"},
             {{"--out", "a-%d.ply", "--format", "obj"}, 2, ".obj"},
             {{"--out", "a.glb", "--rate", "0"}, 2, "--rate"},
             {{"--out", "a.glb", "--from", "2", "--to", "1"}, 2, "--from"},
             {{"--out", "a.glb", "--tolerance", "0"}, 2, "--tolerance"},
             {{"--out", "a.glb", "--tolerance", "1"}, 2, "1mm"},
             {{"--out", "a.glb", "--tolerance", "2in"}, 2, "1mm"},
             {{"--out", "a.glb", "--tolerance", "0mm"}, 2, "--tolerance"},
             {{"--out", "a.pc2", "--every-frame"}, 2, "--every-frame"},
             {{"--out", "a.mcap", "--no-hands"}, 2, "--no-hands"},
             {{"--out", "a.mcap", "--tolerance", "1mm"}, 2, "--tolerance"},
             {{"--out", "a.mcap", "--samples"}, 2, "--samples"},
             {{"--out", "a.mcap", "--every-frame"}, 5, "a.nendo"},
             {{"--out", "a.glb", "--every-frame", "--rate", "24"}, 2, "--every-frame"},
             {{"--out", "a.csv", "--from", "1x"}, 2, "--from"},
             {{"--out", "a.glb", "--format", "fbx"}, 2, "fbx"}}) {
      const auto done = run(row.arguments);
      CAPTURE(done.err);
      CHECK(done.exit_code == row.exit_code);
      CHECK(is_one_line_about(done.err, row.about));
    }
  }
}

} // namespace export_command_test
