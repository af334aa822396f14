// The drivers `serve:` against a server that was written from PROTOCOL.md alone.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/open_tracker.hpp>

#include "support/eventually.hpp"
#include "support/python_device.hpp"
#include "support/required.hpp"
#include "support/runtime_folder.hpp"
#include "support/stream_laws.hpp"
#include "support/tracker_laws.hpp"

namespace served_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace std::chrono_literals;
using nendo::test::eventually;
using nendo::test::PythonDevice;
using nendo::test::required;

namespace {

constexpr std::uint64_t longest = 65'536;

/// A server in a folder of its own.
struct Served {
  test::RuntimeFolder folder;
  PythonDevice server;

  explicit Served(std::vector<std::string> options = {})
      : server(NENDO_SERVE_SERVER, std::move(options)) {}
  std::uint64_t requests(const std::string& words) {
    const std::string heard = server.ask("heard");
    std::uint64_t count = 0;
    for (std::size_t at = 0; (at = heard.find(words, at)) != std::string::npos; ++at)
      ++count;
    return count;
  }
};

/// A glove that streams.
struct Running {
  SampleRing ring{1U << 14U};
  std::unique_ptr<Glove> glove;

  explicit Running(const std::string& spec, std::optional<Side> side = std::nullopt)
      : glove(required(open_glove(spec, side))) {
    test::require_ok(glove->start(ring));
  }
  bool delivers(std::uint64_t more) {
    const std::uint64_t before = glove->stats().records;
    return eventually([&] { return glove->stats().records >= before + more; });
  }
  std::vector<GloveSample> stopped() {
    glove->stop();
    std::vector<GloveSample> samples;
    ring.drain([&](const GloveSample& sample) { samples.push_back(sample); });
    return samples;
  }
};

/// Returns the number of a sample at the server, by its clock there.
std::int64_t number_of(std::chrono::nanoseconds device_time) {
  return device_time / 10ms;
}

void check_sample(const GloveSample& sample, Side side) {
  const std::int64_t number = number_of(sample.device_time);
  CHECK(sample.side == side);
  CHECK(sample.present == sensors_22);
  CHECK(sample.has_device_time);
  CHECK(sample.arrival - sample.measured == 3ms);
  CHECK(sample.wrist_switch == (number % 2 == 1 ? WristSwitch::on : WristSwitch::off));
  std::int64_t at = 0;
  for (const Sensor sensor : sample.present)
    CHECK(sample[sensor].value == (7 * number + at++) % 256);
}

Error refused(const std::string& spec, std::optional<Side> side = std::nullopt) {
  const auto begin = HostClock::now();
  const auto glove = open_glove(spec, side);
  CHECK(HostClock::now() - begin < 5s);
  REQUIRE_FALSE(glove);
  CHECK(glove.error().message.find('\n') == std::string::npos);
  return glove.error();
}

void check_refused(const Error& error, Errc code, const std::vector<std::string>& said) {
  CAPTURE(error.message);
  CHECK(error.code == code);
  for (const std::string& words : said)
    CHECK_MESSAGE(error.message.find(words) != std::string::npos, words);
}

/// A server as the laws of gloves plug one in. Its name is that of the socket.
class LawServer {
public:
  explicit LawServer(Side side)
      : server_(NENDO_SERVE_SERVER, {"--gloves", std::string(name_of(side))}) {
    mute.server = &server_;
  }
  const std::string& path() const { return server_.path(); }

  struct Mute {
    PythonDevice* server = nullptr;
    void operator=(bool on) const { server->set_mute(on); }
  } mute;

private:
  PythonDevice server_;
};

struct GloveLaws {
  test::RuntimeFolder folder{};
  std::uint64_t longest_record = longest;

  std::unique_ptr<LawServer> plug(Side side) const { return std::make_unique<LawServer>(side); }
  std::string spec(const std::string& /*path*/) const { return "serve:"; }
};

const test::TrackerKind tracker_kind{
    "serve", NENDO_SERVE_SERVER, longest, {"--trackers", "right", "--gloves", ""}, false};

} // namespace

