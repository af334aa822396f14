#pragma once
// Checks that every streamed tracker must pass. Each function is the body of a test case.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/driver/open_tracker.hpp>

#include "support/eventually.hpp"
#include "support/python_device.hpp"
#include "support/required.hpp"
#include "support/temporary_folder.hpp"

namespace nendo::test {

using namespace std::chrono_literals;

/// A kind of tracker that a Python program emulates.
struct TrackerKind {
  std::string name;   ///< in specifications
  std::string script; ///< the program
  std::uint64_t longest_record = 0;
  std::vector<std::string> options = {}; ///< the program's, before those of plug()
  bool is_named_by_path = true;          ///< specifications have the path of the program's port

  std::unique_ptr<PythonDevice> plug(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), options.begin(), options.end());
    return std::make_unique<PythonDevice>(script, std::move(more));
  }
  /// Returns the specification of its first station.
  std::string spec(const std::string& path) const {
    return name + ":" + (is_named_by_path ? path : "");
  }
  /// Returns a specification for each of these stations.
  std::vector<std::string> specs(const std::string& path, const std::vector<int>& stations,
                                 const std::string& more = {}) const {
    std::vector<std::string> list;
    for (const int station : stations)
      list.push_back(spec(path) + "?station=" + std::to_string(station) + more);
    return list;
  }
};

/// A station of an open tracker, and the ring of its poses.
struct OneStation {
  explicit OneStation(const std::string& spec, std::size_t ring_size = 1U << 12U)
      : ring(ring_size), station(required(driver::open_trackers(std::vector{spec})).front()) {}
  driver::Tracker& tracker() const { return *station.tracker; }
  Result<void> start() {
    PoseRing* const rings[]{&ring};
    return driver::start_trackers({&station, 1}, rings);
  }

  PoseRing ring; ///< outlives the tracker
  driver::TrackerStation station;
};

/// Returns a fact's value, or an empty string if the tracker does not have that fact.
inline std::string fact(const driver::TrackerInfo& info, std::string_view name) {
  for (const driver::DeviceFact& entry : info.facts)
    if (entry.name == name) return entry.value;
  return {};
}

inline void check_tracker_conservation(const driver::StreamStats& stats,
                                       std::uint64_t longest_record) {
  CHECK(stats.bytes >= stats.record_bytes + stats.discarded_bytes);
  CHECK(stats.bytes - stats.record_bytes - stats.discarded_bytes < longest_record);
}

/// Checks that opening fails within 5 s with one line of `no_device` that names `spec` and `said`.
inline void check_no_tracker(const std::string& spec, std::string_view said) {
  const auto start = HostClock::now();
  const auto tracker = driver::open_trackers(std::vector{spec});
  CHECK(HostClock::now() - start < 5s);
  REQUIRE_FALSE(tracker);
  CAPTURE(tracker.error().message);
  CHECK(tracker.error().code == Errc::no_device);
  CHECK(tracker.error().message.find(said) != std::string::npos);
  CHECK(tracker.error().message.find(spec) == 0);
  CHECK(tracker.error().message.find('\n') == std::string::npos);
}

inline void no_tracker_is_an_error_that_says_so(const TrackerKind& kind) {
  for (const auto& [odd, said] :
       {std::pair("silent", "switched on"), std::pair("babble", "baud")}) {
    const auto port = kind.plug({"--odd", odd});
    check_no_tracker(kind.spec(port->path()), said);
  }
  const auto missing = driver::open_trackers(std::vector{kind.spec("/dev/nendo-no-such-port")});
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == Errc::no_device);
}

inline void poses_are_in_order_and_add_up(const TrackerKind& kind) {
  const auto port = kind.plug();
  OneStation hand(kind.spec(port->path()));
  const HostTime before = HostClock::now();
  test::require_ok(hand.start());
  CHECK(hand.start().error().code == Errc::failed);
  CHECK(eventually([&] { return hand.ring.size() >= 40; }));
  hand.tracker().stop();
  std::uint64_t next = 0;
  HostTime last = before;
  HostTime last_measured{};
  hand.ring.drain([&](const PoseSample& sample) {
    CHECK(sample.sequence == next++);
    CHECK(sample.station == 1);
    CHECK(sample.arrival >= last);
    CHECK(sample.measured < sample.arrival);
    CHECK(sample.measured > sample.arrival - 1s);
    CHECK(sample.measured >= last_measured);
    last = sample.arrival;
    last_measured = sample.measured;
  });
  CHECK(last <= HostClock::now());
  const driver::StreamStats stats = hand.tracker().stats();
  CHECK(stats.records == next);
  CHECK(stats.bad_records == 0);
  check_tracker_conservation(stats, kind.longest_record);
}

