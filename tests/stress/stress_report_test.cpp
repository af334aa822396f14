// The text and the JSON of a stress report say the same figures.

#include "stress/report.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/text_files.hpp"

namespace stress_report_test {

using namespace nendo;
using namespace nendo::stress;
using namespace std::chrono_literals;
using nlohmann::ordered_json;

namespace {

/// A thousand ticks, each later than the one before it; every hundredth is an incident.
void fill(StressOutcome& outcome) {
  constexpr HostTime first(1000s);
  for (unsigned tick = 0; tick < 1000; ++tick) {
    flow::TickRecord record;
    record.tick = tick;
    record.scheduled = first + tick * 1ms;
    record.woke = record.scheduled + tick * 100ns + (tick % 100 == 99 ? 1200us : 0us);
    record.drained_ns = 1000 + tick;
    record.posed_ns = 3000 + 2 * tick;
    record.solved_ns = 80'000 + 10 * tick;
    record.published_ns = 90'000 + 11 * tick;
    record.samples = 1;
    record.input = record.woke - 250us;
    outcome.tally.add(record, nullptr);
  }
  outcome.start = first;
  outcome.wall_start = std::chrono::system_clock::time_point(1'700'000'000s);
  outcome.elapsed_s = 1.0;
  outcome.vertices = 1234;
  outcome.floor.spun_s = 0.5;
  outcome.floor.stalled_s = 0.001;
  outcome.floor.gaps.record(7us);
}

std::string text_of(const StressOptions& options, const StressOutcome& outcome,
                    const ordered_json& earlier) {
  char* text = nullptr;
  std::size_t length = 0;
  std::FILE* out = ::open_memstream(&text, &length);
  print_stress(out, options, outcome, stress_json(options, outcome), earlier);
  std::fclose(out);
  std::string result(text, length);
  std::free(text);
  return result;
}

/// The numbers in the last line that begins with `name`, after `nth` others.
std::vector<double> row(const std::string& text, const std::string& name, int nth = 0) {
  for (const std::string& line : test::lines_of(text)) {
    if (!line.starts_with("  " + name + "  ") || nth-- > 0) continue;
    std::istringstream words(line.substr(28)); // where the columns begin
    std::vector<double> numbers;
    for (double number = 0.0; words >> number;)
      numbers.push_back(number);
    return numbers;
  }
  return {};
}

std::vector<double> numbers_in(const ordered_json& figures) {
  std::vector<double> numbers;
  for (const char* column : {"min", "p50", "p90", "p99", "p99_9", "p99_99", "max"})
    numbers.push_back(figures[column].get<double>());
  return numbers;
}

/// The text rounds to five digits at least.
void check_equal(const std::vector<double>& shown, const std::vector<double>& exact) {
  REQUIRE(shown.size() == exact.size());
  for (std::size_t k = 0; k < shown.size(); ++k)
    CHECK(std::abs(shown[k] - exact[k]) <= (exact[k] < 100.0 ? 0.00501 : 0.0501));
}

} // namespace

TEST_SUITE("stress report") {
  TEST_CASE("the first line says whether the rate was kept, how far not, why, and what to try") {
    StressOptions options;
    options.run.loop.rate_hz = 1000.0;
    StressOutcome outcome(options.run.loop);
    fill(outcome); // ten of the ticks are 1.2 ms late and more
    outcome.grants = {{"policy", "SCHED_FIFO 80", false, "Operation not permitted", "do this"}};
    const Verdict verdict = judge(options, outcome);
    CHECK_FALSE(verdict.punctual);
    CHECK(verdict.late == 10);
    CHECK(verdict.due >= 1000);
    CHECK(verdict.max_late_us > 1200.0);
    CHECK(verdict.reason.find("SCHED_FIFO 80 is refused") != std::string::npos);
    CHECK(verdict.remedy == "do this");
    const std::string line = test::lines_of(text_of(options, outcome, nullptr)).at(0);
    CAPTURE(line);
    CHECK(line.starts_with("1 kHz: no: 10 of 1,0"));
    CHECK(line.find("by up to 1.3 ms, because ") != std::string::npos);
    CHECK(line.ends_with("; try: do this."));
    const ordered_json report = stress_json(options, outcome)["verdict"];
    CHECK(report["text"] == line);
    CHECK(report["punctual"] == false);
    CHECK(report["late_ticks"] == 10);
    CHECK(report["reason"] == verdict.reason);
    CHECK(report["remedy"] == verdict.remedy);
  }

  TEST_CASE("a remedy is one for this machine: no right that is there, no second CPU that is not") {
    StressOptions options;
    options.run.loop.rate_hz = 1000.0;
    options.run.realtime.priority = 80;
    StressOutcome outcome(options.run.loop);
    fill(outcome);
    outcome.grants = {{"policy", "SCHED_FIFO 80", true, "", ""}};
    CHECK(judge(options, outcome).reason.find("refused") == std::string::npos);
    options.run.realtime.priority = 0;
    outcome.grants.clear();
    CHECK(judge(options, outcome).remedy == "-p 80");
    // The usual work of a tick, 90 us and more, is more than a rate of 12 kHz allows.
    options.run.loop.rate_hz = 12'000.0;
    outcome.environment.cpus = 1;
    const Verdict alone = judge(options, outcome);
    CHECK(alone.reason.find("the work of a tick takes") != std::string::npos);
    CHECK(alone.remedy.find("--threads") == std::string::npos);
    CHECK(alone.remedy.find(" (-i ") != std::string::npos);
    outcome.environment.cpus = 4;
    CHECK(judge(options, outcome).remedy.find(" --threads 2, ") != std::string::npos);
  }

  TEST_CASE("a remedy is no option that the others on the command line refuse") {
    StressOptions options;
    options.run.loop.rate_hz = 12'000.0;
    options.run.realtime.priority = 80;
    StressOutcome outcome(options.run.loop);
    fill(outcome);
    outcome.environment.cpus = 4;
    CHECK(judge(options, outcome).remedy.find(" --threads 2 -p 0, ") != std::string::npos);
    options.run.loop.rate_hz = 1000.0;
    options.run.realtime.priority = 0;
    options.run.loop.sculptor.deformer.evaluation.threads = 2;
    CHECK(judge(options, outcome).remedy == "-p 80 without --threads 2");
    StressArguments both; // with the usual priority, these two do not go together
    both.loop.threads = 2;
    const auto refused = parse(both);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("--priority 0") != std::string::npos);
  }

