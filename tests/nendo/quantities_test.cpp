// Durations and lengths, as every command reads them.

#include "cli/quantities.hpp"

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>

#include "cli/nearest_word.hpp"
#include "support/program.hpp"

namespace quantities_test {

using namespace nendo;
using nendo::test::is_one_line_about;

TEST_SUITE("quantities") {
  TEST_CASE("a mistyped word is nearest to the one that was meant, or to none") {
    const std::vector<std::string> known{"--mode",        "--mesh", "--kernel",
                                         "--keep-volume", "--out",  "--time"};
    struct Row {
      const char *text, *meant;
    };
    for (const Row& row :
         {Row{"--modee", "--mode"}, Row{"--mdoe", "--mode"}, Row{"--Mode", "--mode"},
          Row{"--keep-volumne", "--keep-volume"}, Row{"--kern", "--kernel"},
          Row{"--keep", "--keep-volume"}, Row{"--ot", "--out"}, Row{"--tango", ""},
          Row{"--size", ""}, Row{"", ""}}) {
      CAPTURE(row.text);
      CHECK(cli::nearest_word(row.text, known) == row.meant);
    }
    CHECK(cli::nearest_word(std::string(1 << 20, '-'), known).empty());
    CHECK(cli::nearest_word("--mode", {}).empty());
  }

  TEST_CASE("a duration is its number times its unit, and a bare number is seconds") {
    struct Row {
      const char* text;
      double seconds;
    };
    for (const Row& row : {Row{"90", 90.0}, Row{"90s", 90.0}, Row{"500ms", 0.5}, Row{"10m", 600.0},
                           Row{"2h", 7200.0}, Row{"1d", 86'400.0}, Row{"0.5s", 0.5}, Row{"0", 0.0},
                           Row{"-1.5s", -1.5}, Row{"1e2ms", 0.1}}) {
      CAPTURE(row.text);
      REQUIRE(cli::seconds_of(row.text));
      CHECK(*cli::seconds_of(row.text) == doctest::Approx(row.seconds).epsilon(1e-15));
    }
    for (const char* none : {"", "s", "3x", "3 s", "3ss", "3s ", "+3", "nan", "inf", "infs",
                             "0x1p3", "1e400", "1e308d", "3,5"}) {
      CAPTURE(none);
      CHECK_FALSE(cli::seconds_of(none));
    }
  }

  TEST_CASE("a length has a unit, and metres, centimetres and millimetres agree") {
    for (const char* text : {"250mm", "25cm", "0.25m", "2.5e1cm"}) {
      CAPTURE(text);
      REQUIRE(to_metres(text));
      CHECK(*to_metres(text) == doctest::Approx(0.25).epsilon(1e-15));
    }
    for (const char* none : {"", "250", "mm", "3 mm", "3km", "3mmm", "nanm", "infmm", "1e308x"}) {
      CAPTURE(none);
      CHECK_FALSE(to_metres(none));
    }
    CHECK(cli::number_of("-2.5e-1") == -0.25);
    for (const char* none : {"", "1mm", "1s", "nan", "inf", "1 "})
      CHECK_FALSE(cli::number_of(none));
  }

  TEST_CASE("rates and short times have a unit or not, in all commands the same") {
    for (const char* text : {"90", "90Hz", "0.09kHz", "9e1"})
      CHECK(*cli::hertz_of(text) == doctest::Approx(90.0));
    for (const char* text : {"250", "250us", "0.25ms", "0.00025s"})
      CHECK(*cli::microseconds_of(text) == doctest::Approx(250.0));
    for (const char* none : {"", "Hz", "90 Hz", "90hz", "nan", "90rpm"})
      CHECK_FALSE(cli::hertz_of(none));
    for (const char* none : {"", "us", "1 ms", "1m", "inf"})
      CHECK_FALSE(cli::microseconds_of(none));
  }

  TEST_CASE("a duration of 0 has no end, and what must end refuses it") {
    CHECK(cli::check_duration(0.0));
    CHECK(cli::check_duration(1e7));
    CHECK_FALSE(cli::check_duration(0.0, cli::End::needed));
    CHECK(cli::check_duration(0.5, cli::End::needed));
    for (const double wrong : {-1.0, 2e7, std::nan("")})
      for (const cli::End end : {cli::End::needed, cli::End::may_be_missing}) {
        const auto refused = cli::check_duration(wrong, end);
        REQUIRE_FALSE(refused);
        CHECK(refused.error().message.starts_with("--duration"));
      }
  }

  TEST_CASE("a time to run for is above 0 and not longer than a recording may be") {
    CHECK(cli::parse_duration("115d"));
    for (const char* none : {"0", "-1", "116d", "never"}) {
      const auto parsed = cli::parse_duration(none, "--keep-last");
      REQUIRE_FALSE(parsed);
      CHECK(parsed.error().code == Errc::usage);
      CHECK(parsed.error().message.starts_with("--keep-last " + std::string(none)));
    }
  }

  TEST_CASE("of two times the second is later, and each may be left out where that is allowed") {
    const auto span = [](const char* text) {
      return cli::parse_time_span(text, "--wire", cli::SpanEnds::may_be_open);
    };
    REQUIRE(span("0.8s:2.5s"));
    CHECK(span("0.8s:2.5s")->from_s == 0.8);
    CHECK(span("0.8s:2.5s")->to_s == 2.5);
    CHECK(span("500ms:1m")->from_s == 0.5);
    CHECK(span("500ms:1m")->to_s == 60.0);
    CHECK(span(":5s")->from_s == 0.0);
    CHECK(std::isinf(span("2s:")->to_s));
    for (const char* wrong :
         {"", "2s", "x:3s", "1s:y", "-1s:2s", "1s:2s:3s", "nan:1s", "1s:1e9d"}) {
      CAPTURE(wrong);
      REQUIRE_FALSE(span(wrong));
      CHECK(span(wrong).error().message.find("use two times with a colon") != std::string::npos);
    }
    for (const char* turned : {"2s:1s", "1s:1s", "5s:0"})
      CHECK(span(turned).error().message ==
            "--wire " + std::string(turned) + ": ends before it begins");
    const auto whole = [](const char* text) {
      return cli::parse_time_span(text, "--wire", cli::SpanEnds::both);
    };
    CHECK(whole("0.8s:2.5s")->to_s == 2.5);
    for (const char* open : {"1s:", ":2s", ":"}) {
      CAPTURE(open);
      CHECK(span(open));
      CHECK(whole(open).error().message ==
            "--wire " + std::string(open) +
                ": use two times with a colon between, such as 0.8s:2.5s");
    }
  }

  TEST_CASE("every command that runs for a while takes a duration with its unit") {
    const test::TemporaryFolder folder;
    const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
    using Arguments = std::vector<std::string>;
    for (const Arguments& arguments :
         {Arguments{"run", "--right", "sim", "--out", path("a.obj"), "--record", path("a.nendo")},
          Arguments{"record", "sim", "--out", path("b.nendo")}, Arguments{"poses", "sim"},
          Arguments{"emulate", "--link", path("glove")},
          Arguments{"stress", "--floor", "0ms", "--json"},
          Arguments{"demo", "--out", path("c.obj"), "--picture", path("c.png")}}) {
      Arguments timed = arguments;
      timed.insert(timed.end(), {"--duration", "300ms"});
      CAPTURE(arguments.front());
      const auto done = test::nendo(timed);
      CAPTURE(done.err);
      CHECK(done.exit_code == 0);
      timed.back() = "3x";
      const auto refused = test::nendo(timed);
      CHECK(refused.exit_code == 2);
      CHECK(is_one_line_about(refused.err, "3x"));
      CHECK(refused.err.find("10m") != std::string::npos);
    }
    for (const Arguments& arguments :
         {Arguments{"replay", path("a.nendo"), "--no-clock", "--from", "1ms", "--to", "1m"},
          Arguments{"recording", "cut", path("a.nendo"), "--to", "60000ms", "--out",
                    path("d.nendo")},
          Arguments{"export", path("a.nendo"), "--from", "1ms", "--to", "1m", "--out",
                    path("e.csv")}}) {
      CAPTURE(arguments.front());
      const auto done = test::nendo(arguments);
      CAPTURE(done.err);
      CHECK(done.exit_code == 0);
    }
  }

  TEST_CASE("a hand's length is the same in millimetres, centimetres and metres") {
    const auto with = [](const std::string& length) {
      const auto done = test::nendo({"poses", "sim:rest", "--count", "1", "--hand-length", length});
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      // Where the knuckle is from the wrist, which no finger's motion reports.
      return nlohmann::json::parse(done.out)["joints"]["little_proximal"]["position_m"].dump();
    };
    const std::string bare = with("200");
    CHECK(with("200mm") == bare);
    CHECK(with("20cm") == bare);
    CHECK(with("0.2m") == bare);
    CHECK_FALSE(with("19cm") == bare);
    const auto refused = test::nendo({"poses", "sim", "--hand-length", "20in"});
    CHECK(refused.exit_code == 2);
    CHECK(is_one_line_about(refused.err, "--hand-length"));
  }
}

} // namespace quantities_test