TEST_SUITE("served_driver") {
  TEST_CASE("samples are those of the server, with its times") {
    Served served;
    const HostTime before = HostClock::now();
    Running run("serve");
    REQUIRE(run.delivers(40));
    const auto samples = run.stopped();
    std::uint64_t next = 0;
    for (const GloveSample& sample : samples) {
      check_sample(sample, Side::right);
      CHECK(sample.sequence == next++);
      CHECK(sample.arrival >= before);
      CHECK(sample.arrival <= HostClock::now());
      CHECK(number_of(sample.device_time) ==
            number_of(samples[0].device_time) + static_cast<std::int64_t>(sample.sequence));
    }
    const StreamStats stats = run.glove->stats();
    CHECK(stats.records == samples.size());
    CHECK(stats.bad_records == 0);
    CHECK(stats.counts_missed);
    CHECK(stats.missed == 0);
    test::check_conservation(stats, longest);
    CHECK(eventually([&] { return served.requests("\"samples\": false") >= 2; }));
  }

  TEST_CASE("a glove is what it is at the server") {
    Served served({"--name", "other.one", "--gloves", "left right"});
    const auto glove = required(open_glove("serve:other.one?hand=left"));
    const GloveInfo& info = glove->info();
    CHECK(info.source == "serve:other.one?hand=left");
    CHECK(info.model == "CyberGlove, 22 sensors");
    CHECK(info.side == Side::left);
    CHECK(info.sensors == sensors_22);
    CHECK(info.counts == CountScale{255, false});
    CHECK(info.rate_hz == 100.0);
    CHECK(info.abilities.wrist_switch);
    CHECK_FALSE(info.abilities.light);
    CHECK_FALSE(info.abilities.vibration);
    CHECK(info.kind == SourceKind::device);
    // The identity by which calibrations are found, and the order of the report.
    REQUIRE(info.facts.size() == 6);
    const std::vector<std::pair<std::string, std::string>> facts{
        {"serial", "A0"},
        {"firmware", "2.1"},
        {"a_last_one", "z"},
        {"server", served.server.path()},
        {"server_version", "0.2.0"},
        {"server_source", "serial:/dev/ttyUSB0"}};
    for (std::size_t at = 0; at < facts.size(); ++at) {
      CHECK(info.facts[at].name == facts[at].first);
      CHECK(info.facts[at].value == facts[at].second);
    }
  }

  TEST_CASE("of two gloves, the option decides, and then the wanted hand") {
    const Served served({"--gloves", "left right"});
    CHECK(required(open_glove("serve", Side::left))->info().side == Side::left);
    CHECK(required(open_glove("serve", Side::right))->info().side == Side::right);
    CHECK(required(open_glove("serve:?hand=left", Side::right))->info().side == Side::left);
    check_refused(refused("serve:hands"), Errc::usage,
                  {"both hands", "left ('CyberGlove, 22 sensors')", "right (", "?hand=left"});
    Running left("serve:?hand=left");
    Running right("serve", Side::right);
    REQUIRE(left.delivers(20));
    REQUIRE(right.delivers(20));
    for (const GloveSample& sample : left.stopped())
      check_sample(sample, Side::left);
    for (const GloveSample& sample : right.stopped())
      check_sample(sample, Side::right);
    CHECK(left.glove->stats().bad_records == 0);
  }

  TEST_CASE("a hand that the server does not have is an error that names those it has") {
    const Served served;
    for (const Error& error : {refused("serve", Side::left), refused("serve:?hand=left")})
      check_refused(error, Errc::no_device, {"no left glove", "right ('CyberGlove"});
    const auto tracker = open_trackers(std::vector<std::string>{"serve"});
    REQUIRE_FALSE(tracker);
    check_refused(tracker.error(), Errc::no_device, {"no tracker"});
  }

  TEST_CASE("no server, or none that answers, is an error that says so") {
    test::RuntimeFolder folder;
    check_refused(refused("serve:"), Errc::no_device,
                  {"serve:", folder.path().string() + "/nendo/hands.sock", "/run/nendo/hands.sock",
                   "nendo serve"});
    for (const auto& [odd, said] : {std::pair("silent", "says nothing"),
                                    {"babble", "does not answer as `nendo serve`"},
                                    {"refuse", "refuses: 'no place'"},
                                    {"later", "speaks protocol 2"}}) {
      const PythonDevice server(NENDO_SERVE_SERVER, {"--odd", odd});
      check_refused(refused("serve:"), Errc::no_device, {"serve:", "hands.sock", said});
    }
    // The socket of a server that has died.
    check_refused(refused("serve:"), Errc::no_device, {"no program shares devices"});
  }

  TEST_CASE("wrong names and options are usage errors") {
    for (const char* spec : {"serve:a/b", "serve:..%", "serve:x?side=left", "serve:?hand=both",
                             "serve:0123456789012345678901234567890123456789012345678901234567890"
                             "1234"}) {
      CHECK(open_glove(spec).error().code == Errc::usage);
      CHECK(open_trackers(std::vector<std::string>{spec}).error().code == Errc::usage);
    }
  }

  TEST_CASE("damaged lines between samples cost no sample") {
    Served served;
    Running run("serve");
    REQUIRE(run.delivers(3));
    const std::vector<std::string> garbage{"",
                                           "x",
                                           "{}",
                                           R"({"class":"SAMPLE","glove":0})",
                                           R"({"class":"SAMPLE","glove":"0"})",
                                           "[[[[",
                                           R"({"class":"POSE","tracker":1e99})",
                                           std::string(300'000, 'y')};
    for (const std::string& line : garbage) {
      served.server.ask("say " + line);
      REQUIRE(run.delivers(3));
    }
    const auto samples = run.stopped();
    for (std::size_t at = 1; at < samples.size(); ++at)
      CHECK(number_of(samples[at].device_time) == number_of(samples[at - 1].device_time) + 1);
    const StreamStats stats = run.glove->stats();
    CHECK(stats.bad_records == garbage.size());
    CHECK(stats.silences == 0);
    test::check_conservation(stats, longest);
  }

  TEST_CASE("samples that the server drops are counted as missed") {
    Served served;
    Running run("serve");
    REQUIRE(run.delivers(5));
    served.server.ask("drop 7");
    REQUIRE(eventually([&] { return run.glove->stats().missed == 7; }));
    const auto samples = run.stopped();
    const StreamStats stats = run.glove->stats();
    CHECK(samples.size() == stats.records);
    CHECK(static_cast<std::uint64_t>(number_of(samples.back().device_time) -
                                     number_of(samples.front().device_time)) +
              1 ==
          stats.records + stats.missed);
  }

  TEST_CASE("samples of another clock are refused") {
    const Served served({"--ahead", "3600"});
    Running run("serve");
    CHECK(eventually([&] { return run.glove->stats().bad_records > 20; }));
    run.glove->stop();
    CHECK(run.glove->stats().records == 0);
    CHECK(run.glove->stats().implausible == run.glove->stats().bad_records);
  }

  TEST_CASE("stop and a second start deliver no sample twice and none of between") {
    Served served;
    Running run("serve");
    REQUIRE(run.delivers(5));
    const auto first = run.stopped();
    std::this_thread::sleep_for(100ms);
    const HostTime again = HostClock::now();
    test::require_ok(run.glove->start(run.ring));
    REQUIRE(run.delivers(5));
    const auto second = run.stopped();
    CHECK(second.front().arrival >= again - 20ms); // the server's tick may have begun before
    CHECK(second.front().sequence == 0);
    CHECK(run.glove->stats().missed == 0);
    CHECK(served.requests("\"samples\": true") == 2);
  }

  TEST_CASE("a full ring refuses a shared glove's samples and counts them") {
    test::a_full_ring_refuses_and_counts(GloveLaws{});
  }
  TEST_CASE("a shared glove stops promptly and starts again") {
    test::stop_is_prompt_and_start_works_again(GloveLaws{});
  }
  TEST_CASE("a glove that falls silent at the server is asked for again") {
    test::a_silent_stream_is_started_again(GloveLaws{});
  }

  TEST_CASE("a server that comes back is found again, with another glove") {
    const test::RuntimeFolder folder;
    auto first = std::make_unique<PythonDevice>(NENDO_SERVE_SERVER);
    Running run("serve");
    REQUIRE(run.delivers(3));
    first.reset();
    const PythonDevice second(NENDO_SERVE_SERVER, {"--gloves", "left"});
    REQUIRE(eventually([&] { return run.glove->stats().reopened == 1; }));
    run.ring.drain([](const GloveSample&) {});
    REQUIRE(run.delivers(3));
    for (const GloveSample& sample : run.stopped())
      check_sample(sample, Side::left);
    CHECK(run.glove->info().side == Side::right);
    test::check_conservation(run.glove->stats(), longest);
  }

  TEST_CASE("the station of a shared tracker is a tracker of its own") {
    const Served served({"--trackers", "left right"});
    const std::vector<std::string> specs{"serve:?hand=left", "serve:hands?hand=right"};
    const auto stations = required(open_trackers(specs));
    REQUIRE(stations[0].tracker != stations[1].tracker);
    for (std::size_t at = 0; at < 2; ++at) {
      const TrackerInfo& info = stations[at].tracker->info();
      CHECK(info.source == specs[at]);
      CHECK(info.model == "FASTRAK");
      CHECK(info.stations == std::vector<std::uint16_t>{1});
      CHECK(info.rate_hz == 60.0); // half of both stations' rate
      CHECK(info.is_filtered);
      CHECK(info.stage_from_tracker_xyzw == stage_from_z_down_xyzw);
      CHECK(test::fact(info, "serial") == "F9");
      // The names by which the server's user calibrated the mount.
      CHECK(stations[at].mount_source() == "fastrak:/dev/ttyUSB2");
      CHECK(stations[at].mount_station() == 3 + at);
    }
    PoseRing left(1U << 12U);
    PoseRing right(1U << 12U);
    PoseRing* const rings[]{&left, &right};
    test::require_ok(start_trackers(stations, rings));
    for (std::size_t at = 0; at < 2; ++at) {
      REQUIRE(eventually([&] { return rings[at]->size() >= 20; }));
      stations[at].tracker->stop();
      std::uint64_t next = 0;
      rings[at]->drain([&](const PoseSample& pose) {
        CHECK(pose.station == 1);
        CHECK(pose.sequence == next++);
        CHECK(pose.position_m == std::array{static_cast<double>(number_of(pose.device_time)) / 1000,
                                            static_cast<double>(at), -1.5});
        CHECK(pose.turn_xyzw == std::array{0.5, -0.5, 0.5, 0.5});
        CHECK(pose.arrival - pose.measured == 3ms);
      });
    }
    const auto both = open_trackers(std::vector<std::string>{"serve:"});
    REQUIRE_FALSE(both);
    check_refused(both.error(), Errc::usage, {"trackers of both hands", "?hand=left"});
  }

  TEST_CASE("a shared tracker's poses are in order and add up") {
    const test::RuntimeFolder folder;
    test::poses_are_in_order_and_add_up(tracker_kind);
  }
  TEST_CASE("a full ring refuses a shared tracker's poses and counts them") {
    const test::RuntimeFolder folder;
    test::a_full_ring_refuses_poses_and_counts(tracker_kind);
  }
  TEST_CASE("a shared tracker stops promptly and starts again") {
    const test::RuntimeFolder folder;
    test::a_tracker_stops_promptly_and_starts_again(tracker_kind);
  }
  TEST_CASE("a tracker that falls silent at the server is asked for again") {
    const test::RuntimeFolder folder;
    test::a_silent_tracker_is_started_again(tracker_kind);
  }
  TEST_CASE("a shared tracker stops promptly while silent or away") {
    const test::RuntimeFolder folder;
    test::a_tracker_stops_promptly_while_silent_or_away(tracker_kind);
  }
  TEST_CASE("a tracker whose server comes back is found again") {
    const test::RuntimeFolder folder;
    test::a_tracker_that_vanishes_is_found_again(tracker_kind);
  }
}

} // namespace served_driver_test
