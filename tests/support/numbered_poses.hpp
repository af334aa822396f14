#pragma once
// The poses of the Python devices that emulate Polhemus' trackers. Each record of a station has a
// number n: x is 20 + n % 1000 / 100 cm, y 10 cm per station, z is -30 cm, and the turn is n % 1000
// milliradians about z.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/driver/open_tracker.hpp>

#include "support/required.hpp"
#include "support/tracker_laws.hpp"

namespace nendo::test {

/// How far the numbers of a correct record may be off.
struct PoseTolerance {
  double position_m = 1e-6;
  double quaternion = 1e-6;
};

/// Returns the number of a record, or -1 if the pose is none that was sent.
inline int number_within(const PoseTolerance& tolerance, const PoseSample& sample) {
  const double number = std::round((sample.position_m[0] - 0.2) / 0.0001);
  const double half_rad = number / 2000.0;
  const auto is_close = [](double value, double truth, double most) {
    return std::abs(value - truth) <= most;
  };
  const auto& [x, y, z] = sample.position_m;
  const auto& [qx, qy, qz, qw] = sample.turn_xyzw;
  const bool good = number >= 0.0 && is_close(x, 0.2 + 0.0001 * number, tolerance.position_m) &&
                    is_close(y, 0.1 * sample.station, tolerance.position_m) &&
                    is_close(z, -0.3, tolerance.position_m) && qx == 0.0 && qy == 0.0 &&
                    is_close(qz, std::sin(half_rad), tolerance.quaternion) &&
                    is_close(qw, std::cos(half_rad), tolerance.quaternion);
  return good ? static_cast<int>(number) : -1;
}

inline int number_of(const PoseSample& sample) {
  return number_within({}, sample);
}

/// A tracker whose stations measure one after the other.
struct SharedRate {
  double records_per_second = 0.0; ///< all stations together
  std::uint64_t longest_record = 0;
  int (*number)(const PoseSample& sample) = number_of;
};

/// What arrived at some stations.
struct NumberedPoses {
  std::size_t wrong = 0;
  std::size_t lost = 0;
  std::size_t count = 0;
  std::uint64_t records = 0; ///< also those of other stations
  double rate_hz = 0.0;      ///< the worst station's
};

inline NumberedPoses look_at(std::vector<std::unique_ptr<PoseRing>>& rings,
                             const SharedRate& shared) {
  NumberedPoses heard;
  const double nominal_hz = shared.records_per_second / static_cast<double>(rings.size());
  heard.rate_hz = nominal_hz;
  for (const auto& ring : rings) {
    int last = -1;
    std::vector<HostTime> arrivals;
    ring->drain([&](const PoseSample& sample) {
      const int number = shared.number(sample);
      if (number < 0) ++heard.wrong;
      if (last >= 0) heard.lost += static_cast<std::size_t>((number - last + 999) % 1000);
      last = number;
      arrivals.push_back(sample.arrival);
    });
    heard.count += arrivals.size();
    REQUIRE(arrivals.size() > 10);
    const double seconds = to_seconds(arrivals.back() - arrivals.front());
    const double rate_hz = static_cast<double>(arrivals.size() - 1) / seconds;
    if (std::abs(rate_hz - nominal_hz) > std::abs(heard.rate_hz - nominal_hz))
      heard.rate_hz = rate_hz;
  }
  return heard;
}

/// Streams these stations of one tracker for that time, and checks its counts.
inline NumberedPoses stream_numbered(const std::vector<std::string>& specs,
                                     std::chrono::milliseconds time, const SharedRate& shared) {
  std::vector<std::unique_ptr<PoseRing>> rings;
  std::vector<PoseRing*> pointers;
  for (std::size_t k = 0; k < specs.size(); ++k)
    pointers.push_back(rings.emplace_back(std::make_unique<PoseRing>(1U << 12U)).get());
  const auto stations = required(driver::open_trackers(specs));
  require_ok(driver::start_trackers(stations, pointers));
  std::this_thread::sleep_for(time);
  stations.front().tracker->stop();
  const driver::StreamStats stats = stations.front().tracker->stats();
  NumberedPoses heard = look_at(rings, shared);
  heard.records = stats.records;
  CHECK(stats.bad_records == 0);
  CHECK(stats.ring_refused == 0);
  CHECK(stats.records >= heard.count);
  check_tracker_conservation(stats, shared.longest_record);
  return heard;
}

/// Checks that each of these choices of stations gets its share of the records, and that none is
/// lost or wrong.
inline void stations_share_the_rate(const TrackerKind& kind, const SharedRate& shared,
                                    const std::vector<std::vector<int>>& choices) {
  for (const std::vector<int>& stations : choices) {
    CAPTURE(stations.size());
    const double nominal_hz = shared.records_per_second / static_cast<double>(stations.size());
    const auto port = kind.plug();
    NumberedPoses heard;
    for (int tries = 0; tries < 3; ++tries) { // the machine may be busy
      heard = stream_numbered(kind.specs(port->path(), stations), 4s, shared);
      if (std::abs(heard.rate_hz / nominal_hz - 1.0) <= 0.01) break;
    }
    CHECK(heard.rate_hz == doctest::Approx(nominal_hz).epsilon(0.01));
    CHECK(heard.wrong == 0);
    CHECK(heard.lost == 0);
    CHECK(heard.records == heard.count);
  }
}

/// The delay of a pose on its way, for a device that sends several records at once (`--burst 4`).
struct PoseDelays {
  double last_ms = 0.0;  ///< from the measurement of the last record to its arrival
  double cycle_ms = 0.0; ///< between measurements
};

/// Checks that the times of poses exclude the line, the solution and the records that came with
/// them.
inline void times_exclude_what_delays(const TrackerKind& kind, const PoseDelays& delays) {
  const auto port = kind.plug({"--burst", "4"});
  OneStation hand(kind.spec(port->path()));
  require_ok(hand.start());
  REQUIRE(eventually([&] { return hand.ring.size() >= 40; }));
  hand.tracker().stop();
  std::vector<PoseSample> samples;
  hand.ring.drain([&](const PoseSample& sample) { samples.push_back(sample); });
  int pairs = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const bool is_last = k + 1 == samples.size() || samples[k + 1].arrival != samples[k].arrival;
    const double delay_ms = to_milliseconds(samples[k].arrival - samples[k].measured);
    if (is_last) CHECK(delay_ms == doctest::Approx(delays.last_ms).epsilon(0.001));
    if (samples[k].arrival != samples[k - 1].arrival) continue;
    ++pairs;
    const auto step = samples[k].measured - samples[k - 1].measured;
    CHECK(to_milliseconds(step) <= delays.cycle_ms + 0.001);
  }
  CHECK(pairs > 20);
}

} // namespace nendo::test
