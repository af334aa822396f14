#include <nendo/driver/open_tracker.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <netinet/in.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <nendo/base/unique_fd.hpp>

#include "support/eventually.hpp"
#include "support/required.hpp"
#include "support/shell.hpp"
#include "transport/udp_transport.hpp"

namespace osc_driver_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::driver;
using nendo::test::eventually;
using nendo::test::required;

namespace {

/// A port that was free a moment ago.
std::string free_port() {
  const UniqueFd socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  REQUIRE(::bind(socket.get(), any, length) == 0);
  REQUIRE(::getsockname(socket.get(), any, &length) == 0);
  return std::to_string(ntohs(address.sin_port));
}

/// Runs the sender in Python to its end. Returns what it prints: the bytes that `hostile` sent.
std::uint64_t send(const std::string& port, const std::string& mode, int count) {
  const auto sent = test::shell("python3 " NENDO_OSC_SENDER " " + port + " " + mode + " " +
                                std::to_string(count));
  REQUIRE_MESSAGE(sent.exit_code == 0, sent.out);
  return std::stoull(sent.out);
}

Result<std::vector<TrackerStation>> open(const std::vector<std::string>& specs) {
  return open_trackers(specs);
}

/// Running trackers, with a ring for each station.
struct Running {
  std::vector<TrackerStation> stations;
  PoseRing left{4096};
  PoseRing right{4096};

  explicit Running(const std::vector<std::string>& specs) : stations(required(open(specs))) {
    const std::array rings{&left, &right};
    test::require_ok(start_trackers(stations, std::span(rings).first(stations.size())));
  }
  StreamStats stats() const { return stations.front().tracker->stats(); }
  void stop() const { stations.front().tracker->stop(); }
};

/// Checks that poses are those that osc_sender.py sends, in order, and returns their number.
int check_poses(PoseRing& ring, std::uint16_t station, bool has_time = false) {
  int next = 0;
  HostTime last{};
  ring.drain([&](const PoseSample& sample) {
    CAPTURE(next);
    CHECK(sample.station == station);
    CHECK(std::abs(sample.position_m[0] - next / 1000.0) < 1e-6);
    CHECK(std::abs(sample.position_m[1] - 0.25) < 1e-6);
    CHECK(std::abs(sample.position_m[2] + 0.5) < 1e-6);
    CHECK(std::abs(sample.turn_xyzw[1] - std::sin(next / 200.0)) < 1e-6);
    CHECK(std::abs(sample.turn_xyzw[3] - std::cos(next / 200.0)) < 1e-6);
    CHECK(sample.has_device_time == has_time);
    CHECK(sample.measured <= sample.arrival);
    CHECK(sample.measured >= last);
    CHECK(sample.arrival - sample.measured < (has_time ? 5s : 1ns));
    last = sample.measured;
    ++next;
  });
  return next;
}

void check_bytes(const StreamStats& stats) {
  CHECK(stats.bytes == stats.record_bytes + stats.discarded_bytes);
}

/// Keeps the lines of log while it lives.
class LogLines final : public spdlog::sinks::base_sink<std::mutex> {
public:
  std::size_t count(std::string_view words) {
    const std::lock_guard lock(mutex_);
    std::size_t found = 0;
    for (const std::string& line : lines_)
      if (line.find(words) != std::string::npos) ++found;
    return found;
  }

private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    lines_.emplace_back(message.payload.data(), message.payload.size());
  }
  void flush_() override {}

  std::vector<std::string> lines_;
};

} // namespace

