#include <array>
#include <chrono>
#include <csignal>
#include <functional>
#include <set>
#include <string>

#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/driver/sample.hpp>

#include "support/program.hpp"
#include "support/terminal_program.hpp"

namespace monitor_command_test {

using nendo::test::EmulatedGlove;
using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nendo::test::TerminalProgram;
using nendo::test::VtScreen;
using nlohmann::json;

namespace {

std::set<std::string> names_in(nendo::SensorMask mask) {
  std::set<std::string> names;
  for (std::size_t slot = 0; slot < nendo::sensor_slots; ++slot) {
    const auto sensor = static_cast<nendo::Sensor>(slot);
    if (mask.has(sensor)) names.emplace(name_of(sensor));
  }
  return names;
}

std::set<std::string> keys_of(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items())
    keys.insert(key);
  return keys;
}

} // namespace

TEST_SUITE("monitor") {
  TEST_CASE(
      "monitor prints one JSON object a sample, with the names of the sensors that the glove has") {
    for (const auto& [sensors, mask] :
         {std::pair{"18", nendo::sensors_18}, std::pair{"22", nendo::sensors_22}}) {
      const nendo::test::TemporaryFolder folder;
      const auto link = folder.path() / "glove";
      const EmulatedGlove glove(link, "left", sensors);
      const auto done = nendo::test::nendo(
          {"monitor", "serial:" + link.string(), "--json", "--raw", "--count", "25"});
      CAPTURE(done.err);
      REQUIRE(done.exit_code == 0);
      const auto lines = lines_of(done.out);
      REQUIRE(lines.size() == 25);
      double last_time_s = 0.0;
      for (std::size_t n = 0; n < lines.size(); ++n) {
        const json line = json::parse(lines[n]);
        CHECK(keys_of(line["raw"]) == names_in(mask));
        CHECK(line["hand"] == "left");
        CHECK(line["sequence"] == n + json::parse(lines[0])["sequence"].get<std::size_t>());
        CHECK(line["time_s"].get<double>() >= last_time_s);
        CHECK(line["measured_s"].get<double>() <= line["time_s"].get<double>() + 0.05);
        CHECK(line.contains("switch"));
        last_time_s = line["time_s"];
        for (const auto& [name, count] : line["raw"].items()) {
          CHECK(count.get<int>() >= 1);
          CHECK(count.get<int>() <= 255);
        }
        CHECK_FALSE(line.contains("angle_rad"));
      }
    }
  }

  TEST_CASE("without --raw angles come along, and a pipe gets JSON without asking") {
    const auto done = nendo::test::nendo({"monitor", "sim:rest?seed=3", "--count", "2"});
    REQUIRE(done.exit_code == 0);
    const json line = json::parse(lines_of(done.out).at(1));
    CHECK(line["hand"] == "right");
    CHECK(line["angle_rad"]["index_mcp"].get<double>() > 0.2); // a relaxed finger is bent
    CHECK(line["angle_rad"]["index_mcp"].get<double>() < 0.8);
  }

  TEST_CASE("the first line of a glove reports which joints it measures, as nendo info does") {
    for (const std::string glove : {"sim?sensors=18", "sim?sensors=22"}) {
      const auto info = nendo::test::nendo({"info", glove, "--json"});
      const auto done = nendo::test::nendo({"monitor", glove, "--count", "3"});
      const auto lines = lines_of(done.out);
      REQUIRE(lines.size() == 3);
      CHECK(json::parse(lines[0])["angles"] == json::parse(info.out)["angles"]);
      CHECK(json::parse(lines[0])["angles"]["index_dip_flexion"] ==
            (glove.ends_with("18") ? "from_pip" : "measured"));
      for (const std::size_t later : {1U, 2U})
        CHECK_FALSE(json::parse(lines[later]).contains("angles"));
      const auto raw = nendo::test::nendo({"monitor", glove, "--count", "1", "--raw"});
      CHECK_FALSE(json::parse(raw.out).contains("angles"));
    }
  }

  TEST_CASE("--adapt begins as the default, and needs no calibration none for it") {
    const auto angles = [](const std::string& option) {
      const auto done =
          nendo::test::nendo({"monitor", "sim:rest?seed=3&rate=1", "--count", "1", option});
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      const json line = json::parse(done.out);
      const double counts = line["raw"]["index_mcp"].get<double>() - 60.0;
      CHECK(line["angle_rad"]["index_mcp"].get<double>() == doctest::Approx(0.0125 * counts));
    };
    angles("--adapt");
    angles("--json");
    for (const std::string command : {"monitor", "poses"}) {
      const auto done = nendo::test::nendo({command, "sim", "--adapt", "--calibration", "none"});
      CHECK(done.exit_code == 2);
      CHECK(is_one_line_about(done.err, "leave out one of the two"));
    }
  }

  TEST_CASE("in a terminal of 80 by 24 there is a line a sensor, and not a character too many") {
    const nendo::test::TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    const EmulatedGlove glove(link, "left", "22");
    TerminalProgram program({"monitor", "serial:" + link.string()}, 80, 24);
    // To the end of the last line: a picture may arrive in parts.
    REQUIRE(
        program.shows([](const VtScreen& s) { return s.line_of("wrist_yaw ").ends_with(" deg"); }));
    CHECK(program.is_raw());
    CHECK(program.screen().on_page());
    CHECK_FALSE(program.screen().cursor_shown());
    CHECK(program.screen().shows("left hand, uncalibrated"));
    REQUIRE(program.shows("q quit"));
    for (const auto& name : names_in(nendo::sensors_22)) {
      const std::string line = program.screen().line_of(name + " ");
      CAPTURE(name);
      REQUIRE(line.size() == 80);
      CHECK(line.find_first_of("[|") != std::string::npos);
      CHECK(line.find(" deg") != std::string::npos);
      CHECK(line.find("~") != std::string::npos); // no one has calibrated this emulator's hand
      CHECK(std::stoi(line.substr(22)) >= 1);
      CHECK(std::stoi(line.substr(22)) <= 255);
    }
    CHECK(program.screen().faults().empty());
    CHECK(program.press('q'));
    CHECK(program.wait() == 0);
    CHECK(program.is_restored());
    CHECK(program.screen().transcript().find("wrist_yaw") != std::string::npos); // it stays
    CHECK(program.screen().faults().empty());
  }

  TEST_CASE("the picture follows the window's size, and is drawn thirty times a second at most") {
    const auto start = std::chrono::steady_clock::now();
    TerminalProgram program({"monitor", "sim:wave"}, 80, 24);
    REQUIRE(program.shows("wrist_yaw"));
    program.resize(100, 30);
    REQUIRE(program.shows([](const VtScreen& s) {
      const auto line = s.line_of("wrist_yaw");
      return line.size() == 100 && line.ends_with(" deg");
    }));
    program.resize(80, 13);
    REQUIRE(program.shows([](const VtScreen& s) {
      return s.line_of("thumb_roll").find("ring_mcp") == 41; // two columns
    }));
    REQUIRE(program.shows("wrist_yaw"));
    program.resize(40, 10);
    REQUIRE(program.shows("and 15 more"));
    program.resize(1, 1);
    program.resize(20, 3);
    REQUIRE(program.shows("and 22 more: make t~"));
    CHECK(program.screen().faults().empty());
    program.press('q');
    CHECK(program.wait() == 0);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    CHECK(program.screen().pages() <= 30.0 * elapsed.count() + 1.0);
  }

  TEST_CASE("a bar shows how far the sensor has gone, until r is pressed") {
    const auto range_width = [](const VtScreen& screen) {
      const auto line = screen.line_of("index_pip ");
      const auto from = line.find('[');
      const auto to = line.find(']');
      if (line.find('|') != std::string::npos) return 0;
      return from == std::string::npos ? -1 : static_cast<int>(to - from);
    };
    TerminalProgram program({"monitor", "sim:wave?rate=30", "--raw"}, 80, 24);
    REQUIRE(program.shows([&](const VtScreen& s) { return range_width(s) > 12; }));
    CHECK_FALSE(program.screen().shows(" deg"));
    program.press('r');
    CHECK(program.shows(
        [&](const VtScreen& s) { return range_width(s) >= 0 && range_width(s) < 6; }));
    program.press('x'); // nothing
    program.press('l'); // it has no light
    CHECK(program.shows([&](const VtScreen& s) { return range_width(s) > 12; }));
    program.press('q');
    CHECK(program.wait() == 0);
  }

  TEST_CASE("however it ends, the terminal is as it was") {
    struct Case {
      const char* how;
      std::function<void(TerminalProgram&)> end;
    };
    for (const Case& c : {Case{"Ctrl-C", [](TerminalProgram& p) { p.press('\x03'); }},
                          Case{"SIGTERM", [](TerminalProgram& p) { p.signal(SIGTERM); }},
                          Case{"SIGHUP", [](TerminalProgram& p) { p.signal(SIGHUP); }},
                          Case{"q", [](TerminalProgram& p) { p.press('q'); }}}) {
      CAPTURE(c.how);
      TerminalProgram program({"monitor", "sim"}, 80, 24);
      REQUIRE(program.shows("wrist_yaw"));
      CHECK_FALSE(program.is_restored());
      c.end(program);
      CHECK(program.wait() == 0);
      CHECK(program.is_restored());
    }
    TerminalProgram counted({"monitor", "sim", "--count", "20"}, 80, 24);
    CHECK(counted.wait() == 0);
    CHECK(counted.is_restored());
    TerminalProgram failed({"monitor", "serial:/dev/no-such-port"}, 80, 24);
    CHECK(failed.wait() == 3);
    CHECK(failed.is_restored());
  }

  TEST_CASE("Ctrl-Z gives the terminal back, and fg brings the page and the keys again") {
    const std::string script =
        std::string(NENDO_PROGRAM) + " monitor sim; echo suspended-now; read x; fg; echo over-now";
    TerminalProgram shell({"-mc", script}, 80, 24, "xterm", "/bin/bash");
    REQUIRE(shell.shows("index_mcp"));
    CHECK(shell.is_raw());
    REQUIRE(shell.press('\x1a'));
    REQUIRE(shell.prints("suspended-now"));
    CHECK_FALSE(shell.screen().on_page());
    CHECK(shell.screen().cursor_shown());
    CHECK(shell.has_lines_and_echo());
    REQUIRE(shell.press('\n'));
    REQUIRE(shell.shows([](const VtScreen& screen) { return screen.on_page(); }));
    REQUIRE(shell.shows("index_mcp"));
    CHECK(shell.is_raw());
    REQUIRE(shell.press('q'));
    CHECK(shell.prints("over-now"));
    CHECK(shell.wait() == 0);
    CHECK(shell.is_restored());
  }

  TEST_CASE("a terminal that is dumb gets lines, and not one control code") {
    for (const std::string term : {"dumb", ""}) {
      TerminalProgram program({"monitor", "sim"}, 80, 24, term);
      REQUIRE(program.prints("delivered"));
      CHECK_FALSE(program.screen().on_page());
      CHECK(program.screen().cursor_shown());
      REQUIRE(program.press('q'));
      CHECK(program.wait() == 0);
      CHECK(program.screen().sequences() == 0);
      CHECK(program.screen().faults().empty());
      CHECK(program.is_restored());
    }
  }

  TEST_CASE("--json prints lines in a terminal too") {
    TerminalProgram program({"monitor", "sim", "--json", "--count", "3"}, 80, 24);
    CHECK(program.wait() == 0);
    const auto lines = lines_of(program.screen().transcript());
    REQUIRE(lines.size() == 3);
    CHECK(json::parse(lines[2])["raw"].size() == 22);
    CHECK(program.is_restored());
  }

  TEST_CASE(
      "a glove that is in use is reported as it was typed, with its port and the other program") {
    const nendo::test::TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    const EmulatedGlove glove(link, "left", "22");
    const std::string spec = "serial:" + link.string();
    TerminalProgram first({"monitor", spec}, 80, 24);
    REQUIRE(first.shows("wrist_yaw"));
    const auto second = nendo::test::nendo({"monitor", spec, "--count", "1"});
    CHECK(second.exit_code == 3);
    CHECK(is_one_line_about(second.err, "in use by another program, "));
    CHECK(second.err.find("(pid ") != std::string::npos);
    CHECK(second.err.find(link.string()) != std::string::npos);
    CHECK(second.err.find(spec) != std::string::npos);
    first.press('q');
    CHECK(first.wait() == 0);
  }

  TEST_CASE("what is no glove gets one clear line, the right exit code, and no long wait") {
    const nendo::test::TemporaryFolder folder;
    nendo::test::write_file(folder.path() / "file", "not a terminal");
    struct Case {
      std::string glove;
      int exit_code;
      std::string about;
    };
    for (const Case& c :
         {Case{"serial:/dev/no-such-port", 3, "/dev/no-such-port"},
          Case{"serial:" + (folder.path() / "file").string(), 3, "file"},
          Case{"serial:/dev/null", 3, "/dev/null"}, Case{"bogus:1", 2, "bogus"},
          Case{"/dev/ttyUSB0", 2, "serial:/dev/ttyUSB0"}, Case{"sim:moonwalk", 2, "moonwalk"},
          Case{"sim:touch", 2, "sim:sculpt"}, Case{"sim?rate=0", 2, "rate"}, Case{"", 2, ""}}) {
      const auto done = nendo::test::nendo({"monitor", c.glove, "--count", "1"});
      CAPTURE(c.glove);
      CAPTURE(done.err);
      CHECK(done.exit_code == c.exit_code);
      CHECK(is_one_line_about(done.err, c.about));
      CHECK(done.out.empty());
      CHECK(done.seconds < 5.0);
    }
  }

  TEST_CASE("Ctrl-C while a port is asked for its glove says so, and ends the command") {
    // A port at whose other end nobody answers.
    std::array<char, 64> name{};
    int far = -1;
    int near = -1;
    REQUIRE(::openpty(&far, &near, name.data(), nullptr, nullptr) == 0);
    const std::string port = "serial:" + std::string(name.data());
    for (const char* command : {"monitor", "info", "poses"}) {
      CAPTURE(command);
      nendo::test::Program program({command, port});
      // It has asked: the command's handler is there.
      pollfd asked{far, POLLIN, 0};
      REQUIRE(::poll(&asked, 1, 10'000) == 1);
      program.signal(SIGINT);
      const auto done = program.wait();
      CHECK(done.exit_code == 1);
      CHECK(is_one_line_about(done.err, "interrupted"));
      CHECK(done.err.find(name.data()) != std::string::npos);
      std::array<char, 256> bytes{};
      while (::poll(&asked, 1, 0) == 1 && ::read(far, bytes.data(), bytes.size()) > 0) {
      }
    }
    ::close(near);
    ::close(far);
  }
}

} // namespace monitor_command_test
