// The emulator's terminal: hosts that come, go, and do not read; its link.

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/emulator/emulator.hpp>

#include "support/eventually.hpp"
#include "support/pty_host.hpp"
#include "support/temporary_folder.hpp"

namespace pty_emulator_test {

using namespace std::chrono_literals;
using nendo::Errc;
using nendo::emulator::DeviceEmulator;
using nendo::emulator::EmulatorOptions;
using nendo::test::eventually;
using nendo::test::PtyHost;
using nendo::test::ServedEmulator;
using nendo::test::TemporaryFolder;

TEST_SUITE("pty_emulator") {
  namespace {
  namespace fs = std::filesystem;

  const std::string sensors_reply("?S\x16\0", 4);
  } // namespace

  TEST_CASE("a host asks, streams a hundred records, goes, and comes back") {
    const TemporaryFolder folder;
    EmulatorOptions options;
    options.link = folder.path() / "glove";
    options.rate_hz = 400;
    const ServedEmulator emulator(options);
    CHECK(fs::read_symlink(options.link) == emulator->tty_path());
    {
      PtyHost host(options.link);
      host.send("?S");
      CHECK(host.receive(4) == sensors_reply);
      host.send("S");
      constexpr std::size_t hundred_records = 2400;
      const std::string stream = host.receive(hundred_records);
      REQUIRE(stream.size() >= hundred_records);
      for (std::size_t n = 0; n < 100; ++n) {
        REQUIRE(stream[24 * n] == 'S');
        REQUIRE(stream.find('\0', 24 * n) == 24 * n + 23);
      }
    } // gone without a word: the stream continues
    std::this_thread::sleep_for(100ms);
    for (int round = 0; round < 3; ++round) {
      PtyHost host(options.link);
      host.send("\x03");
      host.drain(500ms); // what is still in the line, on a busy machine, too
      host.send("?S");
      CHECK(host.receive(4) == sensors_reply);
    }
    CHECK(eventually([&] { return emulator->stats().bytes_received == 12; }));
    const auto stats = emulator->stats();
    CHECK(stats.records_sent >= 100);
    CHECK(stats.bytes_sent >= 2400 + 4 * 4);
    CHECK(stats.bytes_refused > 0);
  }

  TEST_CASE("without a host it neither spins nor ends") {
    const ServedEmulator emulator;
    {
      PtyHost(emulator->tty_path()).send("S");
    }
    const std::clock_t before = std::clock();
    std::this_thread::sleep_for(500ms);
    CHECK(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC < 0.25);
    PtyHost host(emulator->tty_path());
    CHECK(host.receive(24).size() >= 24);
  }

  TEST_CASE("a host that does not read costs records, and gets whole ones afterwards") {
    EmulatorOptions options;
    options.rate_hz = 480;
    const ServedEmulator emulator(options);
    PtyHost host(emulator->tty_path());
    host.send("U\1");
    CHECK(host.receive(2) == std::string("U\0", 2));
    host.send("s"); // text: nearly four times as many bytes
    CHECK(eventually([&] { return emulator->stats().bytes_refused > 0; }));
    const std::string stream = host.receive(40'000);
    std::size_t begin = 0;
    std::size_t records = 0;
    for (std::size_t end = stream.find('\0'); end != std::string::npos;
         end = stream.find('\0', begin)) {
      const std::string record = stream.substr(begin, end - begin);
      REQUIRE(record.substr(0, 2) == "s ");
      REQUIRE(std::count(record.begin(), record.end(), ' ') == 23);
      REQUIRE(record.substr(record.size() - 2) == "\r\n");
      begin = end + 1;
      ++records;
    }
    CHECK(records > 100);
  }

  TEST_CASE("what counts as sent arrives, also when the emulator is stopped") {
    EmulatorOptions options;
    options.pace = nendo::emulator::EmulatorPace::host; // as much as the terminal takes, and more
    options.cyberglove.streaming = true;
    ServedEmulator emulator(options);
    PtyHost host(emulator->tty_path());
    std::string stream = host.receive(24);
    std::thread stopper([&] { emulator.stop(); });
    std::this_thread::sleep_for(50ms); // everything is full by now
    stream += host.drain();
    stopper.join();
    stream += host.drain();
    CHECK(stream.size() == emulator->stats().bytes_sent);
    CHECK(stream.size() == 24 * emulator->stats().records_sent);
  }

  TEST_CASE("the link goes with the emulator, unless it was pointed elsewhere") {
    const TemporaryFolder folder;
    EmulatorOptions options;
    options.link = folder.path() / "glove";
    REQUIRE(DeviceEmulator::open(options));
    CHECK_FALSE(fs::is_symlink(fs::symlink_status(options.link)));

    {
      const auto emulator = DeviceEmulator::open(options);
      fs::remove(options.link);
      fs::create_symlink("/dev/null", options.link);
    }
    CHECK(fs::read_symlink(options.link) == "/dev/null");
  }

  TEST_CASE("an old link is replaced, dangling or not, and nothing is left beside it") {
    const TemporaryFolder folder;
    EmulatorOptions options;
    options.link = folder.path() / "glove";
    fs::create_symlink("/dev/nendo-was-here", options.link);
    const auto emulator = DeviceEmulator::open(options);
    REQUIRE(emulator);
    CHECK(fs::read_symlink(options.link) == (*emulator)->tty_path());
    CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
  }

  TEST_CASE("it never replaces a file or a folder") {
    const TemporaryFolder folder;
    EmulatorOptions options;
    options.link = folder.path() / "file";
    std::ofstream(options.link) << "precious";
    const auto over_file = DeviceEmulator::open(options);
    REQUIRE_FALSE(over_file);
    CHECK(over_file.error().code == Errc::failed);
    CHECK(over_file.error().message.find("not a link") != std::string::npos);
    CHECK(fs::file_size(options.link) == 8);

    options.link = folder.path();
    CHECK_FALSE(DeviceEmulator::open(options));
    options.link = folder.path() / "missing/glove";
    const auto nowhere = DeviceEmulator::open(options);
    REQUIRE_FALSE(nowhere);
    CHECK(nowhere.error().message.find("there is no folder") != std::string::npos);
  }

  TEST_CASE("wrong options are usage errors") {
    const auto code = [](const EmulatorOptions& options) {
      const auto emulator = DeviceEmulator::open(options);
      REQUIRE_FALSE(emulator);
      return emulator.error().code;
    };
    EmulatorOptions options;
    options.motion = "dance";
    CHECK(code(options) == Errc::usage);
    options = {};
    options.sensors = 20;
    CHECK(code(options) == Errc::usage);
    options = {};
    options.rate_hz = 0.5;
    CHECK(code(options) == Errc::usage);
    options.rate_hz = 481;
    CHECK(code(options) == Errc::usage);
  }
}

} // namespace pty_emulator_test
