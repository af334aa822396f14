#include "gloves/pose_output.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include <nendo/hand/angle_deviations.hpp>
#include <nendo/hand/bvh_file.hpp>

#include "cli/json_line.hpp"
#include "gloves/glove_json.hpp"

namespace nendo::gloves {
namespace {

// A rate that the machine cannot keep up with must not fill its memory.
constexpr std::size_t max_pending_bytes = 1 << 16;
constexpr std::uint64_t max_pending_frames = 64;

/// Of the estimated angles alone.
nlohmann::ordered_json deviations_json(const hand::JointAngles& angles, SensorMask sensors,
                                       SensorMask left_out) {
  const hand::AngleSources sources = hand::angle_sources(sensors, left_out);
  const hand::AngleDeviations deviations = hand::angle_deviations(angles, sensors, left_out);
  nlohmann::ordered_json by_angle;
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    if (hand::is_estimated(sources[at]))
      by_angle[std::string(hand::angle_names[at])] =
          std::round(10.0 * to_degrees(deviations[at])) / 10.0;
  return by_angle;
}

/// Returns the line of a pose without a line end, with the key angles if it is a glove's first.
std::string pose_json(HostTime time, Side side, const hand::HandPose& pose,
                      const hand::JointAngles& angles, SensorMask sensors, SensorMask left_out,
                      bool is_first) {
  nlohmann::ordered_json joints = nlohmann::ordered_json::object();
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
  nlohmann::ordered_json line{{"time_s", to_seconds(time.time_since_epoch())},
                              {"hand", name_of(side)},
                              {"joints", std::move(joints)}};
  if (auto deviations = deviations_json(angles, sensors, left_out); !deviations.empty())
    line["deviations_deg"] = std::move(deviations);
  if (left_out.bits != 0) line["left_out"] = sensors_json(left_out);
  if (is_first) line["angles"] = angle_sources_json(sensors, left_out);
  return cli::json_text(line);
}

class JsonLines final : public PoseOutput {
public:
  std::optional<Side> only_side() const override { return std::nullopt; }
  Result<void> put(HostTime time, Side side, const hand::HandPose& pose,
                   const hand::JointAngles& angles, SensorMask sensors,
                   SensorMask left_out) override {
    const bool first = gloves_.is_first(side, sensors, left_out);
    lines_ += pose_json(time, side, pose, angles, sensors, left_out, first);
    lines_ += '\n';
    return lines_.size() < max_pending_bytes ? Result<void>() : flush();
  }
  Result<void> flush() override {
    std::cout << lines_ << std::flush; // what cannot be written ends the program by itself
    lines_.clear();
    return {};
  }
  Result<void> finish() override { return flush(); }

private:
  std::string lines_;
  GloveChanges gloves_;
};

class BvhRecording final : public PoseOutput {
public:
  BvhRecording(hand::BvhFile file, std::string path, Side side)
      : file_(std::move(file)), path_(std::move(path)), side_(side) {}

  std::optional<Side> only_side() const override { return side_; }
  Result<void> put(HostTime, Side, const hand::HandPose& pose, const hand::JointAngles&, SensorMask,
                   SensorMask) override {
    if (auto added = file_.add(pose); !added) return added;
    return ++put_ % max_pending_frames != 0 ? Result<void>() : flush();
  }
  Result<void> flush() override { return file_.flush(); }
  Result<void> finish() override {
    if (auto finished = file_.finish(); !finished) return finished;
    std::cout << path_ << ": " << file_.frames() << " poses of a " << name_of(side_) << " hand"
              << std::endl;
    return {};
  }

private:
  hand::BvhFile file_;
  std::string path_;
  Side side_;
  std::uint64_t put_ = 0;
};

} // namespace

std::unique_ptr<PoseOutput> json_pose_output() {
  return std::make_unique<JsonLines>();
}

Result<std::unique_ptr<PoseOutput>>
bvh_pose_output(const std::string& path, const hand::HandSkeleton& skeleton, double rate_hz) {
  auto file = hand::BvhFile::create(path, skeleton, rate_hz);
  if (!file) return file.error();
  return std::unique_ptr<PoseOutput>(
      std::make_unique<BvhRecording>(*std::move(file), path, skeleton.side()));
}

} // namespace nendo::gloves
