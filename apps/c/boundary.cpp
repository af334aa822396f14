#include "c/boundary.hpp"

#include <nendo/version.hpp>

namespace nendo::c {
namespace {

std::string& message() noexcept {
  static thread_local std::string text;
  return text;
}

} // namespace

int fail(Errc code, const char* text) noexcept {
  try {
    message() = text;
  } catch (const std::exception&) { // there is no memory for the message
    message().clear();
  }
  return static_cast<int>(code);
}

void write_pose(const hand::JointAngles& angles, const hand::HandPose& pose,
                nendo_hand& hand) noexcept {
  for (std::size_t at = 0; at < NENDO_ANGLES; ++at)
    hand.angles[at] = angles[hand::angle_at(at)];
  for (std::size_t at = 0; at < NENDO_JOINTS; ++at) {
    const Eigen::Isometry3d& joint = pose.joints[at];
    Eigen::Map<Eigen::Vector3f>(hand.joints[at].position) = joint.translation().cast<float>();
    Eigen::Map<Eigen::Vector4f>(hand.joints[at].orientation) =
        Eigen::Quaterniond(joint.linear()).coeffs().cast<float>();
  }
}

} // namespace nendo::c

extern "C" {

const char* nendo_version(void) {
  return NENDO_VERSION;
}

const char* nendo_message(void) {
  return nendo::c::message().c_str();
}
}
