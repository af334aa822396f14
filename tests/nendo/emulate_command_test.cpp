#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "support/program.hpp"
#include "support/pty_host.hpp"

namespace emulate_command_test {

using nendo::test::is_one_line_about;

TEST_SUITE("emulate") {
  TEST_CASE("the help explains every fault with the form that it is written in") {
    const auto help = nendo::test::nendo({"emulate", "--help"});
    CHECK(help.exit_code == 0);
    for (const char* word : {"drop=RATE%", "unplug@5s+2s[=LINK]", "swap@5s", "--pace", "--replay",
                             "--streaming", "cyberglove"}) {
      CAPTURE(word);
      CHECK(help.out.find(word) != std::string::npos);
    }
  }

  TEST_CASE("a monitor reads through noise, and Ctrl-C reports what was done") {
    const nendo::test::TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    nendo::test::Program emulator({"emulate", "--link", link.string(), "--rate", "100", "--fault",
                                   "lose=5%", "--fault", "junk@0s", "--streaming"});
    for (int turn = 0; turn < 2000 && !std::filesystem::exists(link); ++turn)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto monitor = nendo::test::nendo(
        {"monitor", "serial:" + link.string(), "--json", "--raw", "--count", "50"});
    CHECK_MESSAGE(monitor.exit_code == 0, monitor.err);
    CHECK(nendo::test::lines_of(monitor.out).size() == 50);
    emulator.signal(SIGINT);
    const auto done = emulator.wait();
    CHECK(done.exit_code == 0);
    CHECK(done.out.find("records sent") != std::string::npos);
    CHECK(done.out.find("faults: lose ") != std::string::npos);
    CHECK(done.out.find(" junk 1,") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(std::filesystem::symlink_status(link)));
  }

  TEST_CASE("a glove's variants are in the help, and each can be asked who it is") {
    const auto help = nendo::test::nendo({"emulate", "--help"});
    struct Case {
      std::string glove, option, name, driver, said;
    };
    for (const Case& c :
         {Case{"lucidgloves", "--firmware", "senseshift", "lucidgloves:%", "device_type"},
          Case{"lucidgloves", "--firmware", "streaming", "lucidgloves:%", "alpha"},
          Case{"lucidgloves", "--firmware", "waiting", "lucidgloves:%", "alpha"},
          Case{"lucidgloves", "--firmware", "legacy", "lucidgloves:%", "legacy"},
          Case{"5dt", "--firmware", "little-first", "5dt:%?left_first=little",
               "little finger first"},
          Case{"5dt", "--connection", "wireless", "5dt:%?baud=9600&hand=left", "wireless"},
          Case{"forte", "--connection", "usb", "forte:%", "usb"},
          Case{"forte", "--connection", "bluetooth", "forte:%?link=bluetooth", "bluetooth"}}) {
      CAPTURE(c.name);
      CHECK(help.out.find(c.glove + " " + c.option + " " + c.name) != std::string::npos);
      const nendo::test::TemporaryFolder folder;
      const auto link = folder.path() / "glove";
      nendo::test::Program emulator({"emulate", "--link", link.string(), "--glove", c.glove,
                                     c.option, c.name, "--hand", "left"});
      for (int turn = 0; turn < 2000 && !std::filesystem::exists(link); ++turn)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      std::string glove = c.driver;
      glove.replace(glove.find('%'), 1, link.string());
      const auto info = nendo::test::nendo({"info", glove});
      CHECK_MESSAGE(info.exit_code == 0, info.err);
      CHECK(info.out.find(c.said) != std::string::npos);
      emulator.signal(SIGINT);
      CHECK(emulator.wait().exit_code == 0);
    }
  }

  TEST_CASE("a variant that a glove does not have is refused with those that it has") {
    const nendo::test::TemporaryFolder folder;
    const std::string link = (folder.path() / "glove").string();
    struct Case {
      std::string glove, option, name, about;
    };
    for (const Case& c :
         {Case{"lucidgloves", "--firmware", "v9", "senseshift, streaming, waiting, legacy"},
          Case{"forte", "--connection", "radio", "usb, bluetooth"},
          Case{"forte", "--firmware", "waiting", "no choice"},
          Case{"5dt", "--connection", "bluetooth", "wired, wireless"},
          Case{"cyberglove", "--connection", "usb", "no choice"}}) {
      CAPTURE(c.glove);
      const auto done =
          nendo::test::nendo({"emulate", "--link", link, "--glove", c.glove, c.option, c.name});
      CHECK(done.exit_code == 2);
      CHECK(is_one_line_about(done.err, c.about));
    }
  }

  TEST_CASE("a tracker answers under its link, with the faults of its line") {
    const nendo::test::TemporaryFolder folder;
    const auto link = folder.path() / "tracker";
    nendo::test::Program emulator({"emulate", "fastrak", "--link", link.string(), "--stations",
                                   "1,3", "--motion", "cross", "--noise", "--fault", "flip=5%"});
    for (int turn = 0; turn < 2000 && !std::filesystem::exists(link); ++turn)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    {
      nendo::test::PtyHost host(link.string());
      host.send("C");
      CHECK(host.receive(60 * 47).size() >= 60 * 47);
    }
    emulator.signal(SIGINT);
    const auto done = emulator.wait();
    CHECK(done.exit_code == 0);
    CHECK(done.out.find("emulating a fastrak at " + link.string()) != std::string::npos);
    CHECK(done.out.find("faults: flip ") != std::string::npos);
  }

  TEST_CASE("options of gloves and of trackers are refused for the other") {
    const nendo::test::TemporaryFolder folder;
    const std::string link = (folder.path() / "device").string();
    using Arguments = std::vector<std::string>;
    struct Case {
      Arguments more;
      std::string about;
    };
    for (const Case& c : {Case{{"fastrak", "--rate", "90"}, "--rate"},
                          Case{{"fastrak", "--hand", "left"}, "--hand"},
                          Case{{"--glove", "fastrak", "--pattern"}, "--pattern"},
                          Case{{"--stations", "1"}, "--stations"},
                          Case{{"lucidgloves", "--baud", "9600"}, "--baud"},
                          Case{{"fastrak", "--glove", "forte"}, "--glove forte"},
                          Case{{"fastrak", "--stations", "1;2"}, "--stations 1;2"},
                          Case{{"fastrak", "--stations", "5"}, "stations"},
                          Case{{"fastrak", "--baud", "1"}, "baud"},
                          Case{{"fastrak", "--motion", "sculpt"}, "sculpt"},
                          Case{{"fastrak", "--motion", "poses"}, "cyberglove"},
                          Case{{"fastrak", "--firmware", "waiting"}, "--firmware"}}) {
      CAPTURE(c.about);
      Arguments arguments{"emulate", "--link", link};
      arguments.insert(arguments.end(), c.more.begin(), c.more.end());
      const auto done = nendo::test::nendo(arguments);
      CHECK(done.exit_code == 2);
      CHECK(is_one_line_about(done.err, c.about));
    }
  }

  TEST_CASE("wrong options get one line that names them, and their exit code") {
    const nendo::test::TemporaryFolder folder;
    const std::string link = (folder.path() / "glove").string();
    struct Case {
      std::string option;
      std::string value;
      int exit_code;
      std::string about;
    };
    for (const Case& c : {Case{"--glove", "mitten", 2, "mitten"},
                          Case{"--fault", "drop=1", 2, "drop=RATE%"},
                          Case{"--hand", "up", 2, "--hand up"},
                          Case{"--mask", "7g", 2, "--mask 7g"},
                          Case{"--mask", "0", 2, "--mask 0"},
                          Case{"--mask", "1ffffff", 2, "--mask"},
                          Case{"--sensors", "20", 2, "sensors 20"},
                          Case{"--pace", "fast", 2, "--pace"},
                          Case{"--model", "0", 2, "model 0"},
                          Case{"--rate", "nan", 2, "rate"},
                          Case{"--rate", "481", 2, "rate"},
                          Case{"--reply-bytes", "4", 2, "reply-bytes 4"},
                          Case{"--stamp-bit7", "maybe", 2, "--stamp-bit7"},
                          Case{"--hires-form", "nul", 2, "--hires-form"},
                          Case{"--restart-time", "61s", 2, "restart-time"},
                          Case{"--restart-time", "-1", 2, "restart-time"},
                          Case{"--motion", "fly", 2, "fly"},
                          Case{"--hold", "3s", 2, "--motion poses"},
                          Case{"--replay", "/no/such/file", 5, "/no/such/file"},
                          Case{"--log", "/no/such/folder/log", 1, "/no/such/folder/log"},
                          Case{"--duration", "-1", 2, "--duration"}}) {
      CAPTURE(c.option);
      CAPTURE(c.value);
      const auto done = nendo::test::nendo({"emulate", "--link", link, c.option, c.value});
      CAPTURE(done.err);
      CHECK(done.exit_code == c.exit_code);
      CHECK(is_one_line_about(done.err, c.about));
      CHECK(done.out.empty());
    }
    const auto hurried = nendo::test::nendo(
        {"emulate", "--link", link, "--motion", "poses", "--hold", "2s", "--duration", "1"});
    CHECK(hurried.exit_code == 2);
    CHECK(is_one_line_about(hurried.err, "--hold: use 3s"));
    const auto without = nendo::test::nendo({"emulate"});
    CHECK(without.exit_code == 2);
    CHECK(is_one_line_about(without.err, "--link"));
  }
}

} // namespace emulate_command_test
