#include <csignal>
#include <set>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "support/memory_screen.hpp"
#include "support/program.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace stress_command_test {

using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nendo::test::Program;
using nendo::test::TemporaryFolder;
using nlohmann::json;

namespace {

json report_of(const nendo::test::Finished& done) {
  CAPTURE(done.err);
  const auto lines = lines_of(done.out);
  REQUIRE(lines.size() == 1);
  return json::parse(lines.front());
}

bool is_running_child_of(pid_t parent, const std::filesystem::path& process) {
  std::ifstream file(process / "stat");
  std::string text;
  std::getline(file, text);
  const std::size_t end = text.rfind(')');
  if (end == std::string::npos) return false;
  std::istringstream rest(text.substr(end + 1));
  char state = 0;
  pid_t of = 0;
  rest >> state >> of;
  return of == parent && state != 'Z';
}

std::set<pid_t> children_of(pid_t parent) {
  std::set<pid_t> children;
  for (const auto& process : std::filesystem::directory_iterator("/proc")) {
    const std::string name = process.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (is_running_child_of(parent, process.path())) children.insert(std::stoi(name));
  }
  return children;
}

bool all_gone(const std::set<pid_t>& processes) {
  for (int turn = 0; turn < 2000; ++turn) {
    bool any = false;
    for (const pid_t process : processes)
      any = any || std::filesystem::exists("/proc/" + std::to_string(process) + "/exe") ||
            ::kill(process, 0) == 0;
    if (!any) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

} // namespace

TEST_SUITE("stress") {
  TEST_CASE("its report is one object with every figure, raw and for each scheduled tick") {
    const auto done = nendo::test::nendo(
        {"stress", "-i", "5000", "-D", "1", "--floor", "0.1", "-p", "0", "--json"});
    REQUIRE(done.exit_code == 0);
    const json report = report_of(done);
    CHECK(report["event"] == "stress");
    CHECK(report["ended"] == "duration");
    CHECK(report["ticks"].get<int>() + report["missed"].get<int>() == 200);
    for (const char* measure :
         {"lateness_us", "period_error_us", "work_us", "input_age_us", "end_to_end_us"}) {
      for (const json& figures : {report[measure], report["corrected"][measure]}) {
        double before = figures["min"];
        for (const char* figure : {"p50", "p90", "p99", "p99_9", "p99_99", "max"}) {
          CHECK(figures[figure].get<double>() >= before);
          before = figures[figure];
        }
      }
    }
    // Deadlines that were missed after the last tick waited for none.
    CHECK(report["corrected"]["lateness_us"]["count"].get<int>() >= report["ticks"].get<int>());
    CHECK(report["corrected"]["lateness_us"]["count"].get<int>() <= 200);
    for (const char* key : {"kernel", "preemption", "processor", "cpus", "hypervisor", "governor",
                            "clock_source", "rate_hz", "policy", "realtime", "load", "stages"})
      CHECK(report["environment"].contains(key));
    CHECK(report["environment"]["rate_hz"] == 200.0);
    CHECK(report["worst"].size() == 10);
    CHECK(report["floor"]["spun_s"].get<double>() >= 0.1);
  }

  TEST_CASE("stages that are left out take no time, and without input no sample is drained") {
    const auto done = nendo::test::nendo({"stress", "-i", "2000", "-D", "0.5", "--floor", "0", "-p",
                                          "0", "--stages", "sleep", "--json"});
    REQUIRE(done.exit_code == 0);
    const json report = report_of(done);
    CHECK(report["samples"] == 0);
    CHECK(report["input_age_us"].is_null());
    CHECK(report["floor"].is_null());
    CHECK(report["environment"]["stages"] == json{"sleep"});
  }

  TEST_CASE("paced by samples the loop ticks as often as they come") {
    const auto done =
        nendo::test::nendo({"stress", "--policy", "sample", "--left", "sim?rate=200", "-D", "1",
                            "-i", "1000", "--floor", "0", "-p", "0", "--json"});
    REQUIRE(done.exit_code == 0);
    const json report = report_of(done);
    CHECK(report["samples"].get<int>() > 20);
    CHECK(report["ticks"].get<int>() <= report["samples"].get<int>() + 20);
    CHECK(report["missed"] == 0);
    CHECK(report["period_error_us"].is_null());
  }

  TEST_CASE("--fail-if names the condition that failed and exits with 1") {
    const auto run = [](const std::string& condition) {
      return nendo::test::nendo(
          {"stress", "-D", "0.2", "--floor", "0", "-p", "0", "--fail-if", condition, "--json"});
    };
    const auto bad = run("ticks>0,max>1000s");
    CHECK(bad.exit_code == 1);
    CHECK(bad.err.find("nendo: --fail-if ticks>0 (") != std::string::npos);
    CHECK(bad.err.find("max>1000s") == std::string::npos);
    CHECK(run("max>1000s").exit_code == 0);
  }

  TEST_CASE(
      "work longer than a period is found to be the loop's own, and waiting to be preemption") {
    const TemporaryFolder folder;
    const std::string big = (folder.path() / "big.obj").string();
    REQUIRE(nendo::deform::write_mesh(big, nendo::test::sphere(300, 600, 1.0)));
    for (const bool loaded : {false, true}) {
      std::vector<std::string> arguments{
          "stress",       "-i",      "100",          "-D",    "2",      "--floor", "0",
          "-p",           "0",       "--radius",     "5",     "--mesh", big,       "--left",
          "sim?rate=500", "--right", "sim?rate=500", "--json"};
      if (loaded) arguments.insert(arguments.end(), {"-a", "0", "--load", "cpu,cpu,cpu,cpu"});
      const auto done = nendo::test::nendo(arguments);
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      const json report = report_of(done);
      CHECK(report["missed"].get<int>() > report["ticks"].get<int>());
      const json& incidents = report["incidents"];
      CAPTURE(incidents.dump());
      const int waited = incidents["by_cause"]["preemption"]["incidents"];
      const int worked = incidents["by_cause"]["own work"]["incidents"];
      CHECK((loaded ? waited : waited + worked) > 0); // others may load this machine, too
      CHECK(incidents["explained"].get<double>() >= 0.99);
    }
  }

  TEST_CASE("--changes counts the ticks of seconds with and without changes apart") {
    const json report = report_of(nendo::test::nendo(
        {"stress", "-D", "3", "-p", "0", "--floor", "0", "--changes", "600", "--json"}));
    const json& changes = report["changes"];
    CHECK(changes["a_minute"] == 600.0);
    CHECK(changes["taken"].get<int>() >= 3); // of ten in the second second
    CHECK(changes["taken"].get<int>() <= 12);
    for (const auto* half : {"with", "without"})
      CHECK(changes[half]["work_us"]["count"] == changes[half]["ticks"]);
    CHECK(changes["with"]["ticks"].get<int>() > 100);
    CHECK(changes["with"]["ticks"].get<int>() + changes["without"]["ticks"].get<int>() ==
          report["ticks"].get<int>());
    const json without =
        report_of(nendo::test::nendo({"stress", "-D", "0.2", "-p", "0", "--floor", "0", "--json"}));
    CHECK(without["changes"].is_null());
  }

  TEST_CASE("--break ends at the first tick that is too late") {
    const auto done = nendo::test::nendo(
        {"stress", "-D", "60", "--floor", "0", "-p", "0", "-b", "0.001", "--json"});
    CHECK(done.exit_code == 0);
    CHECK(report_of(done)["ended"] == "break");
    CHECK(done.seconds < 30.0);
  }

  TEST_CASE("its files can be read, and a report be compared with an earlier one") {
    const TemporaryFolder folder;
    const auto file = [&](const char* name) { return (folder.path() / name).string(); };
    const auto first =
        nendo::test::nendo({"stress", "-D", "0.3", "--floor", "0", "-p", "0", "--json", "--hgrm",
                            file("a.hgrm"), "--picture", file("a.svg")});
    REQUIRE(first.exit_code == 0);
    CHECK(nendo::test::contents(file("a.hgrm")).find("1/(1-Percentile)") != std::string::npos);
    const std::string svg = nendo::test::contents(file("a.svg"));
    CHECK(svg.starts_with("<svg "));
    CHECK(svg.ends_with("</svg>\n"));
    CHECK(svg.find("nan") == std::string::npos);
    CHECK(svg.find("inf") == std::string::npos);
    nendo::test::write_file(file("a.json"), first.out);
    const auto second = nendo::test::nendo({"stress", "-D", "0.3", "--floor", "0", "-p", "0", "-h",
                                            "50", "--compare", file("a.json")});
    REQUIRE(second.exit_code == 0);
    CHECK(second.out.find("per scheduled tick") != std::string::npos);
    CHECK(second.out.find("earlier") != std::string::npos);
    CHECK(second.out.find("\n000049 ") != std::string::npos);
    CHECK(second.err.find("other options") == std::string::npos);
    const auto other =
        nendo::test::nendo({"stress", "-D", "0.3", "--floor", "0", "-p", "0", "--stages",
                            "sleep,input", "--load", "cpu", "--compare", file("a.json")});
    CHECK(other.exit_code == 0);
    CHECK(other.err.find("--compare " + file("a.json")) != std::string::npos);
    CHECK(other.err.find("stages [") != std::string::npos);
    CHECK(other.err.find("load [] then and [\"cpu\"] now") != std::string::npos);
    CHECK(other.err.find("vertices") == std::string::npos); // the same model
    nendo::test::write_file(file("b.json"), "{\"event\":\"summary\"}");
    const auto bad = nendo::test::nendo({"stress", "-D", "0.3", "--compare", file("b.json")});
    CHECK(bad.exit_code == 5);
    CHECK(is_one_line_about(bad.err, "b.json"));
  }

  TEST_CASE("errors are one line before anything runs") {
    struct Wrong {
      std::vector<std::string> arguments;
      int code;
      const char* about;
    };
    for (const Wrong& wrong :
         {Wrong{{"-i", "1"}, 2, "--interval"}, Wrong{{"-D", "never"}, 2, "--duration"},
          Wrong{{"--stages", "dance"}, 2, "--stages"}, Wrong{{"-p", "99"}, 2, "--priority"},
          Wrong{{"--changes", "1e9"}, 2, "--changes"},
          Wrong{{"--changes", "9", "--stages", "sleep,input"}, 2, "--changes"},
          Wrong{{"-a", "4096"}, 2, "--affinity"}, Wrong{{"--fail-if", "p42>1"}, 2, "--fail-if"},
          Wrong{{"--mesh", "/no/such.obj"}, 5, "/no/such.obj"},
          Wrong{{"--picture", "/no/such/folder/x.svg"}, 1, "--picture"},
          Wrong{{"--left", "nonsense"}, 2, "nonsense"}}) {
      std::vector<std::string> arguments{"stress", "--floor", "0"};
      arguments.insert(arguments.end(), wrong.arguments.begin(), wrong.arguments.end());
      const auto done = nendo::test::nendo(arguments);
      CAPTURE(done.err);
      CHECK(done.exit_code == wrong.code);
      CHECK(is_one_line_about(done.err, wrong.about));
    }
  }

  TEST_CASE("an interrupted test still reports, and leaves no load behind, not even when killed") {
    for (const int signal : {SIGINT, SIGKILL}) {
      Program program(
          {"stress", "-D", "60", "--floor", "0", "-p", "0", "--load", "cpu,mem,io", "--json"});
      std::set<pid_t> workers;
      for (int turn = 0; turn < 2000 && workers.size() < 3; ++turn) {
        workers = children_of(program.id());
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
      REQUIRE(workers.size() >= 3);
      for (int turn = 0; turn < 4000 && program.err_so_far().find("ticks") == std::string::npos;
           ++turn)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      program.signal(signal);
      const auto done = program.wait();
      CHECK(all_gone(workers));
      if (signal == SIGINT) {
        CHECK(done.exit_code == 0);
        CHECK(report_of(done)["ended"] == "stopped");
      }
    }
  }

  TEST_CASE("the live window looks on, and without a screen there is one line about it") {
    const std::vector<std::string> seen{"stress", "-i", "5000", "-D",     "1",     "--floor",
                                        "0",      "-p", "0",    "--view", "--json"};
    {
      const nendo::test::MemoryScreen screen;
      // Mesa's own memory is not for our sanitizers, in a child either.
      if (screen.is_there() && nendo::test::restraint_is_counted) {
        const json report = report_of(nendo::test::nendo(seen));
        CHECK(report["environment"]["pictures"] > 0);
        CHECK(report["ticks"].get<int>() + report["missed"].get<int>() == 200);
      }
    }
    const auto unseen = nendo::test::nendo(seen);
    CHECK(unseen.exit_code == 1);
    CHECK(is_one_line_about(unseen.err, "window"));
  }
}

} // namespace stress_command_test
