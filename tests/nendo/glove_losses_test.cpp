// Losses on the line and in the program: every command that sums up a glove tells them apart.

#include <csignal>
#include <filesystem>
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
    const auto printed = test::nendo({"recording", "info", take});
    CHECK(counts_in(printed.out)["missed"] == info["missed"].get<double>());
    CHECK(printed.out.find(" lost") == std::string::npos);
    CHECK(test::nendo({"recording", "check", take}).exit_code == 0);

    const auto text = test::nendo({"record", glove.spec, "--out", take + "2", "--duration", "2s"});
    check_losses(counts_in(text.out));
    CHECK(text.out.find(" lost") == std::string::npos);
  }

  TEST_CASE("12-bit records lose one in five, and their numbers tell it") {
    const TemporaryFolder folder;
    const std::string link = (folder.path() / "glove").string();
    const std::string take = (folder.path() / "take.nendo").string();
    const test::Program emulator(
        {"emulate", "--model", "3", "--link", link, "--fault", "lose=20%"});
    test::appears(link);
    for (const std::string options : {"?hires=on", "?hires=on&rate=120"}) {
      const auto done = test::nendo({"record", "serial:" + link + options, "--out",
                                     take + options.substr(1), "--duration", "2s", "--json"});
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      check_losses(last_object(done)["gloves"][0]);
    }
    const auto shown = test::nendo(
        {"monitor", "serial:" + link + "?hires=on", "--json", "--raw", "--count", "150"});
    check_losses(counts_in(shown.err));
  }

  TEST_CASE(
      "a glove that does not report its losses is said to have sent nothing that nobody saw") {
    const TemporaryFolder folder;
    const std::string link = (folder.path() / "glove").string();
    const std::string take = (folder.path() / "take.nendo").string();
    const test::Program emulator(
        {"emulate", "--rate", "100", "--link", link, "--fault", "lose=20%"});
    test::appears(link);
    const std::string spec = "serial:" + link + "?stamps=off&rate=100";
    const auto done = test::nendo({"record", spec, "--out", take, "--duration", "3s", "--json"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const json recorded = last_object(done)["gloves"][0];
    CHECK(recorded["sent"].is_null());
    CHECK(recorded["missed"].is_null());
    CHECK(recorded["delivered"].get<int>() > 100);
    const auto info = last_object(test::nendo({"recording", "info", take, "--json"}))["gloves"][0];
    for (const std::string name : {"sent", "delivered", "missed", "refused", "bad_records"})
      CHECK(info[name] == recorded[name]);
    const auto printed = test::nendo({"recording", "info", take});
    CHECK(printed.out.find(" sent") == std::string::npos);
    // It is set to 100, and delivers 80.
    const auto shown = test::nendo({"monitor", spec, "--json", "--raw", "--count", "250"});
    CAPTURE(shown.err);
    CHECK(shown.err.find(" sent") == std::string::npos);
    CHECK(shown.err.find("of the 100.0 that were asked for") != std::string::npos);
  }

  TEST_CASE("values out of range are counted wherever losses are") {
    const TemporaryFolder folder;
    const std::string link = (folder.path() / "glove").string();
    const std::string take = (folder.path() / "take.nendo").string();
    const test::Program emulator({"emulate", "--glove", "lucidgloves", "--firmware",
                                  "legacy-unclamped", "--motion", "grasp", "--link", link});
    test::appears(link);
    const auto done =
        test::nendo({"record", "lucidgloves:" + link, "--out", take, "--duration", "2s", "--json"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const json recorded = last_object(done)["gloves"][0];
    CHECK(recorded["bad_records"] == 0);
    CHECK(recorded["clamped_values"].get<int>() > 0);
    const auto info = last_object(test::nendo({"recording", "info", take, "--json"}))["gloves"][0];
    CHECK(info["clamped_values"] == recorded["clamped_values"]);
    const auto shown =
        test::nendo({"monitor", "lucidgloves:" + link, "--json", "--raw", "--count", "100"});
    CHECK(shown.err.find("values out of range") != std::string::npos);
  }

  TEST_CASE("two right-hand gloves: the advice of the error works as it stands") {
    const TemporaryFolder folder;
    const std::string one = (folder.path() / "one").string();
    const std::string two = (folder.path() / "two").string();
    const std::string take = (folder.path() / "take.nendo").string();
    const test::Program first({"emulate", "--link", one});
    const test::Program second({"emulate", "--link", two});
    test::appears(one);
    test::appears(two);
    for (const std::string options : {"", "?rate=60"}) {
      std::filesystem::remove(take);
      const auto refused = test::nendo(
          {"record", "serial:" + one, "serial:" + two + options, "--out", take, "--duration", "1"});
      CAPTURE(refused.err);
      CHECK(refused.exit_code == 2);
      const std::string mark = "say ";
      const auto at = refused.err.find(mark);
      REQUIRE(at != std::string::npos);
      std::string advice = refused.err.substr(at + mark.size());
      advice.erase(advice.find('\n'));
      REQUIRE(advice.size() > 2); // in quotes, for the shell
      CHECK(advice.front() == '\'');
      advice = advice.substr(1, advice.size() - 2);
      CAPTURE(advice);
      const auto done = test::nendo({"record", "serial:" + one, advice, "--out", take + options,
                                     "--duration", "1s", "--json"});
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      CHECK(done.err.find("says that it is a right-hand one") != std::string::npos);
      const json gloves = last_object(done)["gloves"];
      REQUIRE(gloves.size() == 2);
      CHECK(gloves[0]["hand"] == "right");
      CHECK(gloves[1]["hand"] == "left");
    }
    // The other commands take the same name.
    for (const std::string command : {"info", "monitor", "poses"}) {
      std::vector<std::string> words{command, "serial:" + two + "?hand=left"};
      if (command == "monitor") words.insert(words.end(), {"--json"});
      if (command != "info") words.insert(words.end(), {"--count", "3"});
      const auto done = test::nendo(words);
      CAPTURE(done.err);
      CHECK(done.exit_code == 0);
      CHECK(done.out.find("left") != std::string::npos);
    }
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

  TEST_CASE("monitor's lines are samples only, and what never became one is reported beside them") {
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
