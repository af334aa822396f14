// What an observer asks of a loop that nendo stress measures: executed, or reported.

#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "stress/stress_session.hpp"
#include "support/test_meshes.hpp"

namespace stress_session_test {

using namespace nendo;

namespace {

/// Asks once for all of these, and at the next call for the end.
struct Asker final : session::Observer {
  explicit Asker(session::Asks wanted) : asks(std::move(wanted)) {}
  void update(const session::RunStatus&, session::Asks& asked) override {
    if (asks.empty()) asks.emplace_back(flow::EndRun{});
    std::swap(asked, asks);
    asks.clear();
  }
  void report(const session::Report& message) override { reports.push_back(message.text); }

  session::Asks asks;
  std::vector<std::string> reports;
};

/// Returns the reports to an observer that asks for these while the loop only sleeps.
std::vector<std::string> reports_of(session::Asks asks) {
  stress::StressArguments arguments;
  arguments.stages = "sleep"; // no tick takes commands, so that their ring fills
  arguments.floor_s = 0.0;
  arguments.loop.priority = 0;
  auto options = stress::parse(arguments);
  REQUIRE(options);
  Asker asker(std::move(asks));
  const auto outcome = stress::run_stress(
      *std::move(options), test::sphere(12, 24, 1.0), [](const stress::TickTally&, double) {},
      &asker);
  REQUIRE(outcome);
  CHECK((*outcome)->stopped);
  return asker.reports;
}

} // namespace

TEST_SUITE("stress_session") {
  TEST_CASE("commands that do not fit are named once") {
    const session::Asks asks(100, flow::Command(flow::Request::commit));
    const auto reports = reports_of(asks);
    CHECK(reports == std::vector<std::string>{"The loop is not responding; dropped: commit."});
  }

  TEST_CASE("commands that nendo stress does not execute are refused by name") {
    const auto reports = reports_of({flow::Command(flow::Subdivide{})});
    REQUIRE(reports.size() == 1);
    CHECK(reports[0].starts_with("subdivide: "));
  }
}

} // namespace stress_session_test
