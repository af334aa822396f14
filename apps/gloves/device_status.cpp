#include "gloves/device_status.hpp"

#include <algorithm>
#include <optional>

#include <nendo/base/text.hpp>

#include "gloves/screen_text.hpp"

namespace nendo::gloves {
namespace {

/// Returns how long before `now` something came; nothing if it never came.
std::optional<double> age_s(HostTime arrival, HostTime now) {
  if (arrival == HostTime{}) return std::nullopt;
  return seconds_between(arrival, now);
}

std::string title_of(Side side, std::string_view device, const std::string& source,
                     const std::string& model) {
  return std::string(name_of(side)) + " " + std::string(device) + ": " +
         printable(source + ": " + model);
}

DeviceStatus glove_status(const OpenHand& hand, const flow::HandFrame& frame, HostTime now) {
  const driver::GloveInfo& info = hand.glove->info();
  const StreamState stream{hand.glove->stats(), info.rate_hz, age_s(frame.newest_sample, now)};
  return {title_of(hand.side, "glove", info.source, info.model) +
              (hand.uncalibrated ? ", uncalibrated" : ""),
          stream_text(stream)};
}

/// The counts of records are those of all stations together.
DeviceStatus station_status(const OpenHand& hand, const flow::HandFrame& frame, double rate_hz,
                            HostTime now) {
  const driver::TrackerStation& station = hand.wrist->station;
  const driver::TrackerInfo& info = station.tracker->info();
  StreamState stream{station.tracker->stats(), 0.0, age_s(frame.newest_pose, now), "no pose yet"};
  stream.stats.rate_hz = rate_hz;
  stream.asked_hz =
      info.rate_hz / static_cast<double>(std::max<std::size_t>(info.stations.size(), 1));
  DeviceStatus status{title_of(hand.side, "wrist", station.source, info.model),
                      stream_text(stream)};
  const std::uint64_t refused = frame.pose_counts.refused;
  if (refused > 0)
    status.state += ", " + std::to_string(refused) + (refused == 1 ? " pose" : " poses") +
                    " refused by the gate";
  if (frame.tracked && frame.lost) status.state = "lost; " + status.state;
  return status;
}

} // namespace

DeviceStatuses DeviceWatch::look(std::span<const OpenHand> hands, const flow::Frame& frame,
                                 HostTime now) {
  DeviceStatuses statuses;
  for (const OpenHand& hand : hands) {
    const std::size_t slot = flow::Placement::index_of(hand.side);
    const flow::HandFrame& shown = frame.hands[slot];
    statuses[slot].push_back(glove_status(hand, shown, now));
    if (!hand.wrist) continue;
    const hand::TrackingCounts& poses = shown.pose_counts;
    if (shown.newest_pose != HostTime{})
      pose_rates_[slot].add(poses.poses - poses.refused, shown.newest_pose);
    statuses[slot].push_back(station_status(hand, shown, pose_rates_[slot].per_s(), now));
  }
  for (const Side side : {Side::left, Side::right}) {
    const std::size_t slot = flow::Placement::index_of(side);
    if (frame.hands[slot].present && statuses[slot].empty())
      statuses[slot].push_back({std::string(name_of(side)) + " glove: the recording", ""});
  }
  return statuses;
}

} // namespace nendo::gloves
