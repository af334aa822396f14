#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/puppet/puppet.hpp>

#include "support/json_lines.hpp"
#include "support/program.hpp"
#include "support/test_meshes.hpp"

namespace run_command_test {

using namespace nendo;
using nendo::test::EmulatedGlove;
using nendo::test::is_one_line_about;
using nendo::test::last_object;
using nendo::test::lines_of;
using nendo::test::TemporaryFolder;
using nlohmann::json;

namespace {

deform::Mesh shipped(const char* model) {
  const auto program = std::filesystem::path(NENDO_PROGRAM);
  const auto mesh =
      deform::read_mesh(program.parent_path().parent_path() / "share/nendo/models" / model);
  REQUIRE(mesh);
  return *mesh;
}

} // namespace

TEST_SUITE("run") {
  TEST_CASE("two CyberGloves on pseudo-terminals shape the shipped model, in both modes") {
    const TemporaryFolder folder;
    const auto left = folder.path() / "left";
    const auto right = folder.path() / "right";
    const EmulatedGlove left_glove(left, "left", "22");
    const EmulatedGlove right_glove(right, "right", "18");
    const deform::Mesh before = shipped("moai.obj");
    for (const std::string mode : {"type1", "type2"}) {
      const auto out = folder.path() / (mode + ".obj");
      const auto done = nendo::test::nendo(
          {"run", "--left", "serial:" + left.string(), "--right", "serial:" + right.string(),
           "--mode", mode, "--duration", "4", "--rate", "60", "--json", "--out", out.string()});
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      const json summary = last_object(done);
      CHECK(summary["event"] == "summary");
      CHECK(summary["ticks"].get<int>() + summary["missed"].get<int>() == 240);
      CHECK(summary["failed"] == 0);
      CHECK(summary["left"]["samples"].get<int>() > 100);
      CHECK(summary["right"]["samples"].get<int>() > 100);
      CHECK(summary["left"]["ring_refused"] == 0);
      CHECK(summary["left"]["spikes"].empty()); // nothing that the emulator's hand does is one
      CHECK(summary["right"]["spikes"].empty());
      CHECK(summary["left"]["switch_uses"] == 0);
      CHECK(summary["switch"] == "none");
      CHECK(summary["end_to_end_ms"]["p50"].get<double>() > 0.0);
      CHECK(summary["vertices"] == before.vertices.cols());
      const auto after = deform::read_mesh(out);
      REQUIRE(after);
      CHECK(after->face_corners == before.face_corners);
      // The hands hold the model from both sides and have pressed by centimetres; head and foot are
      // out of reach.
      const double diagonal = deform::diagonal_of(before.vertices);
      const auto moved = (after->vertices - before.vertices).colwise().norm().eval();
      CHECK(moved.maxCoeff() > 0.01 * diagonal);
      CHECK(moved.maxCoeff() < 0.5 * diagonal);
      CHECK((moved.array() == 0.0).any());
    }
  }

  TEST_CASE("the switch at a glove's wrist grabs the model, and the light shows it") {
    const TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    const auto log = folder.path() / "traffic";
    nendo::test::Program emulator({"emulate", "--link", link.string(), "--log", log.string(),
                                   "--fault", "press@3s+1s", "--fault", "press@5s+1s"});
    REQUIRE(nendo::test::appears(link));
    const auto done = nendo::test::nendo({"run", "--right", "serial:" + link.string(), "--switch",
                                          "grab", "--duration", "7", "--json", "--out",
                                          (folder.path() / "shape.ply").string()});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const json summary = last_object(done);
    CHECK(summary["switch"] == "grab");
    // The presses are timed from the emulator's start: a slow machine's run may miss the first.
    CHECK(summary["right"]["switch_uses"] >= 1);
    CHECK(summary["right"]["switch_uses"] <= 2);
    emulator.signal(SIGINT);
    REQUIRE(emulator.wait().exit_code == 0);
    std::ifstream file(log);
    const std::string traffic(std::istreambuf_iterator<char>(file), {});
    const auto lit = traffic.find("4c 01"); // L on
    REQUIRE(lit != std::string::npos);
    CHECK(traffic.find("4c 00", lit) != std::string::npos);
  }

  TEST_CASE("each finger has its radius, and the model never folds unless so asked") {
    const TemporaryFolder folder;
    const auto out = (folder.path() / "shape.ply").string();
    for (const std::string mode : {"type1", "type2"})
      for (const std::string injective : {"", "--injective", "--no-injective"}) {
        std::vector<std::string> command{
            "run",   "--left",   "sim:sculpt",           "--right",    "sim:sculpt", "--mode",
            mode,    "--radius", "0.5,0.3,0.3,0.3,0.25", "--duration", "0.5",        "--json",
            "--out", out};
        if (!injective.empty()) command.push_back(injective);
        const auto done = nendo::test::nendo(command);
        REQUIRE_MESSAGE(done.exit_code == 0, done.err);
        const json summary = last_object(done);
        CHECK(summary["radius"] == 0.5);
        CHECK(summary["failed"] == 0);
        const json& links = summary["injective"];
        CHECK(links.is_null() == (injective == "--no-injective"));
        if (links.is_null()) continue;
        CHECK(links["max_links"].get<int>() >= 1);
        CHECK(links["max_bound"].get<double>() > 0.0);
        CHECK(links["min_determinant"].get<double>() > 0.0);
        CHECK(links["held_apart_ticks"].get<int>() >= 0);
      }
    const auto both = nendo::test::nendo({"run", "--injective", "--no-injective"});
    CHECK(both.exit_code == 2);
  }

  TEST_CASE("the whole hand holds, or the volume stays, and what does not go together is refused") {
    const TemporaryFolder folder;
    const auto run = [&](std::vector<std::string> more) {
      std::vector<std::string> arguments{
          "run",        "--right", "sim:wave", "--out", (folder.path() / "shape.ply").string(),
          "--duration", "300ms",   "--json"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      return nendo::test::nendo(arguments);
    };
    const auto summary = [&](std::vector<std::string> more) {
      const auto done = run(std::move(more));
      REQUIRE(done.exit_code == 0);
      return last_object(done);
    };
    const json hand = summary({"--hold", "hand"});
    CHECK(hand["hold"] == "hand");
    CHECK(hand["failed"] == 0);
    const json clay = summary({"--keep-volume", "0.75"});
    CHECK(clay["keep_volume"] == 0.75);
    CHECK(clay["failed"] == 0);
    for (const std::vector<std::string>& wrong :
         {std::vector<std::string>{"--hold", "fist"},
          {"--hold", "hand", "--mode", "type2"},
          {"--hold", "hand", "--keep-volume", "1"},
          {"--hold", "hand", "--puppet", "face"},
          {"--keep-volume", "2"},
          {"--keep-volume", "1", "--injective"},
          {"--injective", "--puppet", "face"},
          {"--keep-volume", "1", "--puppet", "face"},
          {"--keep-volume", "1", "--mode", "type2", "--puppet", "face"},
          {"--brush", "inflate", "--puppet", "face"}}) {
      CAPTURE(wrong.back());
      const auto done = run(wrong);
      CHECK(done.exit_code == 2);
      CHECK(std::count(done.err.begin(), done.err.end(), '\n') == 1);
    }
  }

  TEST_CASE("lengths are taken with a unit and without, and both are reported") {
    const TemporaryFolder folder;
    const deform::Mesh moai = shipped("moai.obj");
    const double side =
        (moai.vertices.rowwise().maxCoeff() - moai.vertices.rowwise().minCoeff()).maxCoeff();
    const auto run = [&](std::vector<std::string> more) {
      std::vector<std::string> arguments{
          "run",        "--right", "sim:rest", "--out", (folder.path() / "shape.ply").string(),
          "--duration", "200ms"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const auto done = nendo::test::nendo(arguments);
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      return done;
    };
    const auto bare = run({"--size", "20", "--radius", "3cm", "--json"});
    CHECK(last_object(bare)["radius"].get<double>() == doctest::Approx(0.15 * side));
    CHECK(bare.err.find("--size 20: has no unit, so it is in centimetres") != std::string::npos);
    const std::string radius = std::to_string(0.15 * side);
    const auto plain = run({"--size", "20cm", "--radius", radius});
    CHECK(plain.err.find("centimetres") == std::string::npos);
    CHECK(plain.out.find("radius 3 cm (") != std::string::npos);
    const auto mixed =
        run({"--size", "20cm", "--radius", "1cm,3cm+" + radius + ":0.5,2cm,2cm,2cm"});
    CHECK(mixed.out.find("radius 1 to 3 cm (") != std::string::npos);
  }

  TEST_CASE("hands press clay, its volume stays, and the recording replays to the same bytes") {
    const TemporaryFolder folder;
    const auto at = [&](const char* name) { return (folder.path() / name).string(); };
    const auto done =
        nendo::test::nendo({"run", "--mode", "clay", "--left", "sim:press", "--right", "sim:press",
                            "--calibration", "none", "--duration", "2", "--record",
                            at("take.nendo"), "--out", at("cake.ply"), "--json"});
    REQUIRE(done.exit_code == 0);
    const json clay = last_object(done)["clay"];
    CHECK(clay["touching_ticks"] > 5);
    const double first = clay["first_volume_cm3"];
    CHECK(first == doctest::Approx(4.0 / 3.0 * 3.14159 * std::pow(3.75, 3)).epsilon(0.01));
    CHECK(std::abs(clay["volume_cm3"].get<double>() / first - 1.0) < 0.0015);
    const auto cake = deform::read_mesh(at("cake.ply"));
    REQUIRE(cake);
    CHECK(cake->vertices.row(1).maxCoeff() < 0.030); // of a ball of 75 mm
    CHECK(cake->vertices.row(1).minCoeff() > -0.0376);
    REQUIRE(nendo::test::nendo({"replay", at("take.nendo"), "--no-clock", "--out", at("again.ply")})
                .exit_code == 0);
    CHECK(nendo::test::contents(at("again.ply")) == nendo::test::contents(at("cake.ply")));
  }

  TEST_CASE("a mask holds clay, bit for bit, in the run and in its replay") {
    const TemporaryFolder folder;
    const auto at = [&](const char* name) { return (folder.path() / name).string(); };
    std::ofstream(at("side.toml"))
        << "version = 1\n[[masks]]\nat = [0, 0, 0.0375]\nradius = 0.04\n";
    const auto run = nendo::test::nendo(
        {"run", "--mode", "clay", "--mask", at("side.toml"), "--left", "sim:press", "--right",
         "sim:press", "--duration", "3s", "--record", at("take.nendo"), "--out", at("cake.ply")});
    REQUIRE(run.exit_code == 0);
    const deform::Mesh ball = shipped("clay.ply");
    const auto cake = deform::read_mesh(at("cake.ply"));
    REQUIRE(cake);
    const Eigen::Vector3d middle(0.0, 0.0, 0.0375);
    int held = 0;
    for (Eigen::Index vertex = 0; vertex < ball.vertices.cols(); ++vertex) {
      if ((ball.vertices.col(vertex) - middle).norm() > 0.019) continue; // half of the radius
      ++held;
      CHECK(cake->vertices.col(vertex) == ball.vertices.col(vertex));
    }
    CHECK(held > 100);
    REQUIRE(nendo::test::nendo({"replay", at("take.nendo"), "--no-clock", "--out", at("again.ply")})
                .exit_code == 0);
    CHECK(nendo::test::contents(at("again.ply")) == nendo::test::contents(at("cake.ply")));
  }

  TEST_CASE("what acts on fingertips is refused in clay, in one line that names it") {
    for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--hold", "hand"},
                                                  {"--keep-volume", "0.5"},
                                                  {"--puppet", "face"}}) {
      CAPTURE(wrong.front());
      std::vector<std::string> arguments{"run", "--right", "sim:press", "--mode", "clay"};
      arguments.insert(arguments.end(), wrong.begin(), wrong.end());
      const auto done = nendo::test::nendo(arguments);
      CHECK(done.exit_code == 2);
      CHECK(done.err.find(wrong.front()) != std::string::npos);
      CHECK(std::count(done.err.begin(), done.err.end(), '\n') == 1);
    }
  }

  TEST_CASE(
      "how a shape was kept from folding is reported to those who ask, or where it mattered") {
    const TemporaryFolder folder;
    const auto run = [&](std::vector<std::string> more) {
      std::vector<std::string> arguments{
          "run",        "--right", "sim:rest", "--out", (folder.path() / "shape.ply").string(),
          "--duration", "300ms"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const auto done = nendo::test::nendo(arguments);
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      return done;
    };
    const auto plain = run({});
    CHECK(plain.out.find("min determinant") == std::string::npos);
    CHECK(plain.out.find("held apart") == std::string::npos); // a hand at rest keeps its fingers
    CHECK(run({"--verbose"}).out.find("min determinant") != std::string::npos);
    CHECK(run({"--verbose", "--no-injective"}).out.find("determinant") == std::string::npos);
  }

  TEST_CASE("a model that is too large for the guard against folds says that there is none") {
    const TemporaryFolder folder;
    const auto mesh = (folder.path() / "large.ply").string();
    REQUIRE(deform::write_mesh(mesh, test::sphere(320, 320, 1.0))); // 102,000 vertices
    const auto run = [&](std::vector<std::string> more) {
      std::vector<std::string> arguments{"run",
                                         "--right",
                                         "sim",
                                         "--mesh",
                                         mesh,
                                         "--out",
                                         (folder.path() / "a.ply").string(),
                                         "--duration",
                                         "200ms"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      return nendo::test::nendo(arguments).err;
    };
    CHECK(run({}).find("the surface can fold; --injective") != std::string::npos);
    CHECK(run({"--no-injective"}).find("folding") == std::string::npos); // who says so knows
    CHECK(run({"--injective"}).find("folding") == std::string::npos);
  }

  TEST_CASE("a hang-up ends a run early, and does not under nohup") {
    const TemporaryFolder folder;
    for (const bool ignored : {false, true}) {
      const auto before = std::signal(SIGHUP, ignored ? SIG_IGN : SIG_DFL);
      nendo::test::Program run({"run", "--right", "sim", "--duration", "6", "--json", "--out",
                                (folder.path() / "shape.ply").string()});
      std::signal(SIGHUP, before);
      REQUIRE(run.reports_progress());
      run.signal(SIGHUP);
      const auto done = run.wait();
      CHECK(done.exit_code == 0);
      const double elapsed_s = last_object(done)["elapsed_s"];
      CHECK((elapsed_s > 5.9) == ignored);
    }
  }

  TEST_CASE("a filter is named in the summary with its latency, and none is none") {
    const TemporaryFolder folder;
    const auto out = (folder.path() / "shape.ply").string();
    const std::vector<std::string> run{"run",   "--right", "sim:wave?seed=4", "--duration", "1",
                                       "--out", out};
    const auto with = [&](std::vector<std::string> more) {
      more.insert(more.begin(), run.begin(), run.end());
      auto done = nendo::test::nendo(more);
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      return done;
    };
    CHECK(last_object(with({"--json"}))["filter"] == json{{"kind", "off"}});
    const json filter = last_object(with({"--json", "--filter", "one-euro"}))["filter"];
    CHECK(filter["kind"] == "one-euro");
    const double slowest_ms = 1000.0 / (6.283185307179586 * filter["min_cutoff_hz"].get<double>());
    CHECK(filter["worst_latency_ms"]["max"].get<double>() <= slowest_ms * 1.001);
    CHECK(filter["moving_latency_ms"]["p50"].get<double>() > 0.0);
    CHECK(filter["moving_latency_ms"]["p50"].get<double>() <
          filter["worst_latency_ms"]["max"].get<double>());
    CHECK(filter["moving_latency_ms"]["count"].get<int>() > 20);
    CHECK(with({"--filter", "one-euro"}).out.find("one-euro") != std::string::npos);
    CHECK(with({}).out.find("filter") == std::string::npos);
  }

  TEST_CASE("the help names the filter's values that are taken without any") {
    const auto help = nendo::test::nendo({"run", "--help"});
    REQUIRE(help.exit_code == 0);
    std::istringstream words(help.out); // lines may break anywhere
    std::vector<double> named;
    for (std::string before, word; words >> word; before = word)
      if (before == "it,") named.push_back(std::strtod(word.c_str(), nullptr));
    const hand::FilterOptions usual;
    for (const double value : {usual.min_cutoff_hz, usual.beta_hz_per_rad_s})
      CHECK(std::find(named.begin(), named.end(), value) != named.end());
  }

  TEST_CASE("the filter's parameters are the ones asked for, and so is the latency they cause") {
    const TemporaryFolder folder;
    const auto out = (folder.path() / "shape.ply").string();
    for (const std::string cutoff : {"0.5", "8"}) {
      const auto done = nendo::test::nendo({"run", "--right", "sim:rest", "--duration", "1",
                                            "--filter", "one-euro", "--filter-min-cutoff", cutoff,
                                            "--filter-beta", "0", "--json", "--out", out});
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      const json filter = last_object(done)["filter"];
      CHECK(filter["min_cutoff_hz"] == std::stod(cutoff));
      CHECK(filter["beta_hz_per_rad_s"] == 0.0);
      // Without beta every joint is late by 1 / (2 pi cutoff) at any speed; the histogram's
      // buckets are 1.6 % wide.
      const double late_ms = 1000.0 / (6.283185307179586 * std::stod(cutoff));
      CHECK(filter["moving_latency_ms"]["p50"].get<double>() ==
            doctest::Approx(late_ms).epsilon(0.02));
      CHECK(filter["worst_latency_ms"]["max"].get<double>() ==
            doctest::Approx(late_ms).epsilon(0.02));
    }
    const auto text = nendo::test::nendo({"run", "--right", "sim", "--duration", "0.3", "--filter",
                                          "one-euro", "--filter-beta", "7.5", "--out", out});
    CHECK(text.out.find("min cutoff 2 Hz, beta 7.5") != std::string::npos);
  }

  TEST_CASE("--adapt reports the ranges that it has learned, of the sensors that the glove has") {
    const TemporaryFolder folder;
    const auto out = (folder.path() / "shape.ply").string();
    const std::vector<std::string> run{"run",   "--right", "sim:wave?seed=4&sensors=18",
                                       "--out", out,       "--duration"};
    const auto with = [&](std::vector<std::string> more) {
      more.insert(more.begin(), run.begin(), run.end());
      auto done = nendo::test::nendo(more);
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      return done;
    };
    const json ranges = last_object(with({"6", "--adapt", "--json"}))["right"]["ranges"];
    CHECK(ranges.size() == 18);
    CHECK_FALSE(ranges.contains("index_dip"));
    for (const auto& range : ranges) {
      CHECK(range["low_counts"].get<double>() >= 0.0);
      CHECK(range["high_counts"].get<double>() <= 255.0);
      CHECK(range["low_counts"].get<double>() + 10.0 < range["high_counts"].get<double>());
    }
    CHECK(ranges["index_mcp"]["turns"].get<int>() > 1);
    CHECK(ranges["wrist_yaw"]["turns"] == 0); // it does not wave with the wrist
    CHECK_FALSE(last_object(with({"0.3", "--json"}))["right"].contains("ranges"));
    CHECK(with({"0.3", "--adapt"}).out.find("none: default") != std::string::npos);
  }

  TEST_CASE("Ctrl-C ends a run cleanly and still writes the result") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "shape.ply";
    nendo::test::Program program(
        {"run", "--right", "sim:wave?seed=4", "--out", out.string(), "--json"});
    REQUIRE(program.reports_progress());
    program.signal(SIGINT);
    const auto done = program.wait();
    CAPTURE(done.err);
    CHECK(done.exit_code == 0);
    CHECK(last_object(done)["event"] == "summary");
    CHECK(last_object(done)["right"]["samples"].get<int>() > 50);
    CHECK_FALSE(last_object(done).contains("left"));
    CHECK(deform::read_mesh(out));
  }

  TEST_CASE("a shape that cannot be written where it was wanted is kept elsewhere") {
    const TemporaryFolder folder;
    const auto name = folder.path().filename().string() + ".obj"; // of this test alone
    const auto gone = folder.path() / "gone";
    std::filesystem::create_directory(gone);
    nendo::test::Program program({"run", "--left", "sim", "--out", (gone / name).string()});
    REQUIRE(program.reports_progress());
    std::filesystem::remove(gone);
    program.signal(SIGTERM);
    const auto done = program.wait();
    CAPTURE(done.err);
    CHECK(done.exit_code == 1);
    const auto rescued = std::filesystem::temp_directory_path() / name;
    CHECK(done.err.find(rescued.string()) != std::string::npos);
    CHECK(deform::read_mesh(rescued));
    std::filesystem::remove(rescued);
  }

  TEST_CASE("without a glove the run says that it fell back to simulated hands") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "shape.obj";
    const auto done = nendo::test::nendo({"run", "--duration", "1", "--out", out.string()});
    CHECK(done.exit_code == 0);
    CHECK(done.err.find("no glove found") != std::string::npos);
    CHECK(done.err.find("sim") != std::string::npos);
    for (const std::string part : {"ticks", "overruns", "p50", "p99", "vertices", "shape.obj"}) {
      CHECK(done.out.find(part) != std::string::npos);
    }
    CHECK(deform::read_mesh(out));
  }

  TEST_CASE("a switch that no glove has cannot do anything, and that is said") {
    const TemporaryFolder folder;
    const auto out = (folder.path() / "shape.obj").string();
    const auto done =
        nendo::test::nendo({"run", "--right", "sim", "--switch", "grab", "--out", out});
    CHECK(done.exit_code == 2);
    CHECK(is_one_line_about(done.err, "--switch grab"));
    CHECK_FALSE(std::filesystem::exists(out));
  }

  TEST_CASE("asking for a glove that is not there is an error, not a fall-back") {
    const TemporaryFolder folder;
    const auto out = (folder.path() / "shape.obj").string();
    for (const std::string glove : {"auto", "serial:/dev/no-such-port"}) {
      const auto done =
          nendo::test::nendo({"run", "--left", glove, "--duration", "1", "--out", out});
      CAPTURE(done.err);
      CHECK(done.exit_code == 3);
      CHECK(lines_of(done.err).size() == 1);
      CHECK(done.seconds < 5.0);
      CHECK_FALSE(std::filesystem::exists(out));
    }
  }

  TEST_CASE("a mask file's places stay bit for bit, and symmetry shapes both sides by one hand") {
    const TemporaryFolder folder;
    const auto at = [&](const char* name) { return (folder.path() / name).string(); };
    std::ofstream(at("mask.toml")) << "version = 1\n[[masks]]\nat = [0, 1.2, 0.2]\nradius = 0.3\n";
    const std::string model = NENDO_MODELS "/moai.obj";
    const auto before = deform::read_mesh(model);
    const auto masks = puppet::read_puppet(at("mask.toml"));
    REQUIRE(before);
    REQUIRE(masks);
    const auto done = nendo::test::nendo(
        {"run", model, "--right", "sim:sculpt", "--mask", at("mask.toml"), "--symmetry", "--rate",
         "90", "--duration", "2", "--record", at("take.nendo"), "--out", at("clay.ply")});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto shaped = deform::read_mesh(at("clay.ply"));
    REQUIRE(shaped);
    const Eigen::VectorXd weights = puppet::mask_weights(*masks, before->vertices);
    int held = 0, moved = 0, left = 0, right = 0;
    for (Eigen::Index v = 0; v < weights.size(); ++v) {
      const bool same = shaped->vertices.col(v) == before->vertices.col(v);
      held += weights[v] == 0.0 ? 1 : 0;
      moved += weights[v] == 0.0 && !same ? 1 : 0;
      if (!same) ++(before->vertices(0, v) < 0.0 ? left : right);
    }
    CHECK(held > 50);
    CHECK(moved == 0);
    CHECK(left > 50);
    CHECK(right > 50);
    const auto again =
        nendo::test::nendo({"replay", at("take.nendo"), "--no-clock", "--out", at("again.ply")});
    REQUIRE_MESSAGE(again.exit_code == 0, again.err);
    CHECK(nendo::test::contents(at("again.ply")) == nendo::test::contents(at("clay.ply")));
  }

  TEST_CASE("wrong options and files are found before any glove is opened") {
    const TemporaryFolder folder;
    const auto out = (folder.path() / "shape.obj").string();
    struct Case {
      std::vector<std::string> arguments;
      int exit_code;
      std::string about;
    };
    for (const Case& c :
         {Case{{"--mode", "type3"}, 2, "type3"},
          Case{{"--rate", "0"}, 2, "--rate"},
          Case{{"--rate", "nan"}, 2, "--rate"},
          Case{{"--rate", "1e9"}, 2, "--rate"},
          Case{{"--duration", "-1"}, 2, "--duration"},
          Case{{"--radius", "-1"}, 2, "--radius"},
          Case{{"--radius", "1,2,3"}, 2, "--radius"},
          Case{{"--radius", "1e999"}, 2, "--radius"},
          Case{{"--kernel", "gauss"}, 2, "gauss"},
          Case{{"--switch", "press"}, 2, "press"},
          Case{{"--filter", "kalman"}, 2, "kalman"},
          Case{{"--filter-min-cutoff", "2"}, 2, "--filter one-euro"},
          Case{{"--filter-beta", "2"}, 2, "--filter one-euro"},
          Case{{"--filter", "one-euro", "--filter-min-cutoff", "0"}, 2, "--filter-min-cutoff"},
          Case{{"--filter", "one-euro", "--filter-min-cutoff", "nan"}, 2, "--filter-min-cutoff"},
          Case{{"--filter", "one-euro", "--filter-beta", "-1"}, 2, "--filter-beta"},
          Case{{"--filter", "one-euro", "--filter-beta", "inf"}, 2, "--filter-beta"},
          Case{{"--pinches", "open"}, 2, "measured or closed"},
          Case{{"--hand-length", "0.19"}, 2, "millimetres"},
          Case{{"--hand-length", "nan"}, 2, "--hand-length"},
          Case{{"--adapt", "--calibration", "none"}, 2, "--adapt"},
          Case{{"--mask", "/no/such/mask.toml"}, 5, "/no/such/mask.toml"},
          Case{{"--mask", NENDO_MODELS "/face.puppet.toml"}, 5, "is a puppet"},
          Case{{"--symmetry", "--puppet", "face"}, 2, "--symmetry"},
          Case{{"--mesh", "/no/such/mesh.obj"}, 5, "/no/such/mesh.obj"},
          Case{{"/no/such/mesh.obj"}, 5, "/no/such/mesh.obj"},
          Case{{"a.obj", "--mesh", "b.obj"}, 5, "a.obj"},
          Case{{"a.obj", "b.obj"}, 5, "a.obj"}}) {
      std::vector<std::string> arguments{"run", "--right", "sim", "--out", out};
      arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
      const auto done = nendo::test::nendo(arguments);
      CAPTURE(done.err);
      CHECK(done.exit_code == c.exit_code);
      CHECK(is_one_line_about(done.err, c.about));
    }
    CHECK(
        nendo::test::nendo({"run", "--right", "sim", "--out", "/no/such/folder/x.obj"}).exit_code ==
        1);
    CHECK(nendo::test::nendo({"run", "--right", "sim", "--out", "shape.fbx"}).exit_code == 2);
    CHECK_FALSE(std::filesystem::exists(out));
  }
}

} // namespace run_command_test
