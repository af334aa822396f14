// What nendo stress understands, and what it refuses in words.

#include <cerrno>
#include <cmath>
#include <csignal>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "cli/quantities.hpp"
#include "stress/load.hpp"
#include "stress/stress_options.hpp"

namespace stress_options_test {

using namespace nendo;
using namespace nendo::cli;
using namespace nendo::stress;
using nlohmann::ordered_json;

namespace {

const ordered_json figures{{"p50", 10.0}, {"p99", 50.0}, {"p99_9", 200.0}, {"max", 900.0}};
const ordered_json report{{"ticks", 1000},
                          {"missed", 3},
                          {"page_faults", 0},
                          {"longest_outage_us", 2500.0},
                          {"lateness_us", figures},
                          {"work_us", {{"p99", 120.0}}},
                          {"end_to_end_us", nullptr},
                          {"corrected", {{"lateness_us", {{"p99_9", 7000.0}}}}}};

bool holds(const std::string& condition) {
  const auto parsed = parse_conditions(condition);
  REQUIRE(parsed);
  return !fulfilled(*parsed, report).empty();
}

} // namespace

TEST_SUITE("stress options") {
  TEST_CASE("a condition compares a figure of the report with a number in any unit") {
    CHECK(holds("p99.9>199us"));
    CHECK_FALSE(holds("p99.9>200us"));
    CHECK(holds("p99.9>=200us"));
    CHECK(holds("p99.9>0.1ms"));
    CHECK(holds("p99.9>100"));
    CHECK_FALSE(holds("p99.9>1s"));
    CHECK(holds("p50<11"));
    CHECK_FALSE(holds("p50<10"));
    CHECK(holds("p50<=10"));
    CHECK(holds("lateness.max>899999ns"));
    CHECK(holds("work.p99>100us"));
    CHECK(holds("corrected.p99.9>1ms"));
    CHECK_FALSE(holds("corrected.lateness.p99.9>8ms"));
    CHECK(holds("missed>0"));
    CHECK_FALSE(holds("missed>3"));
    CHECK_FALSE(holds("faults>0"));
    CHECK(holds("longest_outage>2ms"));
  }

  TEST_CASE("of several conditions those that hold are named, with the figure") {
    const auto conditions = parse_conditions("p99>1ms,missed>0,p99.9>150us");
    REQUIRE(conditions);
    const auto lines = fulfilled(*conditions, report);
    REQUIRE(lines.size() == 2);
    CHECK(lines[0] == "missed>0 (3)");
    CHECK(lines[1] == "p99.9>150us (200 us)");
    CHECK(parse_conditions("")->empty());
  }

  TEST_CASE("a figure that was not measured fails the test rather than passing it") {
    CHECK(holds("end_to_end.p99>1s"));
    CHECK(holds("overruns>1000"));
    CHECK(holds("input_age.p50>1s"));
  }

  TEST_CASE("what is no condition is refused") {
    for (const char* text : {"p99.9", ">5", "p99.9>", "p99.9>x", "p98>5us", "missed>0us", "p50=5",
                             "p50>5kg", "p50>-1", "p50>nan", "p50>inf", "p50>1,", ",", "work>5",
                             "corrected>5", "corrected.missed>0", "p50>>5", "p50>1e999"}) {
      CAPTURE(text);
      const auto parsed = parse_conditions(text);
      REQUIRE_FALSE(parsed);
      CHECK(parsed.error().code == Errc::usage);
      CHECK(parsed.error().message.find("--fail-if ") == 0);
    }
  }

  TEST_CASE("durations have units as cyclictest's have") {
    CHECK(*parse_duration("90") == 90.0);
    CHECK(*parse_duration("0.5s") == 0.5);
    CHECK(*parse_duration("10m") == 600.0);
    CHECK(*parse_duration("2h") == 7200.0);
    CHECK(*parse_duration("1d") == 86'400.0);
    for (const char* text : {"", "0", "-1", "x", "5w", "1 h", "nan", "inf", "1e9", "200d", "5mm"})
      CHECK_FALSE(parse_duration(text));
  }

  TEST_CASE("stages are a list, in which sleep goes without saying") {
    const auto some = parse_stages("sleep,deform");
    REQUIRE(some);
    CHECK(some->deform);
    CHECK_FALSE(some->input);
    CHECK_FALSE(some->hands);
    CHECK_FALSE(some->publish);
    CHECK(parse_stages("input,hands,publish")->publish);
    for (const char* text : {"", "sleep,", "wake", "sleep,,input", "SLEEP"})
      CHECK_FALSE(parse_stages(text));
  }

  TEST_CASE("defaults can be run, and each impossible argument is refused by its name") {
    CHECK(parse(StressArguments{}));
    const auto refused = [](const std::string& name, const auto& change) {
      StressArguments arguments;
      change(arguments);
      const auto options = parse(arguments);
      REQUIRE_FALSE(options);
      CHECK(options.error().code == Errc::usage);
      CHECK(options.error().message.find(name) == 0);
    };
    using Arguments = StressArguments;
    refused("--interval", [](Arguments& a) { a.interval_us = 99.0; });
    refused("--interval", [](Arguments& a) { a.interval_us = 1e7; });
    refused("--interval", [](Arguments& a) { a.interval_us = std::nan(""); });
    refused("--mode", [](Arguments& a) { a.mode = "type3"; });
    refused("--stages", [](Arguments& a) { a.stages = "all"; });
    refused("--load", [](Arguments& a) { a.load = "gpu"; });
    refused("--break", [](Arguments& a) { a.break_us = 0.0; });
    refused("--histogram", [](Arguments& a) { a.histogram_us = 0; });
    refused("--floor", [](Arguments& a) { a.floor_s = -1.0; });
    refused("--radius", [](Arguments& a) { a.radius = "-3"; });
    refused("--priority", [](Arguments& a) { a.loop.priority = 98; });
    refused("--affinity", [](Arguments& a) { a.loop.affinity = "x"; });
    refused("--policy", [](Arguments& a) { a.loop.policy = "hurry"; });
    refused("--spin", [](Arguments& a) { a.loop.spin = "maybe"; });
    refused("--spin on", [](Arguments& a) {
      a.loop.spin = "on";
      a.loop.priority = 0;
    });
    refused("--policy sample", [](Arguments& a) {
      a.loop.policy = "sample";
      a.stages = "sleep,deform";
    });
  }

  TEST_CASE("the spin tail goes by itself at rates that leave it time") {
    for (const auto& [interval_us, spins] :
         {std::pair{1000.0, true}, {501.0, true}, {500.0, false}}) {
      StressArguments arguments;
      arguments.interval_us = interval_us;
      CHECK(parse(arguments)->run.loop.spin == spins);
      arguments.loop.spin = "off";
      CHECK_FALSE(parse(arguments)->run.loop.spin);
      arguments.loop.spin = "on";
      CHECK(parse(arguments)->run.loop.spin);
    }
  }

  TEST_CASE("load is made by processes that are gone when it is") {
    CHECK(parse_load("")->empty());
    CHECK(parse_load("cpu,mem,io")->size() == 3);
    for (const char* text : {"cpu,", ",", "cpu;mem", "CPU"})
      CHECK_FALSE(parse_load(text));
    std::vector<pid_t> workers;
    {
      const auto load = Load::start({"cpu", "mem", "io"});
      REQUIRE(load);
      workers = load->workers();
      CHECK(workers.size() >= 3);
      for (const pid_t worker : workers)
        CHECK(::kill(worker, 0) == 0);
    }
    for (const pid_t worker : workers) {
      CHECK(::waitpid(worker, nullptr, WNOHANG) == -1);
      CHECK(errno == ECHILD);
    }
  }
}

} // namespace stress_options_test