TEST_SUITE("osc_driver") {
  TEST_CASE("both hands share one port, and their poses arrive in order") {
    for (const std::string mode : {"whole", "bundled"}) {
      CAPTURE(mode);
      const std::string port = free_port();
      Running running({"osc:" + port + "/left", "osc:127.0.0.1:" + port + "/right"});
      CHECK(running.stations[0].tracker == running.stations[1].tracker);
      const TrackerInfo& info = running.stations[0].tracker->info();
      CHECK(info.model == "OSC at 127.0.0.1:" + port);
      CHECK(info.stations == std::vector<std::uint16_t>{1, 2});
      CHECK(info.stage_from_tracker_xyzw == std::array<double, 4>{0, 0, 0, 1});
      send(port, mode, 100);
      CHECK(eventually([&] { return running.right.size() == 100; }));
      running.stop();
      CHECK(check_poses(running.left, 1) == 100);
      CHECK(check_poses(running.right, 2) == 100);
      CHECK(running.stats().records == 200);
      CHECK(running.stats().bad_records == 0);
      check_bytes(running.stats());
    }
  }

  TEST_CASE("two messages of a phone are one pose, however they are sent") {
    for (const std::string mode : {"phone", "phone-bundle"}) {
      CAPTURE(mode);
      const std::string port = free_port();
      Running running(
          {"osc:" + port +
           "/right?position=/0A1B-2C3D/arkitposition&rotation=/0A1B-2C3D/arkitrotation"});
      send(port, mode, 50);
      // On a busy machine the second message may be late.
      const auto arrived = [&] { return running.left.size() + running.stats().bad_records >= 50; };
      CHECK(eventually(arrived));
      running.stop();
      CHECK(running.left.size() >= 25);
      if (running.stats().bad_records == 0)
        CHECK(check_poses(running.left, 2, mode == "phone-bundle") == 50);
      check_bytes(running.stats());
    }
  }

  TEST_CASE("time tags of a sender with another clock are mapped to this machine's") {
    const std::string port = free_port();
    Running running({"osc:" + port + "/left"});
    send(port, "tagged", 100);
    CHECK(eventually([&] { return running.left.size() == 100; }));
    running.stop();
    CHECK(check_poses(running.left, 1, true) == 100);
  }

  TEST_CASE("hostile datagrams move nothing, and each byte is accounted for") {
    LogLines lines;
    const auto sink = std::shared_ptr<LogLines>(&lines, [](LogLines*) {});
    spdlog::default_logger()->sinks().push_back(sink);
    const std::string port = free_port();
    Running running({"osc:" + port + "/left"});
    const std::uint64_t sent = send(port, "hostile", 60);
    CHECK(eventually([&] { return running.left.size() == 60; }));
    running.stop();
    spdlog::default_logger()->sinks().pop_back();
    CHECK(check_poses(running.left, 1) == 60);
    const StreamStats stats = running.stats();
    CHECK(stats.bad_records >= 60 * 14);
    CHECK(stats.bytes <= sent); // of those that are too long, the end is not read
    CHECK(stats.bytes > sent / 2);
    check_bytes(stats);
    CHECK(lines.count("device:") <= 2); // if the sender was slow to begin
  }

  TEST_CASE("a sender may begin late and pause, which is one line of log each time") {
    LogLines lines;
    const auto sink = std::shared_ptr<LogLines>(&lines, [](LogLines*) {});
    spdlog::default_logger()->sinks().push_back(sink);
    const std::string port = free_port();
    Running running({"osc:" + port + "/left"});
    std::this_thread::sleep_for(4s); // more than two silences
    CHECK(running.stats().silences == 1);
    CHECK(lines.count("no good record") == 1);
    send(port, "phone", 120); // addresses that it does not know
    CHECK(eventually([&] { return lines.count("/0A1B-2C3D/arkitrotation") == 1; }));
    send(port, "whole", 10);
    CHECK(eventually([&] { return running.left.size() == 10; }));
    CHECK(lines.count("streams again") == 1);
    CHECK(lines.count("device:") == 3);
    const auto start = HostClock::now();
    running.stop();
    CHECK(HostClock::now() - start < 1s);
    spdlog::default_logger()->sinks().pop_back();
    check_poses(running.left, 1);
  }

  TEST_CASE("what waited before the start is old, and a tracker starts again") {
    const std::string port = free_port();
    const auto stations = required(open({"osc:" + port + "/left"}));
    PoseRing ring(64);
    const std::array rings{&ring};
    for (int round = 0; round < 2; ++round) {
      send(port, "whole", 5);
      test::require_ok(start_trackers(stations, rings));
      std::this_thread::sleep_for(200ms);
      CHECK(ring.size() == 0);
      send(port, "whole", 5);
      CHECK(eventually([&] { return ring.size() == 5; }));
      stations.front().tracker->stop();
      CHECK(check_poses(ring, 1) == 5);
      CHECK(stations.front().tracker->stats().records == 10); // both hands'
    }
  }

  TEST_CASE("a flood is read at a limited rate") {
    const std::string port = free_port();
    const auto transport =
        required(open_udp({"127.0.0.1", static_cast<std::uint16_t>(std::stoi(port))}));
    CHECK(test::shell("python3 -c 'import socket; s = socket.socket(2, 2)\n"
                      "for _ in range(200): s.sendto(bytes(8), (\"127.0.0.1\", " +
                      port + "))'")
              .exit_code == 0);
    std::array<std::byte, 64> buffer{};
    const auto start = HostClock::now();
    int count = 0;
    while (transport->read_some(buffer, 50ms).count == 8)
      ++count;
    CHECK(count == 200);
    CHECK(HostClock::now() - start > 50ms); // at 3200 per second
  }

  TEST_CASE("wrong specifications are usage errors that say how to write them") {
    struct Case {
      const char* spec;
      const char* said;
    };
    for (const Case& wrong : {
             Case{"osc:9000", "osc:9000/left"},
             Case{"osc", "osc:9000/left"},
             Case{"osc:9000/up", "osc:9000/left"},
             Case{"osc:/left", "PORT"},
             Case{"osc:0/left", "PORT"},
             Case{"osc:65536/left", "PORT"},
             Case{"osc:localhost:9000/left", "numeric address"},
             Case{"osc:::1:9000/left", "numeric address"},
             Case{"osc:[127.0.0.1]:9000/left", "numeric address"},
             Case{"osc:9000/left?listen=here", "numeric address"},
             Case{"osc:1.2.3.4:9000/left?listen=0.0.0.0", "two addresses"},
             Case{"osc:9000/left?station=1", "position, rotation"},
             Case{"osc:9000/left?position=/a", "both position= and rotation="},
             Case{"osc:9000/left?position=a&rotation=/b", "'a'"},
             Case{"osc:9000/left?position=/a*&rotation=/b", "'/a*'"},
             Case{"osc:9000/left?position=/a&rotation=/a", "different"},
             Case{"osc:9000/left?position=/nendo/wrist/left&rotation=/a", "whole poses"},
         }) {
      CAPTURE(wrong.spec);
      const auto opened = open({wrong.spec});
      REQUIRE_FALSE(opened);
      CAPTURE(opened.error().message);
      CHECK(opened.error().code == Errc::usage);
      CHECK(opened.error().message.find(wrong.said) != std::string::npos);
    }
    const std::string pair = "?position=/a&rotation=/b";
    const auto both = open({"osc:9000/left" + pair, "osc:9000/right" + pair});
    CHECK(both.error().message.find("one hand") != std::string::npos);
  }

  TEST_CASE("a port that is taken, and another machine's address, are errors with a remedy") {
    const std::string port = free_port();
    const auto first = required(open({"osc:" + port + "/left"}));
    const auto second = open({"osc:127.0.0.1:" + port + "/left"});
    CHECK(second.error().code == Errc::no_device);
    CHECK(second.error().message.find("another port") != std::string::npos);
    const auto away = open({"osc:192.0.2.1:" + port + "/left"});
    CHECK(away.error().code == Errc::no_device);
    CHECK(away.error().message.find("ip address") != std::string::npos);
  }

  TEST_CASE("the address to listen at has two spellings") {
    const std::string port = free_port();
    const auto both =
        required(open({"osc:0.0.0.0:" + port + "/left", "osc:" + port + "/right?listen=0.0.0.0"}));
    CHECK(both[0].tracker == both[1].tracker);
    CHECK(both[0].tracker->info().model == "OSC at 0.0.0.0:" + port);
  }
}

} // namespace osc_driver_test
