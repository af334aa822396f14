#include <nendo/recording/replay_driver.hpp>

#include <algorithm>
#include <utility>
#include <vector>

#include <nendo/driver/glove_options.hpp>
#include <nendo/recording/setup.hpp>

#include "replay_stream.hpp"

namespace nendo::recording {
namespace {

/// The station of the only tracked hand of a recording.
constexpr std::uint16_t only_station = 0;
constexpr std::uint16_t station_of(Side side) noexcept {
  return side == Side::left ? 1 : 2;
}

class ReplayedTracker final : public driver::Tracker {
public:
  ReplayedTracker(const ReplayOptions& options, driver::TrackerInfo info,
                  OpenSource<PoseSample> open)
      : info_(std::move(info)), stream_(options, info_.rate_hz, std::move(open)) {}
  ~ReplayedTracker() override { ReplayedTracker::stop(); }

  const driver::TrackerInfo& info() const noexcept override { return info_; }
  Result<void> start(std::span<const driver::StationRing> rings) override {
    if (!stream_.is_running()) rings_.assign(rings.begin(), rings.end());
    return stream_.start(info_.source, [this](const PoseSample& pose) {
      bool taken = true;
      for (const driver::StationRing& station : rings_)
        if (station.station == pose.station) taken = station.ring->try_push(pose) && taken;
      return taken;
    });
  }
  void stop() noexcept override { stream_.stop(); }
  driver::StreamStats stats() const noexcept override { return stream_.stats(); }
  bool has_ended() const noexcept override { return stream_.has_ended(); }

private:
  driver::TrackerInfo info_;
  std::vector<driver::StationRing> rings_;
  ReplayStream<PoseSample> stream_;
};

Result<std::uint16_t> take_hand(driver::DeviceSpec& spec) {
  const auto hand = driver::hand_option(spec);
  if (!hand) return hand.error();
  spec.options.erase("hand");
  return *hand ? station_of(**hand) : only_station;
}

/// Reads the trackers of a recording, whose descriptions come before the poses.
Result<std::vector<RecordedTracker>> trackers_of(const driver::DeviceSpec& spec) {
  auto reader = ChunkReader::open(spec.target);
  if (!reader) return reader.error();
  Setup setup;
  while (const auto chunk = reader->next()) {
    if (chunk->type == log_chunk) break;
    read_setup_chunk(chunk->type, chunk->payload, setup); // damaged chunks are as good as none
  }
  if (setup.trackers.empty())
    return replay_error(spec, Errc::bad_input,
                        "no tracker moved a hand in this recording, or its description is damaged");
  return std::move(setup.trackers);
}

Result<void> check_stations(const driver::DeviceSpec& spec,
                            const std::vector<RecordedTracker>& trackers,
                            std::span<const std::uint16_t> stations) {
  for (const std::uint16_t station : stations) {
    if (station == only_station) {
      if (trackers.size() == 1) continue;
      return replay_error(spec, Errc::usage,
                          "both hands were tracked; add ?hand=left or ?hand=right");
    }
    if (std::ranges::none_of(trackers,
                             [&](const auto& one) { return station_of(one.side) == station; }))
      return replay_error(spec, Errc::no_device,
                          "no tracker moved the " +
                              std::string(name_of(station == 1 ? Side::left : Side::right)) +
                              " hand; leave hand= out, or choose the other");
  }
  return {};
}

Result<std::unique_ptr<driver::Tracker>> open_replay(const driver::DeviceSpec& spec,
                                                     std::span<const std::uint16_t> stations) {
  if (const auto fine = driver::allow_options(spec, {"speed", "loop", "end"}); !fine)
    return fine.error();
  if (spec.target.empty())
    return replay_error(spec, Errc::usage, "name the recording, e.g. replay:take1.nendo");
  const auto options = replay_options(spec);
  if (!options) return options.error();
  const auto trackers = trackers_of(spec);
  if (!trackers) return trackers.error();
  if (const auto fine = check_stations(spec, *trackers, stations); !fine) return fine.error();
  driver::TrackerInfo info = trackers->front().info;
  info.facts.push_back({"recorded_from", info.source});
  info.kind = driver::SourceKind::recorded;
  info.source = spec.text;
  info.stations.assign(stations.begin(), stations.end());
  info.rate_hz *= options->speed;
  const bool has_one = std::ranges::find(stations, only_station) != stations.end();
  const OpenSource<PoseSample> open = [path = spec.target,
                                       has_one]() -> std::unique_ptr<SampleSource<PoseSample>> {
    auto again = ChunkReader::open(path);
    if (!again) return nullptr;
    return std::make_unique<RecordedSource<PoseSample>>(
        *std::move(again),
        [has_one,
         number = std::uint64_t{0}](const LogEntry& entry) mutable -> std::optional<PoseSample> {
          auto recorded = pose_of(entry);
          if (!recorded) return std::nullopt;
          recorded->pose.station = has_one ? only_station : station_of(recorded->side);
          // A tracker numbers the poses of all stations together, and a recording has those of one
          // hand after those of the other: the gaps in their numbers are no losses.
          recorded->pose.sequence = number++;
          return recorded->pose;
        });
  };
  if (const auto source = open(); source == nullptr || !source->next())
    return replay_error(spec, Errc::bad_input, "holds no pose of a tracker");
  return std::unique_ptr<driver::Tracker>(
      std::make_unique<ReplayedTracker>(*options, std::move(info), open));
}

} // namespace

driver::TrackerDriver replay_tracker_driver() noexcept {
  return {"replay", "replay:FILE[?hand=left|right&speed=X&loop=yes|end=hold]",
          "a tracker as `nendo run --record` recorded it", take_hand, open_replay};
}

} // namespace nendo::recording
