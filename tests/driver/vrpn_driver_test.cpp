// The client of VRPN against a server that was written from the protocol's description alone.

#include <nendo/driver/open_tracker.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <nendo/base/unique_fd.hpp>

#include "support/eventually.hpp"
#include "support/required.hpp"
#include "support/vrpn_server.hpp"

namespace vrpn_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

constexpr std::uint64_t longest = 24 + 8 + 1024;

void check_conservation(const StreamStats& stats) {
  CHECK(stats.bytes >= stats.record_bytes + stats.discarded_bytes);
  CHECK(stats.bytes - stats.record_bytes - stats.discarded_bytes < longest);
  CHECK(stats.record_bytes == 88 * stats.records);
}

/// Opens trackers of a server that is there. On a busy machine it may answer later than the driver
/// waits.
std::vector<TrackerStation> opened(const std::vector<std::string>& specs) {
  auto stations = open_trackers(specs);
  for (int turn = 0; turn < 10 && !stations; ++turn)
    stations = open_trackers(specs);
  return required(std::move(stations));
}

/// Two sensors of a server's tracker that stream into rings.
class Run {
public:
  explicit Run(const std::string& server, std::size_t ring_size = 1U << 16U)
      : zero(ring_size), one(ring_size) {
    const std::string tracker = "vrpn:Tracker0@" + server;
    stations_ = opened({tracker + "?sensor=0", tracker + "?sensor=1"});
    start();
  }
  ~Run() { stop(); }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  void start() {
    const std::vector<PoseRing*> rings{&zero, &one};
    require_ok(start_trackers(stations_, rings));
  }
  void stop() { stations_[0].tracker->stop(); }
  const TrackerInfo& info() const { return stations_[0].tracker->info(); }
  StreamStats stats() const { return stations_[0].tracker->stats(); }
  bool delivers(std::uint64_t records) const {
    return eventually([&] { return stats().records >= records; });
  }
  bool delivers_more() const { return delivers(stats().records + 20); }

  PoseRing zero;
  PoseRing one;

private:
  std::vector<TrackerStation> stations_;
};

std::vector<PoseSample> all_in(PoseRing& ring) {
  std::vector<PoseSample> samples;
  ring.drain([&](const PoseSample& sample) { samples.push_back(sample); });
  return samples;
}

int number_of(const PoseSample& sample) {
  return static_cast<int>(std::lround(sample.position_m[0] * 1000.0));
}

/// Checks that poses are the server's, one after another, and came soon. `breaks` are the times
/// that the server may begin with another number.
void check_poses(const std::vector<PoseSample>& samples, std::uint16_t sensor, int breaks = 0) {
  REQUIRE_FALSE(samples.empty());
  int broken = 0;
  double delay_s = 0.0;
  for (std::size_t at = 0; at < samples.size(); ++at) {
    const PoseSample& sample = samples[at];
    CHECK(sample.station == sensor);
    CHECK(sample.position_m[0] < 90.0);
    CHECK(sample.position_m[1] == sensor);
    CHECK(sample.position_m[2] == -1.5);
    CHECK(sample.turn_xyzw == std::array{0.5, -0.5, 0.5, 0.5});
    CHECK(sample.has_device_time);
    CHECK(sample.measured <= sample.arrival);
    delay_s += to_seconds(sample.arrival - sample.measured) / static_cast<double>(samples.size());
    if (at == 0) continue;
    CHECK(sample.sequence > samples[at - 1].sequence);
    CHECK(sample.arrival >= samples[at - 1].arrival);
    CHECK(sample.measured >= samples[at - 1].measured);
    if (number_of(sample) != number_of(samples[at - 1]) + 1) ++broken;
  }
  CHECK(broken <= breaks);
  CHECK(delay_s < 1.0); // a stamp that was mapped wrongly is off by hours
}

/// Stops, and checks the poses of both sensors, as check_poses() does, and the counts.
StreamStats stop_and_check(Run& run, int breaks = 0) {
  run.stop();
  check_poses(all_in(run.zero), 0, breaks);
  check_poses(all_in(run.one), 1, breaks);
  check_conservation(run.stats());
  return run.stats();
}

