// A recording has an end, and so has what is done with it as a glove.

#include <csignal>
#include <thread>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/json_lines.hpp"
#include "support/program.hpp"

namespace replay_end_test {

using namespace nendo;
using nendo::test::contents;
using nendo::test::lines_of;
using nendo::test::TemporaryFolder;
using nlohmann::json;

namespace {

/// A folder with a recording of both hands, of half a second.
struct Recorded {
  TemporaryFolder folder;
  std::string take = path("take.nendo");
  json gloves;

  Recorded() {
    const auto done = test::nendo(
        {"record", "sim:wave?hand=left", "sim:pinch?rate=50", "--out", take, "--duration", "0.5s"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    gloves = last_object(test::nendo({"recording", "info", take, "--json"}))["gloves"];
    REQUIRE(gloves.size() == 2);
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  std::string replay(const std::string& hand, const std::string& more = "") const {
    return "replay:" + take + "?hand=" + hand + more;
  }
  std::size_t samples(std::size_t glove) const { return gloves[glove]["samples"]; }
};

} // namespace

TEST_SUITE("replay_end") {
  TEST_CASE("monitor and poses end with the last sample, and have shown each") {
    const Recorded recorded;
    const auto seen = test::nendo({"monitor", recorded.replay("left"), "--json"});
    CAPTURE(seen.err);
    CHECK(seen.exit_code == 0);
    CHECK(lines_of(seen.out).size() == recorded.samples(0));
    const auto posed = test::nendo({"poses", recorded.replay("right")});
    CAPTURE(posed.err);
    CHECK(posed.exit_code == 0);
    CHECK(lines_of(posed.out).size() == recorded.samples(1));
    const std::string bvh = recorded.path("hand.bvh");
    const auto written = test::nendo({"poses", recorded.replay("right"), "--bvh", bvh});
    CHECK(written.exit_code == 0);
    CHECK(contents(bvh).find("Frames:") != std::string::npos); // complete
  }

  TEST_CASE("record and run end when both gloves have ended, with all that they sent") {
    const Recorded recorded;
    const std::string again = recorded.path("again.nendo");
    const auto copied = test::nendo(
        {"record", recorded.replay("left"), recorded.replay("right"), "--out", again, "--json"});
    CAPTURE(copied.err);
    CHECK(copied.exit_code == 0);
    const json gloves = last_object(test::nendo({"recording", "info", again, "--json"}))["gloves"];
    CHECK(gloves[0]["samples"] == recorded.samples(0));
    CHECK(gloves[1]["samples"] == recorded.samples(1));

    const std::string out = recorded.path("clay.obj");
    for (const std::string policy : {"skip", "sample"}) {
      CAPTURE(policy);
      const auto shaped = test::nendo({"run", "--left", recorded.replay("left"), "--right",
                                       recorded.replay("right", "&speed=0.5"), "--policy", policy,
                                       "--json", "--out", out, "--duration", "50"});
      CAPTURE(shaped.err);
      CHECK(shaped.exit_code == 0);
      CHECK(shaped.seconds < 40.0); // the run ended before its duration
      const json summary = last_object(shaped);
      // Recordings restart when the loop is ready, which knows by then how the hands begin.
      CHECK(summary["left"]["samples"] == recorded.samples(0));
      CHECK(summary["right"]["samples"] == recorded.samples(1));
      CHECK(shaped.seconds > 0.8); // the slower of the two
      CHECK(std::filesystem::file_size(out) > 0);
    }
  }

  TEST_CASE(
      "with end=hold, or with a glove that does not end, they continue until somebody ends them") {
    const Recorded recorded;
    const std::vector<std::vector<std::string>> lasting{
        {"monitor", recorded.replay("left", "&end=hold"), "--json"},
        {"poses", recorded.replay("left", "&end=hold")},
        {"record", recorded.replay("left"), "sim:wave", "--out", recorded.path("long.nendo")},
        {"run", "--left", recorded.replay("left", "&end=hold"), "--out", recorded.path("a.obj")}};
    std::vector<std::unique_ptr<test::Program>> programs;
    for (const auto& arguments : lasting)
      programs.push_back(std::make_unique<test::Program>(arguments));
    for (const auto& program : programs)
      CHECK(program->gets_handler_of(SIGINT));
    std::this_thread::sleep_for(std::chrono::seconds(4)); // eight times as long as the recording
    for (std::size_t at = 0; at < lasting.size(); ++at) {
      CAPTURE(lasting[at].front());
      CHECK(::kill(programs[at]->id(), 0) == 0);
      CHECK(::waitid(P_PID, static_cast<id_t>(programs[at]->id()), nullptr,
                     WEXITED | WNOHANG | WNOWAIT) == 0);
      programs[at]->signal(SIGINT);
      const auto done = programs[at]->wait();
      CHECK(done.exit_code == 0);
      CHECK(done.seconds > 3.5); // it was the signal that ended it
    }
  }
}

} // namespace replay_end_test
