#include <set>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/program.hpp"

namespace devices_command_test {

using nendo::test::is_one_line_about;

namespace {

const std::set<std::string> device_keys{
    "device",           "kind",        "stable_name", "glove",      "trackers",
    "description",      "reason",      "identified",  "access",     "may_open",
    "remedy",           "usb",         "holders",     "left_alone", "latency_timer_ms",
    "holders_complete", "node_missing"};

std::set<std::string> keys_of(const nlohmann::json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items())
    keys.insert(key);
  return keys;
}

/// Before the program is ready for it the signal kills it; then it gets more time.
nendo::test::Finished interrupted_watch(bool json) {
  constexpr int killed = 128 + SIGINT;
  nendo::test::Finished done;
  for (std::chrono::milliseconds time{50}; time < std::chrono::seconds(30); time *= 2) {
    std::vector<std::string> arguments{"devices", "--watch"};
    if (json) arguments.emplace_back("--json");
    nendo::test::Program watch(arguments);
    std::this_thread::sleep_for(time);
    watch.signal(SIGINT);
    done = watch.wait();
    if (done.exit_code != killed) break;
  }
  return done;
}

} // namespace

TEST_SUITE("devices") {
  TEST_CASE("devices lists what is there in lines of JSON, and asks nothing of anybody") {
    const auto done = nendo::test::nendo({"devices", "--json"});
    CHECK(done.exit_code == 0);
    CHECK(done.err.empty());
    for (const auto& line : nendo::test::lines_of(done.out)) {
      const auto device = nlohmann::json::parse(line);
      CHECK(keys_of(device) == device_keys);
      if (device["kind"] == "portless_adapter") continue; // which more than a permission fixes
      CHECK(device["may_open"].get<bool>() == device["remedy"].get<std::string>().empty());
    }
  }

  TEST_CASE("devices says something to people, whatever is plugged in") {
    const auto done = nendo::test::nendo({"devices"});
    CHECK(done.exit_code == 0);
    CHECK_FALSE(done.out.empty());
  }

  TEST_CASE("a watch lists what is there first, and ends clean on Ctrl-C") {
    const auto listed = nendo::test::lines_of(nendo::test::nendo({"devices", "--json"}).out);
    for (const bool json : {true, false}) {
      const auto done = interrupted_watch(json);
      CHECK(done.exit_code == 0);
      const auto lines = nendo::test::lines_of(done.out);
      REQUIRE(lines.size() == listed.size());
      for (std::size_t k = 0; json && k < lines.size(); ++k) {
        const auto event = nlohmann::json::parse(lines[k]);
        CHECK(event["event"] == "present");
        CHECK(event["unix_time_s"].is_number());
        CHECK(event["device"] == nlohmann::json::parse(listed[k])["device"]);
      }
    }
  }

  TEST_CASE("wrong words on the command line give exit code 2 and one line") {
    CHECK(nendo::test::nendo({}).exit_code == 2);
    const auto unknown = nendo::test::nendo({"dance"});
    CHECK(unknown.exit_code == 2);
    CHECK(is_one_line_about(unknown.err, "dance"));
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"runn", "--help"}, {"edit", "shwo", "--help"}}) {
      const auto help = nendo::test::nendo(arguments); // not the help of what stands before it
      CHECK(help.exit_code == 2);
      CHECK(help.out.empty());
      CHECK(is_one_line_about(help.err, "no command " + arguments[arguments.size() - 2]));
    }
    CHECK(nendo::test::nendo({"edit", "show", "--help"}).exit_code == 0);
    const auto option = nendo::test::nendo({"devices", "--jsom"});
    CHECK(option.exit_code == 2);
    CHECK(is_one_line_about(option.err, "no option --jsom; did you mean --json?"));
    const auto far = nendo::test::nendo({"devices", "--tango=1"});
    CHECK(far.exit_code == 2);
    CHECK(is_one_line_about(far.err, "no option --tango (see nendo devices --help)"));
  }

  TEST_CASE("help and version go to standard output") {
    for (const std::string command :
         {"run", "monitor", "info", "deform", "emulate", "devices", "doctor", "bench"}) {
      const auto help = nendo::test::nendo({command, "--help"});
      CHECK(help.exit_code == 0);
      CHECK(help.out.find("--help") != std::string::npos);
      CHECK(help.err.empty());
    }
    CHECK(nendo::test::nendo({"--version"}).out.starts_with("0."));
  }
}

} // namespace devices_command_test