/// Opens one sensor, which must fail with one line that begins with the specification.
void check_refused(const std::string& spec, Errc code, const std::vector<std::string>& said) {
  CAPTURE(spec);
  const auto begin = HostClock::now();
  const auto refused = open_trackers(std::vector<std::string>{spec});
  CHECK(HostClock::now() - begin < 5s);
  REQUIRE_FALSE(refused);
  const std::string message = refused.error().message;
  CAPTURE(message);
  CHECK(refused.error().code == code);
  CHECK(message.find(spec) <= 1); // in quotes, or not
  CHECK(message.find('\n') == std::string::npos);
  for (const std::string& words : said)
    CHECK_MESSAGE(message.find(words) != std::string::npos, words);
}

std::string fact_of(const TrackerInfo& info, std::string_view name) {
  const auto found = std::find_if(info.facts.begin(), info.facts.end(),
                                  [&](const DeviceFact& fact) { return fact.name == name; });
  return found == info.facts.end() ? "none" : found->value;
}

bool has_ipv6() {
  const UniqueFd fd(::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in6 address{};
  address.sin6_family = AF_INET6;
  address.sin6_addr = in6addr_loopback;
  return fd.is_open() &&
         ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

} // namespace

TEST_SUITE("vrpn_driver") {
  TEST_CASE("120 poses per second of two sensors arrive whole, in order and soon") {
    const VrpnServer server({"--offset", "5"});
    Run run(server.at());
    CHECK(eventually([&] { return std::abs(run.stats().rate_hz - 240.0) < 2.4; }));
    REQUIRE(run.delivers(480));
    run.stop();
    CHECK(run.stats().records == run.zero.size() + run.one.size());
    const StreamStats stats = stop_and_check(run);
    CHECK(stats.bad_records == 0);
    CHECK(stats.silences == 0);
    CHECK(stats.reopened == 0);
    CHECK(eventually([&] { return server.said("gone"); })); // no client that does not read
    CHECK(server.said("cookie b'vrpn: ver. 07.35  0\\x00\\x00\\x00\\x00\\x00'\nsender 0 Tracker0\n"
                      "type 0 vrpn_Base ping_message\nping of Tracker0"));
    for (const std::string wrong : {"bad", "unknown", "padding", "Error"})
      CHECK_FALSE_MESSAGE(server.said(wrong), server.log());
  }

  TEST_CASE("a tracker says what it is") {
    const VrpnServer server({"--version", "vrpn: ver. 07.30", "--tracker", "Left Hand"});
    const auto stations = opened({"vrpn:Left Hand@" + server.at() + "?sensor=1&up=z",
                                  "vrpn:Left Hand@" + server.at() + "?sensor=1"});
    REQUIRE(stations.size() == 2);
    CHECK(stations[0].tracker != stations[1].tracker); // other axes
    const TrackerInfo& info = stations[0].tracker->info();
    CHECK(info.source == "vrpn:Left Hand@" + server.at() + "?sensor=1&up=z");
    CHECK(info.model == "VRPN tracker Left Hand");
    CHECK(info.stations == std::vector<std::uint16_t>{1});
    CHECK(info.is_filtered);
    CHECK(info.kind == SourceKind::device);
    CHECK(fact_of(info, "server") == server.at());
    CHECK(fact_of(info, "protocol") == "vrpn: ver. 07.30");
    CHECK(fact_of(info, "names") == "Button0, Left Hand");
    CHECK(fact_of(info, "sensors_seen").find('1') != std::string::npos);
    CHECK(fact_of(info, "up") == "z");
    // z up becomes y up, and y to the front becomes -z: a turn by -90 degrees about x.
    const double half = std::sqrt(0.5);
    const std::array<double, 4> turn{-half, 0, 0, half};
    for (std::size_t k = 0; k < 4; ++k)
      CHECK(info.stage_from_tracker_xyzw[k] == doctest::Approx(turn[k]));
    CHECK(stations[1].tracker->info().stage_from_tracker_xyzw == std::array<double, 4>{0, 0, 0, 1});
  }

  TEST_CASE("messages that are cut anywhere make no difference") {
    const VrpnServer server({"--cut"});
    Run run(server.at());
    REQUIRE(run.delivers(200));
    CHECK(stop_and_check(run).bad_records == 0);
  }

  TEST_CASE("hostile names and messages between the poses cost none") {
    const VrpnServer server({"--noise"});
    Run run(server.at());
    REQUIRE(run.delivers(400));
    const StreamStats stats = stop_and_check(run);
    CHECK(stats.bad_records > 0);
    CHECK(stats.reopened == 0);
  }

  TEST_CASE("names and numbers that resemble the tracker's are not taken for it") {
    const VrpnServer server({"--clash"});
    Run run(server.at());
    REQUIRE(run.delivers(200));
    CHECK(stop_and_check(run).bad_records == 0);
  }

  TEST_CASE("after a message of a wrong length the server is connected again") {
    for (const std::string length : {"0", "23", "65537", "4294967295"}) {
      CAPTURE(length);
      const VrpnServer server({"--bad-length", length});
      Run run(server.at());
      REQUIRE(eventually([&] { return run.stats().reopened >= 2; }));
      CHECK(run.delivers_more());
      CHECK(stop_and_check(run, 99).bad_records >= 2);
    }
  }

  TEST_CASE("a server that restarts, with other numbers and an older clock, is back in 1.5 s") {
    auto server = std::make_unique<VrpnServer>(std::vector<std::string>{"--clash"});
    const std::string port = std::to_string(server->port());
    Run run("127.0.0.1:" + port);
    int shortest_ms = 1'000'000; // a busy machine may delay one
    for (int restart = 1; restart <= 3; ++restart) {
      CAPTURE(restart);
      REQUIRE(run.delivers_more());
      server.reset();
      std::this_thread::sleep_for(restart * 400ms);
      server = std::make_unique<VrpnServer>(
          std::vector<std::string>{"--port", port, "--offset", std::to_string(restart * 13),
                                   "--clock", std::to_string(restart * -3600)});
      REQUIRE(eventually([&] { return run.stats().reopened == std::uint64_t(restart); }));
      const std::string heard = "ping of Tracker0, ";
      REQUIRE(eventually([&] { return server->said(heard) && server->said(" ms after"); }));
      const std::string log = server->log();
      const int delay_ms = std::atoi(log.c_str() + log.find(heard) + heard.size());
      MESSAGE("connected " << delay_ms << " ms after the server listened");
      shortest_ms = std::min(shortest_ms, delay_ms);
    }
    CHECK(shortest_ms <= 1500);
    REQUIRE(run.delivers_more());
    CHECK(stop_and_check(run, 3).bad_records == 0);
  }

  TEST_CASE("a server that hangs is left, and found again") {
    const VrpnServer server;
    Run run(server.at());
    REQUIRE(run.delivers_more());
    server.signal(SIGSTOP);
    REQUIRE(eventually([&] { return run.stats().silences == 1; }));
    std::this_thread::sleep_for(3s); // the kernel accepts connections for it
    server.signal(SIGCONT);
    REQUIRE(eventually([&] { return run.stats().reopened == 1; }));
    CHECK(run.delivers_more());
    run.stop();
    check_conservation(run.stats());
  }

  TEST_CASE("a tracker that no camera sees stays connected") {
    const VrpnServer server({"--stop-after", "60"});
    Run run(server.at());
    REQUIRE(eventually([&] { return run.stats().silences == 1; }));
    std::this_thread::sleep_for(2s);
    run.stop();
    CHECK(run.stats().silences == 1); // counted once
    CHECK(run.stats().reopened == 0);
    const std::string log = server.log();
    CHECK(log.find("\nclient\n") == log.rfind("\nclient\n"));
  }

  TEST_CASE("either a pong or a pose shows that the tracker is there") {
    const VrpnServer without_pongs({"--no-pong"});
    Run run(without_pongs.at());
    CHECK(run.delivers(20));
    const VrpnServer without_poses({"--no-poses"});
    const auto quiet = opened({"vrpn:Tracker0@" + without_poses.at()});
    CHECK(fact_of(quiet[0].tracker->info(), "sensors_seen").empty());
    const VrpnServer others({"--sensors", "3,4"});
    const auto missing = opened({"vrpn:Tracker0@" + others.at()});
    CHECK(fact_of(missing[0].tracker->info(), "sensors_seen") == "3, 4");
  }

  TEST_CASE("a full ring refuses poses, which are counted") {
    const VrpnServer server;
    Run run(server.at(), 8);
    CHECK(eventually([&] { return run.stats().ring_refused > 5; }));
    run.stop();
    const StreamStats stats = run.stats();
    CHECK(stats.records == stats.ring_refused + run.zero.size() + run.one.size());
    check_conservation(stats);
  }

  TEST_CASE("stop is prompt in every state, and start works again") {
    const auto check_prompt_stop = [](Run& run) {
      const auto begin = HostClock::now();
      run.stop();
      run.stop();
      CHECK(HostClock::now() - begin < 1s);
    };
    {
      const VrpnServer server;
      Run run(server.at());
      for (int round = 0; round < 3; ++round) {
        REQUIRE(run.delivers(20));
        check_prompt_stop(run);
        run.start();
      }
    }
    for (const auto wait : {0ms, 1000ms, 2500ms}) { // silent, asking, connecting
      VrpnServer server;
      Run run(server.at());
      server.signal(SIGSTOP);
      REQUIRE(eventually([&] { return run.stats().silences == 1; }));
      std::this_thread::sleep_for(wait);
      check_prompt_stop(run);
    }
    VrpnServer server;
    Run run(server.at());
    server.kill();
    std::this_thread::sleep_for(700ms);
    check_prompt_stop(run);
  }

  TEST_CASE("servers that are not there or no VRPN servers are errors with a remedy") {
    const VrpnServer server({"--tracker", "Tracker0", "--tracker", "Tracker1"});
    // Twice: the first attempt must not have made the name known.
    for (int attempt = 0; attempt < 2; ++attempt)
      check_refused("vrpn:Tracker9@" + server.at(), Errc::no_device,
                    {"no tracker 'Tracker9'", "it has: Button0, Tracker0, Tracker1"});
    check_refused("vrpn:Button0@" + server.at(), Errc::no_device,
                  {"knows the name 'Button0'", "is it started", "Tracker0"});
    CHECK_FALSE(server.said("Tracker9"));
    const VrpnServer older({"--version", "vrpn: ver. 06.04"});
    check_refused("vrpn:Tracker0@" + older.at(), Errc::no_device, {"VRPN 7", "vrpn: ver. 06.04"});
    const VrpnServer shell({"--first-words", "SSH-2.0-OpenSSH_9.2p1 Debian-2\r\n"});
    check_refused("vrpn:Tracker0@" + shell.at(), Errc::no_device,
                  {"VRPN 7", "'SSH-2.0-OpenSSH_'", "port right"});
    const VrpnServer brief({"--first-words", "hm"});
    check_refused("vrpn:Tracker0@" + brief.at(), Errc::no_device, {"VRPN 7", "port right"});
    const VrpnServer mute({"--mute"});
    check_refused("vrpn:Tracker0@" + mute.at(), Errc::no_device, {"says nothing", "Restart"});
    const VrpnServer closing({"--closes"});
    check_refused("vrpn:Tracker0@" + closing.at(), Errc::no_device, {"closed the connection"});
    const VrpnServer empty({"--no-tracker"});
    check_refused("vrpn:Tracker0@" + empty.at(), Errc::no_device, {"no tracker", "Button0"});
    VrpnServer gone;
    gone.kill();
    check_refused("vrpn:Tracker0@" + gone.at(), Errc::no_device,
                  {gone.at(), "no program accepts connections", "server started"});
    check_refused("vrpn:Tracker0@nendo-no-such-host.invalid", Errc::no_device,
                  {"nendo-no-such-host.invalid: ", "name"});
  }

  TEST_CASE("specifications that name no tracker at a server are usage errors") {
    for (const std::string target :
         {"", ":", ":Tracker0", ":@host", ":Tracker0@", ":Tracker0@:3883", ":Tracker0@host:",
          ":Tracker0@host:0", ":Tracker0@host:65536", ":Tracker0@host:x", ":Tracker0@::1",
          ":Tracker0@fe80::1:3883", ":Tracker0@[::1", ":Tracker0@[]:3883", ":Tracker0@[::1]3883"})
      check_refused("vrpn" + target, Errc::usage, {"vrpn:Tracker0@"});
    check_refused("vrpn:" + std::string(100, 'n') + "@host", Errc::usage, {"99 characters"});
    for (const std::string sensor : {"-1", "65536", "x", "1.5"})
      check_refused("vrpn:Tracker0@host?sensor=" + sensor, Errc::usage, {"0 to 65535"});
    check_refused("vrpn:Tracker0@host?up=x", Errc::usage, {"up=x", "y, z"});
    check_refused("vrpn:Tracker0@host?rate=1", Errc::usage, {"rate", "known: up"});
  }

  TEST_CASE("servers are found by name, and by addresses of IPv6") {
    const VrpnServer server;
    const auto named = opened({"vrpn:Tracker0@" + server.at("localhost")});
    CHECK(fact_of(named[0].tracker->info(), "server") == server.at("localhost"));
    if (!has_ipv6()) {
      MESSAGE("no IPv6 on this machine");
      return;
    }
    const VrpnServer six({"--address", "::1"});
    Run run(six.at("[::1]"));
    CHECK(run.delivers(20));
    CHECK(fact_of(run.info(), "server") == six.at("[::1]"));
  }
}

} // namespace vrpn_driver_test
