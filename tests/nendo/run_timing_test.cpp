// How a run is paced, what it asks of the system, and its second thread.

#include <string>
#include <utility>
#include <vector>

#include <sched.h>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "cli/processors.hpp"
#include "support/json_lines.hpp"
#include "support/program.hpp"

namespace run_timing_test {

using namespace nendo;
using nendo::cli::two_processors;
using nendo::test::is_one_line_about;
using nendo::test::last_object;
using nendo::test::lines_of;
using nendo::test::TemporaryFolder;
using nlohmann::json;

TEST_SUITE("run_timing") {
  TEST_CASE(
      "the rights that a run asks for are granted or refused, in the summary and in one line") {
    const TemporaryFolder folder;
    const auto done =
        nendo::test::nendo({"run", "--left", "sim", "--right", "sim", "--rate", "200", "--duration",
                            "0.5", "--priority", "80", "--mlockall", "--affinity", "0", "--policy",
                            "catch-up:3", "--json", "--out", (folder.path() / "x.obj").string()});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const json summary = last_object(done);
    CHECK(summary["policy"] == "catch-up:3");
    CHECK(summary["ticks"].get<int>() + summary["missed"].get<int>() == 100);
    std::size_t refused = 0;
    std::vector<std::string> names;
    for (const json& grant : summary["realtime"]) {
      names.push_back(grant["name"]);
      if (grant["granted"] == true) continue;
      ++refused;
      CHECK(done.err.find(grant["wanted"].get<std::string>() + " refused (") != std::string::npos);
    }
    CHECK(names == std::vector<std::string>{"memory_lock", "dma_latency", "reader_policy",
                                            "affinity", "policy", "timer_slack"});
    CHECK(lines_of(done.err).size() == refused);
  }

  TEST_CASE("a run may be paced by its gloves' samples") {
    const TemporaryFolder folder;
    const auto done = nendo::test::nendo({"run", "--right", "sim?rate=100", "--policy", "sample",
                                          "--rate", "1000", "--duration", "1", "--json", "--out",
                                          (folder.path() / "x.obj").string()});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const json summary = last_object(done);
    CHECK(summary["elapsed_s"].get<double>() >= 1.0);
    CHECK(summary["right"]["samples"].get<int>() > 20);
    // A tick for each sample, and ten a second without one.
    CHECK(summary["ticks"].get<int>() <= summary["right"]["samples"].get<int>() + 20);
    CHECK(summary["missed"] == 0);
  }

  TEST_CASE("timing that cannot be is refused by the option's name") {
    for (const auto& [option, value] : {std::pair{"--priority", "98"},
                                        {"--priority", "-1"},
                                        {"--affinity", "99999"},
                                        {"--affinity", "zero"},
                                        {"--policy", "hurry"},
                                        {"--policy", "catch-up:0"},
                                        {"--spin", "on"},
                                        {"--spin", "maybe"},
                                        {"--threads", "0"},
                                        {"--threads", "3"}}) {
      const auto done = nendo::test::nendo({"run", "--left", "sim", option, value});
      CHECK(done.exit_code == 2);
      CHECK(is_one_line_about(done.err, option));
    }
  }

  TEST_CASE("what two threads have shaped is what one makes of the recording, byte for byte") {
    if (!two_processors()) {
      MESSAGE("one processor: not tested");
      return;
    }
    const TemporaryFolder folder;
    const auto take = (folder.path() / "take").string();
    const auto live = folder.path() / "live.obj";
    const auto again = folder.path() / "again.obj";
    for (const std::string mode : {"type1", "type2"}) {
      const auto done = nendo::test::nendo({"run", "--left", "sim", "--right", "sim", "--mode",
                                            mode, "--threads", "2", "--duration", "0.5", "--record",
                                            take, "--json", "--out", live.string()});
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      const json summary = last_object(done);
      CHECK(summary["threads"] == 2);
      CHECK(summary["failed"] == 0);
      REQUIRE(
          nendo::test::nendo({"replay", take, "--no-clock", "--out", again.string()}).exit_code ==
          0);
      const std::string shape = nendo::test::contents(live);
      CHECK(shape.size() > 1000);
      CHECK(nendo::test::contents(again) == shape);
      for (const auto& file : {std::filesystem::path(take), live, again})
        std::filesystem::remove(file);
    }
  }

  TEST_CASE("a second thread needs a processor, and the loop to be scheduled like it") {
    const auto with_priority =
        nendo::test::nendo({"run", "--left", "sim", "--threads", "2", "--priority", "5"});
    CHECK(with_priority.exit_code == 2);
    CHECK(
        is_one_line_about(with_priority.err, "--threads 2: cannot be combined with --priority 5"));
    const auto stress = nendo::test::nendo({"stress", "--threads", "2"});
    CHECK(stress.exit_code == 2);
    CHECK(is_one_line_about(stress.err, "--priority 0"));

    cpu_set_t allowed, first;
    REQUIRE(sched_getaffinity(0, sizeof allowed, &allowed) == 0);
    CPU_ZERO(&first);
    for (std::size_t n = 0; CPU_COUNT(&first) == 0; ++n)
      if (CPU_ISSET(n, &allowed)) CPU_SET(n, &first);
    REQUIRE(sched_setaffinity(0, sizeof first, &first) == 0);
    const auto alone = nendo::test::nendo({"run", "--left", "sim", "--threads", "2"});
    REQUIRE(sched_setaffinity(0, sizeof allowed, &allowed) == 0);
    CHECK(alone.exit_code == 1);
    CHECK(is_one_line_about(alone.err, "--threads 2"));
  }
}

} // namespace run_timing_test
