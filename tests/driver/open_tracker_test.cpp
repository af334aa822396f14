#include <nendo/driver/open_tracker.hpp>

#include <array>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/eventually.hpp"
#include "support/required.hpp"

namespace open_tracker_test {

using namespace nendo;
using namespace nendo::driver;
using nendo::test::eventually;
using nendo::test::required;
using Specs = std::vector<std::string>;

namespace {

/// A tracker of another program, which counts its openings and refuses to start.
class Foreign final : public Tracker {
public:
  explicit Foreign(std::span<const std::uint16_t> stations) {
    info_.stations.assign(stations.begin(), stations.end());
  }
  const TrackerInfo& info() const noexcept override { return info_; }
  Result<void> start(std::span<const StationRing>) override {
    return Error{Errc::no_device, "it went away"};
  }
  void stop() noexcept override {}
  StreamStats stats() const noexcept override { return {}; }

private:
  TrackerInfo info_;
};

Result<std::uint16_t> take_target_as_station(DeviceSpec& spec) {
  const auto station = static_cast<std::uint16_t>(spec.target == "left" ? 1 : 2);
  spec.target.clear();
  return station;
}

Result<std::unique_ptr<Tracker>> open_foreign(const DeviceSpec& spec,
                                              std::span<const std::uint16_t> stations) {
  if (spec.options.count("away") > 0) return Error{Errc::no_device, "nothing comes"};
  return std::unique_ptr<Tracker>(std::make_unique<Foreign>(stations));
}

constexpr std::array foreign{
    TrackerDriver{"foreign", "foreign:HAND", "another", take_target_as_station, open_foreign},
    TrackerDriver{"sim", "sim", "hidden", take_target_as_station, open_foreign}};

void check_usage(const Specs& specs, std::string_view said) {
  const auto opened = open_trackers(specs);
  REQUIRE_FALSE(opened);
  CAPTURE(opened.error().message);
  CHECK(opened.error().code == Errc::usage);
  CHECK(opened.error().message.find(said) != std::string::npos);
}

} // namespace

TEST_SUITE("open_tracker") {
  TEST_CASE("two stations of one specification share a tracker, in the order of the request") {
    const auto stations = required(open_trackers(
        Specs{"sim:orbit?station=2", "sim:rest", "sim:orbit", "sim:orbit?station=2&rate=60"}));
    REQUIRE(stations.size() == 4);
    CHECK(stations[0].tracker == stations[2].tracker);
    CHECK(stations[0].tracker != stations[1].tracker);
    CHECK(stations[0].tracker != stations[3].tracker); // another rate is another tracker
    CHECK(stations[0].station == 2);
    CHECK(stations[1].station == 1);
    CHECK(stations[2].station == 1);
    CHECK(stations[0].tracker->info().stations == std::vector<std::uint16_t>{2, 1});
    CHECK(stations[0].tracker->info().rate_hz == 240.0);
    CHECK(stations[0].tracker->info().kind == SourceKind::simulated);
    CHECK(stations[0].tracker->info().source == "sim:orbit?station=2");
  }

  TEST_CASE("each station has a specification of its own, which names it") {
    const auto stations =
        required(open_trackers(Specs{"sim:orbit?station=2", "sim:orbit", "sim?rate=60"}));
    CHECK(stations[0].source == "sim:orbit?station=2");
    CHECK(stations[1].source == "sim:orbit?station=1");
    CHECK(stations[2].source == "sim?rate=60&station=1");
    for (const TrackerStation& station : stations) {
      const auto again = required(open_trackers(Specs{station.source}));
      CHECK(again.front().station == station.station);
      CHECK(again.front().source == station.source);
    }
  }

  TEST_CASE("a station that is named twice is one station, with two rings") {
    const auto stations = required(open_trackers(Specs{"sim:orbit", "sim:orbit"}));
    CHECK(stations[0].tracker == stations[1].tracker);
    CHECK(stations[0].tracker->info().stations.size() == 1);
    PoseRing first(64);
    PoseRing second(64);
    const std::array<PoseRing*, 2> rings{&first, &second};
    test::require_ok(start_trackers(stations, rings));
    CHECK(eventually([&] { return first.size() > 3 && second.size() > 3; }));
    stations[0].tracker->stop();
  }

  TEST_CASE("each ring gets the poses of its own station") {
    const auto stations =
        required(open_trackers(Specs{"sim:orbit?station=2", "sim:orbit?station=1"}));
    PoseRing second(1024);
    PoseRing first(1024);
    const std::array<PoseRing*, 2> rings{&second, &first};
    test::require_ok(start_trackers(stations, rings));
    CHECK(start_trackers(stations, rings).error().code == Errc::failed);
    CHECK(eventually([&] { return first.size() > 20 && second.size() > 20; }));
    stations[0].tracker->stop();
    first.drain([](const PoseSample& sample) { CHECK(sample.station == 1); });
    second.drain([](const PoseSample& sample) {
      CHECK(sample.station == 2);
      CHECK(sample.measured <= sample.arrival);
    });
  }

  TEST_CASE("wrong specifications of trackers are usage errors that name what there is") {
    check_usage({"compass:north"}, "sim, fastrak");
    check_usage({"sim:orbit", "sim:dance"}, "rest, orbit, walk, table, cross");
    check_usage({"sim:orbit?station=0"}, "from 1 to 16");
    check_usage({"sim:orbit?station=17"}, "from 1 to 16");
    check_usage({"sim:orbit?station=x"}, "from 1 to 16");
    check_usage({"sim:orbit?speed=2"}, "rate");
    check_usage({"sim:orbit?rate=0"}, "from 1 to 1000");
    check_usage({"sim:orbit?rate=nan"}, "from 1 to 1000");
    check_usage({""}, "kind");
    CHECK(required(open_trackers(Specs{})).empty());
  }

  TEST_CASE("a program's own trackers are opened, and their errors name them") {
    const auto stations =
        required(open_trackers(Specs{"foreign:right", "foreign:left", "sim:orbit"}, foreign));
    CHECK(stations[0].tracker == stations[1].tracker);
    CHECK(stations[1].station == 1);
    CHECK(stations[2].tracker->info().kind == SourceKind::simulated); // the library's name wins
    const auto away = open_trackers(Specs{"foreign:left?away=1"}, foreign);
    REQUIRE_FALSE(away);
    CHECK(away.error().code == Errc::no_device);
    CHECK(away.error().message == "foreign:left?away=1: nothing comes");
    CHECK(tracker_drivers(foreign).size() == tracker_drivers().size() + 2);
  }

  TEST_CASE("if one tracker does not start, those that were started are stopped") {
    const auto stations = required(open_trackers(Specs{"sim:orbit", "foreign:left"}, foreign));
    PoseRing first(1024);
    PoseRing second(1024);
    const std::array<PoseRing*, 2> rings{&first, &second};
    CHECK(start_trackers(stations, rings).error().code == Errc::no_device);
    const std::array<StationRing, 1> alone{{{1, &first}}};
    test::require_ok(stations[0].tracker->start(alone)); // it does not run
    stations[0].tracker->stop();
  }
}

} // namespace open_tracker_test
