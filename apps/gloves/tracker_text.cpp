#include "gloves/tracker_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <nendo/base/units.hpp>

#include "cli/cli.hpp"

namespace nendo::gloves {

using nlohmann::ordered_json;

TurnAngles angles_of(const std::array<double, 4>& turn_xyzw) noexcept {
  const Eigen::Matrix3d turn = Eigen::Quaterniond(turn_xyzw.data()).normalized().matrix();
  // 0.0 - x, so that zero has no sign.
  return {to_degrees(std::atan2(turn(1, 0), turn(0, 0))),
          to_degrees(std::asin(std::clamp(0.0 - turn(2, 0), -1.0, 1.0))),
          to_degrees(std::atan2(turn(2, 1), turn(2, 2)))};
}

std::string pose_json(const std::string& source, const PoseSample& pose) {
  const HostTime came = pose.is_replayed ? pose.recorded_arrival : pose.arrival;
  const HostTime taken = pose.is_replayed ? pose.recorded_measured : pose.measured;
  const TurnAngles angles = angles_of(pose.turn_xyzw);
  ordered_json line{{"time_s", to_seconds(came.time_since_epoch())},
                    {"measured_s", to_seconds(taken.time_since_epoch())},
                    {"sequence", pose.sequence},
                    {"source", source},
                    {"station", pose.station},
                    {"position_m", pose.position_m},
                    {"turn_xyzw", pose.turn_xyzw},
                    {"azimuth_deg", angles.azimuth_deg},
                    {"elevation_deg", angles.elevation_deg},
                    {"roll_deg", angles.roll_deg},
                    {"error", nullptr}};
  if (pose.error != ' ') line["error"] = std::string(1, pose.error);
  if (pose.is_replayed) line["replayed_s"] = to_seconds(pose.arrival.time_since_epoch());
  if (pose.has_device_time) line["device_time_s"] = to_seconds(pose.device_time);
  return cli::json_text(line);
}

ordered_json tracker_json(const driver::TrackerInfo& info) {
  ordered_json facts = ordered_json::object();
  for (const auto& [name, value] : info.facts)
    facts[name] = value;
  return {{"source", info.source},        {"model", info.model},
          {"stations", info.stations},    {"rate_hz", info.rate_hz},
          {"filtered", info.is_filtered}, {"stage_from_tracker_xyzw", info.stage_from_tracker_xyzw},
          {"facts", std::move(facts)}};
}

std::string axes_text(const driver::TrackerInfo& info) {
  constexpr std::array<std::array<const char*, 2>, 3> directions{
      {{"to the left", "to the right"},
       {"down", "up"},
       {"away from the operator", "towards the operator"}}};
  const auto& turn = info.stage_from_tracker_xyzw;
  const Eigen::Matrix3d stage = Eigen::Quaterniond(turn.data()).normalized().matrix();
  std::string text;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Index along = 0;
    if (!(stage.col(axis).cwiseAbs().maxCoeff(&along) > 0.999)) {
      char oblique[96];
      std::snprintf(oblique, sizeof oblique,
                    "turned by the quaternion (x y z w) %.4f %.4f %.4f %.4f", turn[0], turn[1],
                    turn[2], turn[3]);
      return oblique;
    }
    const char* const direction =
        directions[static_cast<std::size_t>(along)][stage(along, axis) > 0.0 ? 1 : 0];
    text += std::string(axis > 0 ? ", " : "") + "xyz"[axis] + " " + direction;
  }
  return text;
}

std::string no_pose_advice(const driver::TrackerStation& station) {
  struct Advice {
    std::string_view kind;
    const char* words;
  };
  constexpr std::array advices{
      Advice{"osc", "check that the sender sends the poses of this hand to this port, from this "
                    "machine or to the address that osc:ADDRESS:PORT names"},
      Advice{"vrpn", "check that the server tracks this sensor, or name another one"},
      Advice{"evdev", "plug the device in again"},
      Advice{"serve", "check that `nendo serve` still gets poses of this tracker"},
      Advice{"replay", "check that the recording does not begin with a pause"}};
  const auto spec = driver::parse_device_spec(station.source);
  const std::string_view kind = spec ? std::string_view(spec->kind) : std::string_view{};
  const auto* const found = std::ranges::find(advices, kind, &Advice::kind);
  if (found != advices.end()) return found->words;
  return "check that the receiver of station " + std::to_string(station.station) +
         " is plugged in, and near the transmitter, or name another station";
}

} // namespace nendo::gloves
