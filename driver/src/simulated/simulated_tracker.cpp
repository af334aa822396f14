#include <algorithm>
#include <array>
#include <atomic>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/number_in.hpp>
#include <nendo/driver/reader_thread.hpp>

#include "drivers.hpp"
#include "simulated/wrist_motion.hpp"

namespace nendo::driver {
namespace {

struct TrackerOptions {
  WristMotion motion = WristMotion::orbit;
  std::uint32_t seed = 1;
  double rate_hz = 120.0; ///< the rate of each station
};

class SimulatedTracker final : public Tracker {
public:
  SimulatedTracker(const DeviceSpec& spec, const TrackerOptions& options,
                   std::span<const std::uint16_t> stations)
      : options_(options), period_(from_seconds(1.0 / options.rate_hz)) {
    info_.kind = SourceKind::simulated;
    info_.source = spec.text;
    info_.model = "simulated tracker, motion " + (spec.target.empty() ? "orbit" : spec.target);
    info_.stations.assign(stations.begin(), stations.end());
    info_.rate_hz = options.rate_hz * static_cast<double>(stations.size());
    info_.stage_from_tracker_xyzw = stage_from_z_down_xyzw;
  }
  ~SimulatedTracker() override { SimulatedTracker::stop(); }

  const TrackerInfo& info() const noexcept override { return info_; }
  Result<void> start(std::span<const StationRing> rings) override {
    if (!reader_.is_running()) rings_.assign(rings.begin(), rings.end());
    return reader_.start(info_.source, [this](const std::stop_token& stop) {
      records_ = ring_refused_ = 0;
      read(stop);
    });
  }
  void stop() noexcept override { reader_.stop(); }
  StreamStats stats() const noexcept override {
    StreamStats stats;
    stats.records = records_.load(std::memory_order_relaxed);
    stats.ring_refused = ring_refused_.load(std::memory_order_relaxed);
    stats.rate_hz = info_.rate_hz;
    stats.counts_missed = true; // there is no line on which records get lost
    return stats;
  }

private:
  void read(const std::stop_token& stop) {
    begin_ = HostClock::now();
    for (std::int64_t tick = 0; reader_.wait_until(stop, begin_ + tick * period_); ++tick) {
      tick = std::max(tick, (HostClock::now() - begin_) / period_);
      for (const std::uint16_t station : info_.stations)
        deliver(station, tick * period_);
    }
  }

  void deliver(std::uint16_t station, HostClock::duration elapsed) noexcept {
    const auto pose = receiver_pose(options_.motion, station, options_.seed, to_seconds(elapsed));
    PoseSample sample;
    sample.station = station;
    sample.position_m = pose.position_m;
    sample.turn_xyzw = pose.turn_xyzw;
    sample.sequence = records_.fetch_add(1, std::memory_order_relaxed);
    sample.has_device_time = true;
    sample.device_time = elapsed;
    sample.measured = begin_ + elapsed;
    sample.arrival = HostClock::now();
    for (const StationRing& ring : rings_)
      if (ring.station == station && !ring.ring->try_push(sample))
        ring_refused_.fetch_add(1, std::memory_order_relaxed);
  }

  TrackerInfo info_;
  const TrackerOptions options_;
  const HostClock::duration period_;
  std::vector<StationRing> rings_;
  HostTime begin_; ///< used by the reader thread only
  std::atomic<std::uint64_t> records_{0};
  std::atomic<std::uint64_t> ring_refused_{0};
  ReaderThread reader_; // last: joined before what it uses is gone
};

Error bad_option(const DeviceSpec& spec, const std::string& key, std::string_view allowed) {
  return {Errc::usage, spec.text + ": option " + key + " must be " + std::string(allowed)};
}

} // namespace

Result<std::unique_ptr<Tracker>> open_simulated_tracker(const DeviceSpec& spec,
                                                        std::span<const std::uint16_t> stations) {
  TrackerOptions options;
  if (const auto known = allow_options(spec, {"station", "rate", "seed"}); !known)
    return known.error();
  const auto motion = find_wrist_motion(spec.target.empty() ? "orbit" : spec.target);
  if (!motion) return Error{Errc::usage, spec.text + ": " + motion.error().message};
  options.motion = *motion;
  for (const auto& [key, value] : spec.options) {
    if (key == "seed") {
      const auto seed = number_in<std::uint32_t>(value);
      if (!seed) return bad_option(spec, key, "a whole number from 0 to 4294967295");
      options.seed = *seed;
    } else if (key == "rate") {
      const auto rate_hz = number_in<double>(value);
      if (!rate_hz || !(*rate_hz >= 1.0 && *rate_hz <= 1000.0))
        return bad_option(spec, key, "a number from 1 to 1000 (hertz)");
      options.rate_hz = *rate_hz;
    }
  }
  return std::unique_ptr<Tracker>(std::make_unique<SimulatedTracker>(spec, options, stations));
}

} // namespace nendo::driver
