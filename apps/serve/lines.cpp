#include "serve/lines.hpp"

#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <nendo/base/units.hpp>
#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/joints.hpp>
#include <nendo/version.hpp>

#include "cli/cli.hpp"
#include "gloves/glove_json.hpp"
#include "gloves/tracker_text.hpp"

namespace nendo::serve {
namespace {

using nlohmann::ordered_json;

std::int64_t nanoseconds(std::chrono::nanoseconds time) noexcept {
  return time.count();
}
std::int64_t nanoseconds(HostTime time) noexcept {
  return nanoseconds(time.time_since_epoch());
}

std::string_view name_of_kind(driver::SourceKind kind) noexcept {
  return driver::source_kind_names[static_cast<std::size_t>(kind)];
}

/// Adds the members of `more` after those of `object`.
ordered_json joined(ordered_json object, const ordered_json& more) {
  for (const auto& [key, value] : more.items())
    object[key] = value;
  return object;
}

/// What samples and poses have in common.
template <class Sample>
void add_times(ordered_json& line, const Sample& sample) {
  line["sequence"] = sample.sequence;
  line["arrival_ns"] = nanoseconds(sample.arrival);
  line["measured_ns"] = nanoseconds(sample.measured);
  if (sample.has_device_time) line["device_time_ns"] = nanoseconds(sample.device_time);
}

template <class Sample>
void add_recorded_times(ordered_json& line, const Sample& sample) {
  if (!sample.is_replayed) return;
  line["recorded_arrival_ns"] = nanoseconds(sample.recorded_arrival);
  line["recorded_measured_ns"] = nanoseconds(sample.recorded_measured);
}

/// A letter that a device sent may be any byte.
ordered_json error_json(char letter) {
  if (letter == ' ') return nullptr;
  return std::string(1, letter > ' ' && letter <= '~' ? letter : '?');
}

ordered_json pinches_json(const hand::HandPose& pose) {
  ordered_json distances = ordered_json::object();
  const Eigen::Vector3d thumb = pose[hand::Joint::thumb_tip].translation();
  for (std::size_t finger = 1; finger < hand::finger_count; ++finger)
    distances[std::string(name_of(static_cast<hand::Finger>(finger)))] =
        (pose[hand::fingertips[finger]].translation() - thumb).norm();
  return distances;
}

ordered_json hand_json(const flow::HandFrame& hand, Side side) {
  const hand::AngleSources sources = hand::angle_sources(hand.sensors, hand.left_out);
  ordered_json angles = ordered_json::object();
  ordered_json measured = ordered_json::array();
  for (std::size_t at = 0; at < hand::angle_count; ++at) {
    angles[std::string(hand::angle_names[at])] = hand.angles[hand::angle_at(at)];
    if (sources[at] == hand::AngleSource::measured) measured.push_back(hand::angle_names[at]);
  }
  ordered_json line{{"side", name_of(side)},
                    {"samples", hand.samples},
                    {"sampled_ns", nanoseconds(hand.sampled)},
                    {"silent", hand.silent},
                    {"switch", gloves::switch_json(hand.wrist_switch)},
                    {"tracked", hand.tracked},
                    {"lost", hand.lost},
                    {"tracked_ns", nullptr},
                    {"joints", gloves::joints_json(hand.pose)},
                    {"angles_rad", std::move(angles)},
                    {"measured", std::move(measured)},
                    {"pinch_m", pinches_json(hand.pose)}};
  if (hand.tracked_at != HostTime{}) line["tracked_ns"] = nanoseconds(hand.tracked_at);
  return line;
}

} // namespace

std::string version_line(std::string_view name) {
  return cli::json_text({{"class", "VERSION"},
                         {"protocol", protocol_number},
                         {"version", NENDO_VERSION},
                         {"name", name}});
}

std::string glove_line(const ServedGlove& glove, std::size_t index) {
  ordered_json line = joined({{"class", "GLOVE"}, {"index", index}, {"side", name_of(glove.side)}},
                             gloves::glove_json(glove.info));
  line["kind"] = name_of_kind(glove.info.kind);
  if (glove.info.kind == driver::SourceKind::recorded) { // clients have other folders
    std::error_code failed;
    const auto path = std::filesystem::absolute(glove.info.recording, failed);
    line["recording"] = failed ? glove.info.recording : path.string();
  }
  return cli::json_text(line);
}

std::string tracker_line(const ServedTracker& tracker, std::size_t index) {
  ordered_json line = joined({{"class", "TRACKER"},
                              {"index", index},
                              {"side", name_of(tracker.side)},
                              {"station", tracker.station}},
                             gloves::tracker_json(tracker.info));
  line["kind"] = name_of_kind(tracker.info.kind);
  return cli::json_text(line);
}

std::string watch_line(const Watch& watch) {
  return cli::json_text({{"class", "WATCH"},
                         {"samples", watch.samples},
                         {"hands", watch.hands},
                         {"rate_hz", watch.rate_hz}});
}

std::string error_line(std::string_view message) {
  return cli::json_text({{"class", "ERROR"}, {"message", message}});
}

std::string sample_line(const GloveSample& sample, std::size_t glove) {
  ordered_json raw = ordered_json::object();
  for (const Sensor sensor : sample.present)
    raw[std::string(name_of(sensor))] = sample[sensor].value;
  ordered_json line{{"class", "SAMPLE"}, {"glove", glove}};
  add_times(line, sample);
  line["hand"] = name_of(sample.side);
  line["switch"] = gloves::switch_json(sample.wrist_switch);
  line["raw"] = std::move(raw);
  line["sampled_too_fast"] = sample.sampled_too_fast;
  add_recorded_times(line, sample);
  return cli::json_text(line);
}

std::string pose_line(const PoseSample& pose, std::size_t tracker) {
  ordered_json line{{"class", "POSE"}, {"tracker", tracker}};
  add_times(line, pose);
  line["station"] = pose.station;
  line["position_m"] = pose.position_m;
  line["turn_xyzw"] = pose.turn_xyzw;
  line["error"] = error_json(pose.error);
  add_recorded_times(line, pose);
  return cli::json_text(line);
}

std::string hands_line(const HandsFrame& frame) {
  ordered_json hands = ordered_json::array();
  for (const Side side : {Side::left, Side::right}) {
    const flow::HandFrame& hand = frame.hands[flow::Placement::index_of(side)];
    if (hand.present) hands.push_back(hand_json(hand, side));
  }
  return cli::json_text({{"class", "HANDS"},
                         {"tick", frame.tick},
                         {"time_ns", nanoseconds(frame.woke)},
                         {"hands", std::move(hands)}});
}

std::string with_count(std::string_view object, std::string_view key, std::uint64_t count) {
  object.remove_suffix(1); // the bracket
  std::string line(object);
  line.append(",\"").append(key).append("\":").append(std::to_string(count)).append("}\n");
  return line;
}

} // namespace nendo::serve
