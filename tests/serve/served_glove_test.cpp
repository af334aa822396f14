// Both ends of the socket: what a loop took at the server is what the driver delivers elsewhere.

#include <chrono>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/open_tracker.hpp>

#include "serve_fixtures.hpp"

namespace served_glove_test {

using namespace nendo;
using namespace std::chrono_literals;
using test::eventually;
using test::required;
using test::ServedHands;

namespace {

/// Sends until the driver gets samples: from then on, it gets all.
template <class Send, class Stats>
bool gets_samples(const Send& send, const Stats& stats) {
  return eventually([&] {
    send();
    return stats().records > 0;
  });
}

} // namespace

TEST_SUITE("served_glove") {
  TEST_CASE("a shared glove has the identity, samples and times of the glove itself") {
    const ServedHands served;
    const driver::GloveInfo original = test::two_gloves().gloves[0].info;
    const auto glove = required(driver::open_glove("serve:?hand=left"));
    CHECK(glove->info().model == original.model);
    CHECK(glove->info().side == original.side);
    CHECK(glove->info().sensors == original.sensors);
    CHECK(glove->info().counts == original.counts);
    CHECK(glove->info().rate_hz == original.rate_hz);
    CHECK(glove->info().facts[0].name == "serial");
    CHECK(glove->info().facts[0].value == original.facts[0].value);

    SampleRing ring(1U << 14U);
    test::require_ok(glove->start(ring));
    std::uint64_t number = 0;
    REQUIRE(gets_samples([&] { served.send(ServedHands::left_input, number++); },
                         [&] { return glove->stats(); }));
    std::vector<GloveSample> sent;
    std::vector<GloveSample> got;
    const auto take = [&] {
      ring.drain([&](const GloveSample& sample) {
        if (sample.has_device_time) got.push_back(sample); // those before had none
      });
      return got.size();
    };
    for (int at = 0; at < 300; ++at) {
      GloveSample sample = test::numbered_sample(Side::left, number++);
      sample.measured = sample.arrival - std::chrono::nanoseconds(at);
      sample.has_device_time = true;
      sample.device_time = std::chrono::nanoseconds(at);
      sample.wrist_switch = at % 2 == 0 ? WristSwitch::on : WristSwitch::off;
      served.server->input().sample(ServedHands::left_input, sample);
      served.send(ServedHands::right_input, number); // of the other glove
      sent.push_back(sample);
      REQUIRE(eventually([&] { return take() + 20 > sent.size(); })); // the driver keeps up
    }
    REQUIRE(eventually([&] { return take() >= sent.size(); }));
    glove->stop();
    REQUIRE(got.size() == sent.size());
    for (std::size_t at = 0; at < sent.size(); ++at) {
      CHECK(got[at].arrival == sent[at].arrival);
      CHECK(got[at].measured == sent[at].measured);
      CHECK(got[at].device_time == sent[at].device_time);
      CHECK(got[at].raw == sent[at].raw);
      CHECK(got[at].present == sent[at].present);
      CHECK(got[at].wrist_switch == sent[at].wrist_switch);
    }
    CHECK(glove->stats().missed == 0);
    CHECK(glove->stats().bad_records == 0);
  }

  TEST_CASE("a shared station has the poses of the tracker itself, and the name of its mount") {
    const ServedHands served;
    const auto stations = required(driver::open_trackers(std::vector<std::string>{"serve:"}));
    CHECK(stations[0].mount_source() == "fastrak:/dev/ttyUSB2");
    CHECK(stations[0].mount_station() == 4);
    CHECK(stations[0].tracker->info().rate_hz == 60.0);
    PoseRing ring(1U << 12U);
    PoseRing* const rings[]{&ring};
    test::require_ok(driver::start_trackers(stations, rings));
    PoseSample pose;
    pose.station = 4;
    pose.error = 'A';
    pose.position_m = {1.0 / 3.0, -2e-17, 3.0};
    pose.turn_xyzw = {0.1, 0.2, 0.3, 0.4};
    REQUIRE(gets_samples(
        [&] {
          pose.arrival = HostClock::now();
          pose.measured = pose.arrival - 5ms;
          served.server->input().pose(Side::right, pose);
        },
        [&] { return stations[0].tracker->stats(); }));
    PoseSample got;
    REQUIRE(ring.try_pop(got));
    stations[0].tracker->stop();
    CHECK(got.station == 1);
    CHECK(got.error == 'A');
    CHECK(got.arrival - got.measured == 5ms);
    CHECK(got.position_m == pose.position_m);
    CHECK(got.turn_xyzw == pose.turn_xyzw);
  }

  TEST_CASE("a server that is started again under its name is found again") {
    test::RuntimeFolder folder;
    const driver::ServeFolders folders{driver::serve_folders().own, ""};
    const auto start = [&] {
      return required(
          serve::Server::open(required(serve::Socket::claim({}, folders)), test::two_gloves()));
    };
    auto server = start();
    const auto glove = required(driver::open_glove("serve", Side::right));
    SampleRing ring(1U << 14U);
    test::require_ok(glove->start(ring));
    const auto send = [&] {
      server->input().sample(ServedHands::right_input, test::numbered_sample(Side::right, 1));
    };
    REQUIRE(gets_samples(send, [&] { return glove->stats(); }));
    server.reset();
    server = start();
    REQUIRE(eventually([&] { return glove->stats().reopened == 1; }));
    const std::uint64_t before = glove->stats().records;
    CHECK(eventually([&] {
      send();
      return glove->stats().records > before;
    }));
    glove->stop();
  }
}

} // namespace served_glove_test
