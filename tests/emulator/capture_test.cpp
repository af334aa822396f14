#include "units/capture.hpp"

#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/temporary_folder.hpp"

namespace capture_test {

using namespace nendo;
using namespace nendo::emulator;
using namespace std::string_view_literals;

TEST_SUITE("capture") {
  namespace {
  std::vector<std::string> cut(std::string_view bytes) {
    std::vector<std::string> strings;
    for (const auto& record : cut_records(std::as_bytes(std::span(bytes))))
      strings.emplace_back(record.begin(), record.end());
    return strings;
  }
  } // namespace

  TEST_CASE("records end at NUL, replies and what is cut off are left out") {
    CHECK(cut("").empty());
    CHECK(cut("Sabc").empty());
    const auto records = cut("tail of one\0?S\x16\0S\0Sabc\0\0\0sdef\r\n\0Gx\0Yyz\0Snever ends"sv);
    REQUIRE(records.size() == 4);
    CHECK(records[0] == "Sabc\0"sv);
    CHECK(records[1] == "sdef\r\n\0"sv);
    CHECK(records[2] == "Gx\0"sv);
    CHECK(records[3] == "Yyz\0"sv);
    CHECK(cut("S" + std::string(500, 'x') + std::string(1, '\0')).empty());
  }

  TEST_CASE("a file that cannot be used says so in one line, as bad input") {
    const test::TemporaryFolder folder;
    const auto empty = (folder.path() / "empty").string();
    std::ofstream{empty};
    const auto text = (folder.path() / "text").string();
    std::ofstream(text) << "Some words, but no record";
    for (const std::string& path : {empty, text, folder.path().string(), std::string("/none/here"),
                                    std::string("/dev/zero")}) {
      CAPTURE(path);
      const auto capture = read_capture(path);
      REQUIRE_FALSE(capture);
      CHECK(capture.error().code == Errc::bad_input);
      CHECK(capture.error().message.starts_with("replay " + path + ": "));
    }
  }
}

} // namespace capture_test
