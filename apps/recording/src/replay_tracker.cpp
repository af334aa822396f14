#include <nendo/recording/replay_driver.hpp>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <nendo/driver/glove_options.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/recording/setup.hpp>

#include "replay_stream.hpp"

namespace nendo::recording {
namespace {

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

/// Reads the trackers of a recording, whose descriptions come before the poses: one or two.
Result<std::vector<RecordedTracker>> trackers_of(const driver::DeviceSpec& spec) {
  if (spec.target.empty())
    return replay_error(spec, Errc::usage, "name the recording, e.g. replay:take1.nendo");
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

/// Returns the station of a tracked hand: the recorded one, or, if two trackers had stations of the
/// same number, 1 for the left hand and 2 for the right one.
std::uint16_t station_of(Side side, const std::vector<RecordedTracker>& trackers) {
  const auto found = std::ranges::find(trackers, side, &RecordedTracker::side);
  const bool is_unique =
      std::ranges::count(trackers, found->station, &RecordedTracker::station) == 1;
  if (is_unique) return found->station;
  return side == Side::left ? 1 : 2;
}

Result<std::uint16_t> take_hand(driver::DeviceSpec& spec) {
  const auto hand = driver::hand_option(spec);
  if (!hand) return hand.error();
  const auto trackers = trackers_of(spec);
  if (!trackers) return trackers.error();
  if (!*hand && trackers->size() > 1)
    return replay_error(spec, Errc::usage,
                        "both hands were tracked; add ?hand=left or ?hand=right");
  const Side side = hand->value_or(trackers->front().side);
  const std::string name(name_of(side));
  if (std::ranges::find(*trackers, side, &RecordedTracker::side) == trackers->end())
    return replay_error(spec, Errc::no_device,
                        "no tracker moved the " + name +
                            " hand; leave hand= out, or choose the other");
  if (spec.options.erase("hand") == 0) spec.text = driver::with_option(spec.text, "hand=" + name);
  return station_of(side, *trackers);
}

/// Returns a function that opens the recorded poses of both hands.
OpenSource<PoseSample> pose_source(const std::string& path,
                                   const std::vector<RecordedTracker>& trackers) {
  std::array<std::uint16_t, 2> stations{};
  for (const RecordedTracker& tracker : trackers)
    stations[flow::Placement::index_of(tracker.side)] = station_of(tracker.side, trackers);
  return [path, stations]() -> std::unique_ptr<SampleSource<PoseSample>> {
    auto again = ChunkReader::open(path);
    if (!again) return nullptr;
    return std::make_unique<RecordedSource<PoseSample>>(
        *std::move(again),
        [stations,
         number = std::uint64_t{0}](const LogEntry& entry) mutable -> std::optional<PoseSample> {
          auto recorded = pose_of(entry);
          if (!recorded) return std::nullopt;
          recorded->pose.station = stations[flow::Placement::index_of(recorded->side)];
          // A tracker numbers the poses of all stations together, and a recording has those of one
          // hand after those of the other: the gaps in their numbers are no losses.
          recorded->pose.sequence = number++;
          return recorded->pose;
        });
  };
}

Result<std::unique_ptr<driver::Tracker>> open_replay(const driver::DeviceSpec& spec,
                                                     std::span<const std::uint16_t> stations) {
  if (const auto fine = driver::allow_options(spec, {"speed", "loop", "end"}); !fine)
    return fine.error();
  const auto options = replay_options(spec);
  if (!options) return options.error();
  const auto trackers = trackers_of(spec);
  if (!trackers) return trackers.error();
  const auto first = std::ranges::find_if(*trackers, [&](const RecordedTracker& tracker) {
    return station_of(tracker.side, *trackers) == stations.front();
  });
  if (first == trackers->end()) // the file was replaced meanwhile
    return replay_error(spec, Errc::no_device, "holds no pose of this hand");
  driver::TrackerInfo info = first->info;
  info.facts.push_back({"recorded_from", info.source});
  info.kind = driver::SourceKind::recorded;
  info.source = spec.text;
  info.stations.assign(stations.begin(), stations.end());
  info.rate_hz *= options->speed;
  const auto open = pose_source(spec.target, *trackers);
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
