#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "support/program.hpp"

namespace bench_command_test {

using nendo::test::is_one_line_about;
using nendo::test::lines_of;

TEST_SUITE("bench") {
  TEST_CASE("bench driver tells both latencies and their ratio, on a terminal and on sockets") {
    const auto done = nendo::test::nendo({"bench", "driver", "--records", "40", "--json"});
    REQUIRE(done.exit_code == 0);
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 2);
    for (const auto& line : lines) {
      const auto measured = nlohmann::json::parse(line);
      for (const std::string who : {"driver_us", "bare_us"}) {
        CHECK(measured[who]["records"] == 40);
        CHECK(measured[who]["min"].get<double>() > 1.0);
        CHECK(measured[who]["p99"].get<double>() >= measured[who]["p50"].get<double>());
        CHECK(measured[who]["max"].get<double>() >= measured[who]["p99"].get<double>());
      }
      const double ratio =
          measured["driver_us"]["p50"].get<double>() / measured["bare_us"]["p50"].get<double>();
      CHECK(measured["ratio"]["p50"].get<double>() == doctest::Approx(ratio));
    }
  }

  TEST_CASE("bench rt holds each of the loop's figures against its goal, or says what it lacks") {
    const auto done =
        nendo::test::nendo({"bench", "rt", "--part", "loop", "--seconds", "1", "--json"});
    if (done.exit_code != 0) { // no real-time rights, no cyclictest
      CHECK(is_one_line_about(done.err, "; "));
      return;
    }
    const auto lines = lines_of(done.out);
    CHECK(lines.size() == 10);
    for (const auto& line : lines) {
      const auto told = nlohmann::json::parse(line);
      CHECK((told["value"].get<double>() <= told["at_most"].get<double>()) == told["met"]);
    }
  }

  TEST_CASE("no fault makes a CyberGlove deliver what was not sent, or stay away") {
    const auto done =
        nendo::test::nendo({"bench", "faults", "--seconds", "7", "--at-once", "16", "--json"});
    CHECK_MESSAGE(done.exit_code == 0, done.err);
    const auto lines = lines_of(done.out);
    CHECK(lines.size() == 64); // 16 faults, 4 kinds of CyberGlove
    std::uint64_t flipped = 0;
    for (const auto& line : lines) {
      const auto cell = nlohmann::json::parse(line);
      CAPTURE(line);
      CHECK(cell["broken"] == 0);
      CHECK(cell["complaint"] == "");
      CHECK(cell["delivered"].get<int>() > 100);
      CHECK(cell["delivered"] <= cell["sent"]);
      const std::string fault = cell["fault"];
      const bool costs_records = fault == "drop" || fault == "insert" || fault == "flip" ||
                                 fault == "lose" || fault == "burst";
      if (costs_records) CHECK(cell["faulted"].get<int>() > 0);
      if (fault == "silence" || fault == "power cut") CHECK(cell["silences"].get<int>() > 0);
      if (fault == "unplugged") CHECK(cell["reopened"].get<int>() > 0);
      if (fault != "flip") CHECK(cell["flipped"] == 0);
      flipped += cell["flipped"].get<std::uint64_t>();
    }
    CHECK(flipped > 0); // the control: a bit in a sensor's byte cannot be seen
  }

