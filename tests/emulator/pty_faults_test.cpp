// The emulator with its faults, paces, captures and its log, at a terminal.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/emulator/emulator.hpp>

#include "support/eventually.hpp"
#include "support/pty_host.hpp"
#include "support/temporary_folder.hpp"

namespace pty_faults_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::emulator;

TEST_SUITE("pty_faults") {
  namespace {
  namespace fs = std::filesystem;

  std::uint64_t done(const EmulatorStats& stats, std::string_view name) {
    for (const FaultCount& fault : stats.faults) {
      if (fault.name == name) return fault.done;
    }
    return 0;
  }

  std::string contents(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  } // namespace

  TEST_CASE("at the host's pace nothing is refused, however slowly or fast the host reads") {
    EmulatorOptions options;
    options.pace = EmulatorPace::host;
    const test::ServedEmulator emulator(options);
    test::PtyHost host(emulator->tty_path());
    host.send("D\1S");
    constexpr std::size_t records = 20'000; // 222 s of the glove's time
    const auto start = HostClock::now();
    std::string stream = host.receive(20'000);
    std::this_thread::sleep_for(300ms); // everything is full by now
    stream += host.receive(2 + records * 29 - stream.size());
    REQUIRE(stream.size() >= 2 + records * 29);
    CHECK(to_seconds(HostClock::now() - start) < 100.0);
    std::uint32_t last = 0;
    for (std::size_t n = 0; n < records; ++n) {
      const auto* record = reinterpret_cast<const unsigned char*>(stream.data()) + 2 + 29 * n;
      REQUIRE(record[0] == 'S');
      REQUIRE(record[28] == 0);
      std::uint32_t ticks = 0;
      for (unsigned k = 0; k < 4; ++k) {
        if (((record[23] >> k) & 1) == 0) ticks |= std::uint32_t{record[24 + k]} << (8 * k);
      }
      if (n > 0) REQUIRE(ticks - last == 1280);
      last = ticks;
    }
    CHECK(emulator->stats().bytes_refused == 0);
    CHECK(test::eventually([&] { return emulator->stats().records_sent >= records; }));
  }

  TEST_CASE("an unplugged terminal hangs up, and another one comes under the other link") {
    const test::TemporaryFolder folder;
    EmulatorOptions options;
    options.link = folder.path() / "first";
    options.faults = {"unplug@300ms+200ms=" + (folder.path() / "second").string()};
    options.cyberglove.streaming = true;
    const test::ServedEmulator emulator(options);
    test::PtyHost before(options.link);
    before.receive_until([](const std::string&) { return false; });
    CHECK(before.gone());
    CHECK_FALSE(fs::exists(fs::symlink_status(options.link)));
    REQUIRE(test::eventually([&] { return fs::exists(folder.path() / "second"); }));
    test::PtyHost after(folder.path() / "second");
    CHECK(after.receive(48).size() >= 48); // the unit has continued all the time
    CHECK(done(emulator->stats(), "unplug") == 1);
  }

  TEST_CASE("the glove's own faults reach the host, at the device's time") {
    EmulatorOptions options;
    options.pace = EmulatorPace::host; // 60 s in a moment
    options.cyberglove.streaming = true;
    options.faults = {"eg@20s+10s", "restart@60s"};
    const test::ServedEmulator emulator(options);
    test::PtyHost host(emulator->tty_path());
    // 90 records per second until the restart ends the stream.
    const std::string stream = host.receive_until(
        [&](const std::string&) { return done(emulator->stats(), "restart") == 1; });
    const std::string all = stream + host.drain(300ms);
    std::size_t good = 0;
    std::size_t without_glove = 0;
    for (std::size_t begin = 0, end = all.find('\0'); end != std::string::npos;
         begin = end + 1, end = all.find('\0', begin)) {
      const bool eg = end - begin == 25 && all.substr(end - 2, 2) == "eg";
      (eg ? without_glove : good) += 1;
      REQUIRE((eg || end - begin == 23));
    }
    CHECK(without_glove == 900);
    CHECK(good >= 4499);
    CHECK(good <= 4501);
  }

  TEST_CASE("a modem probe's junk awaits the first host") {
    EmulatorOptions options;
    options.faults = {"junk@0s"};
    const test::ServedEmulator emulator(options);
    test::PtyHost host(emulator->tty_path());
    CHECK(host.receive(25).substr(0, 2) == "AT");
    CHECK(done(emulator->stats(), "junk") == 1);
  }

  TEST_CASE("records of a capture are sent for a motion's") {
    const test::TemporaryFolder folder;
    EmulatorOptions options;
    options.cyberglove.replay = folder.path() / "capture";
    std::ofstream(options.cyberglove.replay) << std::string("cut\0S123\0?S\x16\0Sabc\0", 18);
    const test::ServedEmulator emulator(options);
    test::PtyHost host(emulator->tty_path());
    host.send("S");
    CHECK(host.receive(15).substr(0, 15) == std::string("S123\0Sabc\0S123\0", 15));
  }

  TEST_CASE("the log has a line for all that is received, sent and done") {
    const test::TemporaryFolder folder;
    EmulatorOptions options;
    options.log = folder.path() / "log";
    options.faults = {"press@1ms+1ms"}; // one that leaves the answers alone
    {
      const test::ServedEmulator emulator(options);
      test::PtyHost host(emulator->tty_path());
      host.send("?S");
      CHECK(host.receive(4).size() == 4);
      CHECK(test::eventually([&] { return done(emulator->stats(), "press") == 1; }));
    }
    const std::string log = contents(options.log);
    CHECK(log.find(" < 3f 53 |?S|\n") != std::string::npos);
    CHECK(log.find(" > reply 3f 53 16 00 |?S..|\n") != std::string::npos);
    CHECK(log.find(" ! press\n") != std::string::npos);
  }

  TEST_CASE("wrong faults, files and gloves are refused in one line that names them") {
    const auto error = [](const EmulatorOptions& options) {
      const auto emulator = DeviceEmulator::open(options);
      REQUIRE_FALSE(emulator);
      return emulator.error();
    };
    EmulatorOptions options;
    options.device = "mitten";
    CHECK(error(options).message.find("mitten") != std::string::npos);
    options = {};
    options.faults = {"unplug@1s+1s"};
    CHECK(error(options).message.find("link") != std::string::npos);
    options = {};
    options.log = "/no/such/folder/log";
    CHECK(error(options).code == Errc::failed);
    CHECK(error(options).message.find("/no/such/folder/log") != std::string::npos);
    options = {};
    options.device = "fastrak";
    for (const std::string fault : {"swap@1s=18", "stick@1s=5"}) {
      options.faults = {fault};
      CHECK(error(options).message.find("fastrak has none") != std::string::npos);
    }
    options.faults = {};
    options.motion = "sculpt";
    CHECK(error(options).message.find("orbit") != std::string::npos);
    options = {};
    options.device = "fastrak";
    options.tracker.stations = {5};
    CHECK(error(options).message.find("1 to 4") != std::string::npos);
    options.tracker = {};
    options.tracker.baud = 12345;
    CHECK(error(options).message.find("38400") != std::string::npos);
    options.tracker = {};
    options.tracker.restart_s = 61.0;
    CHECK(error(options).message.find("restart-time") != std::string::npos);
    options = {};
    options.faults = {"error@1s=k"};
    CHECK(error(options).message.find("cyberglove has none") != std::string::npos);
    options = {};
    options.cyberglove.replay = "/no/such/file";
    CHECK(error(options).code == Errc::bad_input);
    options = {};
    options.cyberglove.model = 4;
    CHECK(error(options).code == Errc::usage);
    options = {};
    options.sensors = 18;
    options.cyberglove.hardware_mask = 0x7FFF7F;
    CHECK(error(options).message.find("22") != std::string::npos);
  }
}

} // namespace pty_faults_test
