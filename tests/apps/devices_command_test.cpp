#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/program.hpp"

using nendo::test::is_one_line_about;

TEST_SUITE("devices") {
  TEST_CASE("devices lists what is there in lines of JSON, and asks nothing of anybody") {
    const auto done = nendo::test::nendo({"devices", "--json"});
    CHECK(done.exit_code == 0);
    for (const auto& line : nendo::test::lines_of(done.out)) {
      const auto device = nlohmann::json::parse(line);
      CHECK(device["device"].is_string());
      CHECK(device["reason"].is_string());
      CHECK(device["may_open"].is_boolean());
    }
  }

  TEST_CASE("wrong words on the command line give exit code 2 and one line") {
    CHECK(nendo::test::nendo({}).exit_code == 2);
    const auto unknown = nendo::test::nendo({"dance"});
    CHECK(unknown.exit_code == 2);
    CHECK(is_one_line_about(unknown.err, "dance"));
    const auto option = nendo::test::nendo({"devices", "--jsom"});
    CHECK(option.exit_code == 2);
    CHECK(is_one_line_about(option.err, "--jsom"));
  }

  TEST_CASE("help and version go to standard output") {
    for (const std::string command : {"run", "monitor", "deform", "emulate", "devices"}) {
      const auto help = nendo::test::nendo({command, "--help"});
      CHECK(help.exit_code == 0);
      CHECK(help.out.find("--help") != std::string::npos);
      CHECK(help.err.empty());
    }
    CHECK(nendo::test::nendo({"--version"}).out.starts_with("0."));
  }
}