  TEST_CASE("every one of many records is delivered or known to be missed, and memory stays") {
    // What is freed under the address sanitizer would be kept for a while, and count as growth.
    REQUIRE(::setenv("ASAN_OPTIONS", "quarantine_size_mb=0:thread_local_quarantine_size_kb=0", 0) ==
            0);
    const auto done = nendo::test::nendo({"bench", "soak", "--records", "200000", "--json"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto tally = nlohmann::json::parse(lines_of(done.out).at(0));
    const auto number = [&](const char* key) { return tally[key].get<std::uint64_t>(); };
    CHECK(number("sent") >= 200'000);
    CHECK(number("faulted") > 1'000);
    CHECK(number("broken") == 0);
    CHECK(number("missed") > 1'000);
    CHECK(number("delivered") + number("missed") <= number("sent"));
    CHECK(number("delivered") + number("missed") + 5 >= number("sent"));
  }

  TEST_CASE("bench hand's two ways to pose agree, and it finds the hands that it made up") {
    const auto done =
        nendo::test::nendo({"bench", "hand", "--poses", "1000", "--solves", "300", "--json"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 1);
    const auto measured = nlohmann::json::parse(lines[0]);
    const auto number = [&](const char* key) { return measured[key].get<double>(); };
    CHECK(number("pose_pair_ns") > 0.0);
    CHECK(number("plain_to_pose") ==
          doctest::Approx(number("plain_pair_ns") / number("pose_pair_ns")));
    CHECK(number("apart_m") < 1e-6);
    CHECK(measured["solves"] == 300);
    CHECK(measured["converged"] == 300);
    CHECK(number("solves_a_second") > 0.0);
    CHECK(number("worst_residual_m") < 1e-4);
    CHECK(number("median_residual_m") <= number("worst_residual_m"));
    const auto text = nendo::test::nendo({"bench", "hand", "--poses", "1", "--solves", "1"});
    CHECK(text.exit_code == 0);
    CHECK(lines_of(text.out).size() == 5);
    CHECK(number("open_pair_ns") > 0.0);
    CHECK(number("pinching_pair_ns") > number("open_pair_ns"));
  }

  TEST_CASE("bench solve tells the times and the fill of every order, and of a dense elimination") {
    const auto done =
        nendo::test::nendo({"bench", "solve", "--points", "400", "--rounds", "1", "--json"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 5);
    const auto ten = nlohmann::json::parse(lines[0]);
    for (const char* key : {"build_us", "solve_us", "several_radii_build_us"})
      CHECK(ten[key].get<double>() > 0.0);
    std::vector<std::int64_t> entries;
    for (std::size_t line = 1; line < 5; ++line) {
      const auto one = nlohmann::json::parse(lines[line]);
      CHECK(one["points"] == 400);
      CHECK(one["build_ms"].get<double>() >= one["factor_ms"].get<double>());
      CHECK(one["solve_ms"].get<double>() > 0.0);
      entries.push_back(one["factor_entries"].get<std::int64_t>());
    }
    CHECK(entries[0] > 2 * entries[1]); // no order, octree
    CHECK(entries[1] > entries[2]);     // minimum degree
    CHECK(entries[3] == 400 * 401 / 2); // dense
    const auto text = nendo::test::nendo({"bench", "solve", "--points", "200", "--rounds", "1"});
    CHECK(text.exit_code == 0);
    CHECK(text.out.find("times as long as") != std::string::npos);
  }

  TEST_CASE("bench deform tells each cell's times and ratios, and a large model's floors") {
    const auto done = nendo::test::nendo({"bench", "deform", "--short", "--json"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 12); // two meshes, five radii, the volume, and the large model
    for (std::size_t at = 0; at < 10; ++at) {
      const auto cell = nlohmann::json::parse(lines[at]);
      CAPTURE(lines[at]);
      const auto number = [&](const char* key) { return cell[key].get<double>(); };
      CHECK(number("vertices") == (at < 5 ? 1089 : 4225));
      for (const char* key : {"type1_us", "type1_evaluated_us", "type2_us", "type1_two_threads_us",
                              "type2_two_threads_us", "grab_us"})
        CHECK(number(key) > 0.0);
      CHECK(cell["ratio"]["type1"].get<double>() ==
            doctest::Approx(number("plain_type1_us") / number("type1_us")));
      CHECK(number("apart_of_diagonal") < 1e-5);
      CHECK(number("weight_bytes") > 0.0);
    }
    const auto volume = nlohmann::json::parse(lines[10]);
    CHECK(volume["vertices"] == 4096);
    for (const char* key : {"air_ns_an_influence", "clay_ns_an_influence", "type2_clay_us"})
      CHECK(volume[key].get<double>() > 0.0);
    const auto large = nlohmann::json::parse(lines[11]);
    CHECK(large["reached"].get<int>() > 0);
    CHECK(large["influences"] > large["reached"].get<int>() / 4);
    const double floor_us = std::max(large["memory_floor_us"].get<double>(),
                                     large["arithmetic_floor_us"].get<double>());
    CHECK(large["of_floor"]["type2"].get<double>() ==
          doctest::Approx(large["type2_us"].get<double>() / floor_us));
    const auto unknown = nendo::test::nendo({"bench", "deform", "--simd", "abacus"});
    CHECK(unknown.exit_code == 2);
    CHECK(is_one_line_about(unknown.err, "abacus"));
  }

  TEST_CASE("bench join tells how long joins take") {
    const auto done = nendo::test::nendo({"bench", "join", "--short", "--json"});
    REQUIRE(done.exit_code == 0);
    const auto row = nlohmann::json::parse(done.out);
    CHECK(row.at("triangles") == 6400);
    CHECK(row.at("crossings") > 100);
    CHECK(row.at("sharp_ms") > 0.0);
    CHECK(row.at("smeared_ms") > 0.0);
    CHECK(row.at("volume_error") < 0.01); // the balls are coarse
  }

  TEST_CASE("bench clay tells what pressing takes, beside the plain program") {
    const auto done = nendo::test::nendo({"bench", "clay", "--short", "--json"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 2);
    for (std::size_t at = 0; at < 2; ++at) {
      const auto row = nlohmann::json::parse(lines[at]);
      CAPTURE(lines[at]);
      CHECK(row["plain"] == (at == 1));
      CHECK(row["vertices"] == 2562);
      CHECK(row["mean_us"] > 0.0);
      CHECK(row["p99_us"] >= row["mean_us"]);
      CHECK(row["penetration_p99_of_edge"] < 0.05);
    }
    const auto unknown = nendo::test::nendo({"bench", "clay", "--simd", "abacus"});
    CHECK(unknown.exit_code == 2);
    CHECK(is_one_line_about(unknown.err, "abacus"));
  }

  TEST_CASE("bench table1 counts the paper's evaluations in 19 cells of 20, and draws them all") {
    const nendo::test::TemporaryFolder folder;
    const auto picture = folder.path() / "table1.svg";
    const auto figure4 = folder.path() / "figure4.svg";
    const auto done =
        nendo::test::nendo({"bench", "table1", "--seconds-per-cell", "0.001", "--json", "--picture",
                            picture.string(), "--figure4", figure4.string()});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 160); // layouts, meshes, radii, types, threads
    std::vector<std::string> apart;
    for (std::size_t at = 0; at < lines.size(); ++at) {
      const auto cell = nlohmann::json::parse(lines[at]);
      CAPTURE(lines[at]);
      CHECK(cell["layout"] == (at < 80 ? "near" : "plane"));
      CHECK(cell["type"] == at / 2 % 2 + 1);
      CHECK(cell["threads"] == at % 2 + 1);
      CHECK(cell["frames_per_second"].get<double>() > 0.0);
      CHECK(cell["paper_frames_per_second"].get<double>() > 10.0);
      const auto& plain = cell["plain_loop_frames_per_second"];
      CHECK((plain.is_null() || plain.get<double>() > 0.0));
      const auto& whole = cell["whole_frames_per_second"];
      REQUIRE(whole.is_null() == (cell["threads"] == 2));
      if (!whole.is_null()) {
        CHECK(whole.get<double>() > 0.0);
        CHECK(whole.get<double>() < cell["frames_per_second"].get<double>());
      }
      if (at >= 80 || at % 4 != 0) continue;
      const double ratio =
          cell["evaluations"].get<double>() / cell["paper_evaluations"].get<double>();
      if (std::abs(ratio - 1.0) > 0.011) apart.push_back(lines[at]);
    }
    // The twentieth: 668 for the paper's 698.
    REQUIRE(apart.size() == 1);
    const auto twentieth = nlohmann::json::parse(apart[0]);
    CHECK(twentieth["vertices"] == 1089);
    CHECK(twentieth["radius"] == 10.0);
    CHECK(twentieth["evaluations"] == 668);
    const std::string drawn = nendo::test::contents(picture);
    CHECK(drawn.starts_with("<svg"));
    CHECK(drawn.ends_with("</svg>\n"));
    std::size_t factors = 0;
    for (std::size_t at = 0; (at = drawn.find(" x</text>", at)) != std::string::npos; ++at)
      ++factors;
    CHECK(factors == 40);
    const std::string figure = nendo::test::contents(figure4);
    CHECK(figure.starts_with("<svg"));
    CHECK(figure.ends_with("</svg>\n"));
    std::size_t dots = 0;
    for (std::size_t at = 0; (at = figure.find("<circle", at)) != std::string::npos; ++at)
      ++dots;
    CHECK(dots == 3 * 2 * 20 + 5); // series, types, cells; and the key's
  }

  TEST_CASE("bench table1 refuses what it cannot measure or write") {
    const auto endless = nendo::test::nendo({"bench", "table1", "--seconds-per-cell", "inf"});
    CHECK(endless.exit_code == 2);
    CHECK(is_one_line_about(endless.err, "--seconds-per-cell"));
    const auto unknown = nendo::test::nendo({"bench", "table1", "--simd", "abacus"});
    CHECK(unknown.exit_code == 2);
    CHECK(is_one_line_about(unknown.err, "abacus"));
    const auto nowhere = nendo::test::nendo(
        {"bench", "table1", "--seconds-per-cell", "0.001", "--picture", "/nowhere/table1.svg"});
    CHECK(nowhere.exit_code == 1);
    CHECK(is_one_line_about(nowhere.err, "/nowhere/table1.svg"));
    const auto no_figure = nendo::test::nendo(
        {"bench", "table1", "--seconds-per-cell", "0.001", "--figure4", "/nowhere/figure4.svg"});
    CHECK(no_figure.exit_code == 1);
    CHECK(is_one_line_about(no_figure.err, "/nowhere/figure4.svg"));
  }

  TEST_CASE("bench models tells what another version of the model costs a tick") {
    const auto done = nendo::test::nendo(
        {"bench", "models", "--cells", "20", "--repetitions", "1", "--seconds", "1", "--json"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 3); // hands that have released, hands that hold, and changes of radius
    const auto changes = nlohmann::json::parse(lines.back());
    CHECK(changes["changes"].get<int>() > 5);
    CHECK(changes["taken"].get<int>() > 5);
    lines.pop_back();
    for (const auto& text : lines) {
      const auto line = nlohmann::json::parse(text);
      CHECK(line["vertices"].get<int>() > 1500);
      for (const char* key : {"ordinary_us", "commit_us", "new_us", "make_ms", "finish_ms"})
        CHECK(line[key].get<double>() > 0.0);
      if (!line["held"].get<bool>())
        for (const char* key : {"undo_us", "redo_us"})
          CHECK(line[key].get<double>() > 0.0);
    }
    const auto never = nendo::test::nendo({"bench", "models", "--cells", "5000"});
    CHECK(never.exit_code == 2);
    CHECK(is_one_line_about(never.err, "--cells"));
  }

  TEST_CASE("bench scale tells what vertices and centres cost") {
    const auto done =
        nendo::test::nendo({"bench", "scale", "--short", "--repetitions", "1", "--json"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 3); // one size, two overlaps
    const auto vertices = nlohmann::json::parse(lines[0]);
    CHECK(vertices["measured"] == "vertices");
    CHECK(vertices["vertices"] == 316 * 316);
    for (const char* key : {"influences", "type1_evaluated_us", "type2_us"})
      CHECK(vertices[key].get<double>() > 0.0);
    double overlap = 9.0;
    for (const std::size_t at : {1U, 2U}) {
      const auto crowd = nlohmann::json::parse(lines[at]);
      CAPTURE(lines[at]);
      CHECK(crowd["measured"] == "centres");
      CHECK(crowd["centres"] == 1000);
      // The plane's border cuts a few supports off.
      CHECK(crowd["influences"].get<double>() / crowd["vertices"].get<double>() ==
            doctest::Approx(overlap).epsilon(0.15));
      CHECK(crowd["list_us"].get<double>() > 0.0);
      CHECK(crowd["evaluate_us"].get<double>() > crowd["list_us"].get<double>());
      CHECK(crowd["ratio"]["influence_to_ten"].get<double>() ==
            doctest::Approx(crowd["influence_ns"].get<double>() /
                            crowd["influence_of_ten_ns"].get<double>()));
      overlap = 26.0;
    }
    const auto never = nendo::test::nendo({"bench", "scale", "--repetitions", "0"});
    CHECK(never.exit_code == 2);
    CHECK(is_one_line_about(never.err, "--repetitions"));
  }

  TEST_CASE("bench rt tells the throughput of rings and the cost of publishing, beside baselines") {
    std::string out;
    for (const char* part : {"rings", "handoff"}) {
      const auto done =
          nendo::test::nendo({"bench", "rt", "--part", part, "--rounds", "2", "--json"});
      if (std::thread::hardware_concurrency() < 2) {
        CHECK(done.exit_code == 1);
        CHECK(is_one_line_about(done.err, "two processors"));
        return;
      }
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      out += done.out;
    }
    std::size_t rings = 0;
    std::size_t frames = 0;
    for (const auto& line : lines_of(out)) {
      CAPTURE(line);
      const auto told = nlohmann::json::parse(line);
      if (told["part"] == "rings") {
        ++rings;
        CHECK(told["element_bytes"] == 64);
        CHECK(told["samples"].get<int>() + told["dropped"].get<int>() == 2);
        if (told["samples"] != 0) CHECK(told["elements_a_second"].get<double>() > 0.0);
      } else {
        ++frames;
        CHECK(told["part"] == "handoff");
        CHECK(told["publishes"] == 400);
        CHECK(told["publish_p999_ns"] >= told["publish_p50_ns"]);
        CHECK(told["notify_to_publish_p50"].get<double>() ==
              doctest::Approx(told["notify_p50_ns"].get<double>() /
                              told["publish_p50_ns"].get<double>()));
      }
    }
    CHECK(rings >= 5); // more where other libraries are
    CHECK(frames == 2);
    const auto one = nendo::test::nendo({"bench", "rt", "--part", "rings", "--rounds", "1"});
    CHECK(one.exit_code == 0);
    CHECK(one.out.find("plain ring") != std::string::npos);
    CHECK(one.out.find("publishing") == std::string::npos);
  }

  TEST_CASE("a benchmark's figures that cannot be written are an error") {
    const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
    REQUIRE(full >= 0);
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"bench", "hand", "--poses", "1", "--solves", "1"},
          {"bench", "hand", "--poses", "1", "--solves", "1", "--json"},
          {"bench", "--help"}}) {
      const auto done = nendo::test::Program(arguments, full).wait();
      CHECK(done.exit_code == 1);
      CHECK(is_one_line_about(done.err, "standard output cannot be written: No space left"));
    }
    ::close(full);
  }

  TEST_CASE("bench says what cannot be measured") {
    const auto rate = nendo::test::nendo({"bench", "driver", "--rate", "1000"});
    CHECK(rate.exit_code == 2);
    CHECK(is_one_line_about(rate.err, "480"));
    const auto none = nendo::test::nendo({"bench", "driver", "--records", "0"});
    CHECK(none.exit_code == 2);
    CHECK(is_one_line_about(none.err, "--records"));
    const auto brief = nendo::test::nendo({"bench", "faults", "--seconds", "1"});
    CHECK(brief.exit_code == 2);
    CHECK(is_one_line_about(brief.err, "--seconds"));
    const auto still = nendo::test::nendo({"bench", "hand", "--poses", "0"});
    CHECK(still.exit_code == 2);
    CHECK(is_one_line_about(still.err, "--poses"));
    const auto nobody = nendo::test::nendo({"bench", "calibration", "--wearers", "0"});
    CHECK(nobody.exit_code == 2);
    CHECK(is_one_line_about(nobody.err, "--wearers"));
    const auto hermits = nendo::test::nendo({"bench", "solve", "--neighbours", "0"});
    CHECK(hermits.exit_code == 2);
    CHECK(is_one_line_about(hermits.err, "--neighbours"));
    const auto never = nendo::test::nendo({"bench", "rt", "--rounds", "0"});
    CHECK(never.exit_code == 2);
    CHECK(is_one_line_about(never.err, "--rounds"));
    const auto unheard = nendo::test::nendo({"bench", "rt", "--part", "gears"});
    CHECK(unheard.exit_code == 2);
    CHECK(is_one_line_about(unheard.err, "gears"));
    const auto no_time = nendo::test::nendo({"bench", "rt", "--seconds", "0"});
    CHECK(no_time.exit_code == 2);
    CHECK(is_one_line_about(no_time.err, "--seconds"));
    const auto few = nendo::test::nendo({"bench", "soak", "--records", "1"});
    CHECK(few.exit_code == 2);
    CHECK(is_one_line_about(few.err, "--records"));
  }
}

} // namespace bench_command_test