inline void a_full_ring_refuses_poses_and_counts(const TrackerKind& kind) {
  const auto port = kind.plug();
  OneStation hand(kind.spec(port->path()), 8);
  test::require_ok(hand.start());
  CHECK(eventually([&] { return hand.tracker().stats().ring_refused > 5; }));
  hand.tracker().stop();
  const driver::StreamStats stats = hand.tracker().stats();
  CHECK(stats.records == stats.ring_refused + hand.ring.size());
}

inline void a_tracker_stops_promptly_and_starts_again(const TrackerKind& kind) {
  const auto port = kind.plug();
  OneStation hand(kind.spec(port->path()));
  for (int round = 0; round < 2; ++round) {
    test::require_ok(hand.start());
    CHECK(eventually([&] { return hand.tracker().stats().records > 3; }));
    const auto start = HostClock::now();
    hand.tracker().stop();
    hand.tracker().stop();
    CHECK(HostClock::now() - start < 1s);
  }
}

inline void a_silent_tracker_is_started_again(const TrackerKind& kind) {
  const auto port = kind.plug();
  OneStation hand(kind.spec(port->path()));
  test::require_ok(hand.start());
  REQUIRE(eventually([&] { return hand.tracker().stats().records > 3; }));
  port->set_mute(true);
  REQUIRE(eventually([&] { return hand.tracker().stats().silences >= 1; }));
  const std::uint64_t before = hand.tracker().stats().records;
  port->set_mute(false);
  CHECK(eventually([&] { return hand.tracker().stats().records > before + 3; }));
  hand.tracker().stop();
  const driver::StreamStats stats = hand.tracker().stats();
  CHECK(stats.silences == 1);
  CHECK(stats.reopened == 0);
  CHECK(stats.records == hand.ring.size());
  check_tracker_conservation(stats, kind.longest_record);
}

inline void a_tracker_stops_promptly_while_silent_or_away(const TrackerKind& kind) {
  for (const bool away : {false, true}) {
    CAPTURE(away);
    const auto port = kind.plug();
    OneStation hand(kind.spec(port->path()));
    test::require_ok(hand.start());
    REQUIRE(eventually([&] { return hand.tracker().stats().records > 3; }));
    if (away) {
      port->unplug();
      std::this_thread::sleep_for(200ms); // nothing shows that the loss was noticed
    } else {
      port->set_mute(true);
      REQUIRE(eventually([&] { return hand.tracker().stats().silences >= 1; }));
    }
    const auto start = HostClock::now();
    hand.tracker().stop();
    CHECK(HostClock::now() - start < 1s);
  }
}

inline void a_tracker_that_vanishes_is_found_again(const TrackerKind& kind) {
  const TemporaryFolder folder;
  const auto link = folder.path() / "tracker";
  auto first = kind.plug();
  std::filesystem::create_symlink(first->path(), link);
  OneStation hand(kind.spec(link.string()));
  test::require_ok(hand.start());
  REQUIRE(eventually([&] { return hand.ring.size() > 3; }));

  first.reset();
  std::filesystem::remove(link);
  const auto second = kind.plug();
  std::filesystem::create_symlink(second->path(), link);
  REQUIRE(eventually([&] { return hand.tracker().stats().reopened == 1; }));
  hand.ring.drain([](const PoseSample&) {});
  REQUIRE(eventually([&] { return hand.ring.size() > 3; }));
  hand.tracker().stop();
  check_tracker_conservation(hand.tracker().stats(), kind.longest_record);
}

/// An option that a kind of tracker does not have or a value that it does not take, and the
/// error's words.
struct WrongTrackerOption {
  const char* options;
  const char* said;
};

inline void
wrong_tracker_options_are_usage_errors(const std::string& kind,
                                       std::initializer_list<WrongTrackerOption> cases) {
  for (const WrongTrackerOption& wrong : cases) {
    const auto tracker =
        driver::open_trackers(std::vector<std::string>{kind + ":/dev/nendo-none" + wrong.options});
    REQUIRE_FALSE(tracker);
    CAPTURE(tracker.error().message);
    CHECK(tracker.error().code == Errc::usage);
    CHECK(tracker.error().message.find(wrong.said) != std::string::npos);
  }
  CHECK(driver::open_trackers(std::vector{kind + ":"}).error().code == Errc::usage);
}

} // namespace nendo::test
