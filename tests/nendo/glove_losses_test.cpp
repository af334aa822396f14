// Losses on the line and in the program: every command that sums up a glove tells them apart.

#include <csignal>
#include <map>
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/json_lines.hpp"
#include "support/program.hpp"

namespace glove_losses_test {

using namespace nendo;
using nendo::test::lines_of;
using nendo::test::TemporaryFolder;
using nlohmann::json;

namespace {

/// An emulated glove of which one record in five gets lost on the line.
struct LossyGlove {
  TemporaryFolder folder;
  std::string spec = "serial:" + path("glove");
  test::Program emulator{
      {"emulate", "--link", path("glove"), "--rate", "100", "--pattern", "--fault", "lose=20%"}};

  LossyGlove() { test::appears(path("glove")); }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
};

/// One in five got lost, and nothing else did. Some 200 records were sent, so the share is within
/// 5 standard deviations, which are 3 % each.
void check_losses(const json& glove) {
  CAPTURE(glove.dump());
  const double sent = glove["sent"];
  const double missed = glove["missed"];
  CHECK(sent == glove["delivered"].get<double>() + missed);
  CHECK(sent > 60.0);
  CHECK(missed > 0.05 * sent);
  CHECK(missed < 0.35 * sent);
  CHECK(glove["refused"] == 0);
}

/// Returns the number before these words.
double number_before(const std::string& text, const std::string& words) {
  const auto end = text.find(" " + words);
  REQUIRE_MESSAGE(end != std::string::npos, words << " in " << text);
  const auto begin = text.find_last_not_of("0123456789", end - 1) + 1;
  return std::stod(text.substr(begin, end - begin));
}

/// Finds the same counts in a text for people.
json counts_in(const std::string& text) {
  json counts;
  for (const std::string name : {"sent", "delivered", "missed", "refused"})
    counts[name] = number_before(text, name);
  return counts;
}

} // namespace

TEST_SUITE("glove_losses") {
  TEST_CASE("what the line lost is missed, not 0 lost: record, and its recording for ever") {
    const LossyGlove glove;
    const std::string take = glove.path("take.nendo");
    const auto done =
        test::nendo({"record", glove.spec, "--out", take, "--duration", "2s", "--json"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const json recorded = last_object(done);
    REQUIRE(recorded["gloves"].size() == 1);
    check_losses(recorded["gloves"][0]);
    CHECK(recorded["gloves"][0]["hand"] == "right");
    CHECK(recorded["gloves"][0]["delivered"] == recorded["samples"]);
    CHECK(recorded["lost"] == 0); // none of those that came

    const auto info = last_object(test::nendo({"recording", "info", take, "--json"}))["gloves"][0];
    for (const std::string name : {"sent", "delivered", "missed", "refused", "bad_records"})
      CHECK(info[name] == recorded["gloves"][0][name]);
    const auto told = test::nendo({"recording", "info", take});
    CHECK(counts_in(told.out)["missed"] == info["missed"].get<double>());
    CHECK(told.out.find(" lost") == std::string::npos);
    CHECK(test::nendo({"recording", "check", take}).exit_code == 0);

    const auto text = test::nendo({"record", glove.spec, "--out", take + "2", "--duration", "2s"});
    check_losses(counts_in(text.out));
    CHECK(text.out.find(" lost") == std::string::npos);
  }

  TEST_CASE("run and stress tell the same, as text and as JSON, and so does a run's recording") {
    const LossyGlove glove;
    const std::string take = glove.path("take.nendo");
    const std::string out = glove.path("clay.obj");
    const auto run = test::nendo({"run", "--right", glove.spec, "--duration", "2", "--out", out,
                                  "--json", "--record", take});
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    const json summary = last_object(run);
    check_losses(summary["right"]);
    CHECK(summary["right"]["ring_refused"] == 0);
    CHECK(summary["right"]["samples_per_s"].get<double>() < 100.0); // the line's, not the glove's
    check_losses(summary["recordings"][0]["gloves"][0]);
    check_losses(last_object(test::nendo({"recording", "info", take, "--json"}))["gloves"][0]);

    const auto text = test::nendo({"run", "--right", glove.spec, "--duration", "2", "--out", out});
    REQUIRE(text.exit_code == 0);
    check_losses(counts_in(text.out));
    CHECK(text.out.find("0 lost") == std::string::npos);

    const auto stressed = test::nendo({"stress", "--right", glove.spec, "-D", "2", "--json"});
    CAPTURE(stressed.err);
    REQUIRE(stressed.exit_code == 0);
    const json report = last_object(stressed);
    REQUIRE(report["gloves"].size() == 1);
    check_losses(report["gloves"][0]);
    CHECK(report["gloves"][0]["source"] == glove.spec);
  }

  TEST_CASE("monitor's lines are samples only, and what never became one is told beside them") {
    const LossyGlove glove;
    const auto done = test::nendo({"monitor", glove.spec, "--json", "--raw", "--count", "150"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    CHECK(lines_of(done.out).size() == 150);
    check_losses(counts_in(done.err));
    CHECK(number_before(done.err, "delivered") >= 150.0);
    const auto sim = test::nendo({"monitor", "sim", "--json", "--raw", "--count", "20"});
    CHECK(sim.err.find("missed") == std::string::npos);
  }
}

} // namespace glove_losses_test
