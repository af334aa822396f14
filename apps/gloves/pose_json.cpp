#include "gloves/pose_json.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "cli/json_line.hpp"
#include "gloves/angle_sources_json.hpp"

namespace nendo::gloves {

using nlohmann::ordered_json;

std::string pose_json(HostTime time, Side side, const hand::HandPose& pose,
                      std::optional<SensorMask> sensors) {
  ordered_json joints = ordered_json::object();
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    const Eigen::Isometry3d& joint = pose.joints[at];
    const Eigen::Vector3d position = joint.translation();
    Eigen::Quaterniond q(joint.linear());
    q.normalize();
    if (q.w() < 0.0) q.coeffs() = -q.coeffs(); // both are the same turn
    joints[std::string(name_of(static_cast<hand::Joint>(at)))] = {
        {"position_m", {position.x(), position.y(), position.z()}},
        {"orientation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
  }
  ordered_json line{{"time_s", to_seconds(time.time_since_epoch())},
                    {"hand", name_of(side)},
                    {"joints", std::move(joints)}};
  if (sensors) line["angles"] = angle_sources_json(*sensors);
  return cli::json_text(line);
}

} // namespace nendo::gloves