  TEST_CASE("a loop that kept its rate is reported as such, and one without a rate is not judged") {
    StressOptions options;
    options.run.loop.rate_hz = 90.0; // whose ticks have 11 ms
    StressOutcome outcome(options.run.loop);
    fill(outcome);
    const Verdict verdict = judge(options, outcome);
    CHECK(verdict.punctual);
    CHECK(verdict.reason.empty());
    CHECK(verdict.remedy.empty());
    CHECK(in_words(verdict, options, outcome).starts_with("90 Hz: yes, with each of 1,0"));
    options.run.loop.policy = flow::OverrunPolicy::sample;
    CHECK_FALSE(judge(options, outcome).judged);
    CHECK(stress_json(options, outcome)["verdict"]["punctual"].is_null());
    const StressOutcome nothing(options.run.loop);
    options.run.loop.policy = flow::OverrunPolicy::skip;
    CHECK_FALSE(judge(options, nothing).punctual);
    CHECK(in_words(judge(options, nothing), options, nothing).find("no tick ran") !=
          std::string::npos);
  }

  TEST_CASE("each figure of the text is that of the JSON, and an earlier report is beside it") {
    StressOptions options;
    options.run.loop.rate_hz = 1000.0;
    options.load = {"cpu", "mem"};
    StressOutcome outcome(options.run.loop);
    fill(outcome);
    const ordered_json report = stress_json(options, outcome);
    const std::string text = text_of(options, outcome, report);
    CAPTURE(text);

    const std::vector<std::string> measures{"lateness", "period error", "work", "input age",
                                            "end to end"};
    for (std::size_t k = 0; k < measures.size(); ++k) {
      const std::string key = std::string(measure_names[k]) + "_us";
      check_equal(row(text, measures[k]), numbers_in(report[key]));
      const int nth = static_cast<int>(k);
      check_equal(row(text, "  per scheduled tick", nth), numbers_in(report["corrected"][key]));
      check_equal(row(text, "    earlier", 2 * nth), numbers_in(report[key]));
    }
    for (const auto& [stage, figures] : report["stages_us"].items())
      check_equal(row(text, "  " + stage), numbers_in(figures));
    check_equal(row(text, "the machine's own gaps"), numbers_in(report["floor"]["gaps_us"]));

    for (const auto& worst : report["worst"]) {
      const auto time = worst["time"].get<std::string>();
      CHECK(text.find("  " + time + " ") != std::string::npos);
    }
    CHECK(text.find("1000 ticks, 0 overruns") != std::string::npos);
    const auto& causes = report["incidents"]["by_cause"];
    CHECK(causes["unexplained"]["incidents"] == 10);
    CHECK(text.find("later than 1 ms: 10 unexplained; 0.0 % of") != std::string::npos);
    CHECK(report["environment"]["stages"].size() == 5);
    CHECK(text.find("sleep, input, hands, deform, publish; 1234 vertices, type1; own load cpu, "
                    "mem\n") != std::string::npos);
  }

  TEST_CASE("the counts of the gloves' records are in both, by the same names") {
    StressOptions options;
    StressOutcome outcome(options.run.loop);
    outcome.gloves = {"serial:/dev/a", "sim"};
    outcome.glove_records = {{359, 98, 7, 12}, {90, 0, 0, 0}};
    const ordered_json report = stress_json(options, outcome);
    REQUIRE(report["gloves"].size() == 2);
    CHECK(report["gloves"][0] == ordered_json{{"source", "serial:/dev/a"},
                                              {"sent", 457},
                                              {"delivered", 359},
                                              {"missed", 98},
                                              {"refused", 7},
                                              {"bad_records", 12},
                                              {"clamped_values", 0}});
    CHECK(report["gloves"][1]["sent"] == 90);
    CHECK(report["missed"] == 0); // the loop's deadlines
    CHECK(text_of(options, outcome, nullptr)
              .find("serial:/dev/a: 457 sent, 359 delivered, 98 missed, 7 refused, 12 bad") !=
          std::string::npos);
  }

  TEST_CASE("what was never recorded is null in the JSON and has no line in the text") {
    StressOptions options;
    const StressOutcome outcome(options.run.loop);
    CHECK(stress_json(options, outcome)["lateness_us"].is_null());
    const std::string text = text_of(options, outcome, nullptr);
    CHECK(row(text, "lateness").empty());
    CHECK(text.find("earlier") == std::string::npos);
  }
}

} // namespace stress_report_test
