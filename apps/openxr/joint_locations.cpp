#include "openxr/joint_locations.hpp"

#include <Eigen/Geometry>

#include "openxr/chain.hpp"

namespace nendo::openxr {
namespace {

constexpr XrSpaceLocationFlags valid_bits =
    XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
constexpr XrSpaceLocationFlags tracked_bits =
    XR_SPACE_LOCATION_POSITION_TRACKED_BIT | XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;
constexpr XrSpaceVelocityFlags velocity_bits =
    XR_SPACE_VELOCITY_LINEAR_VALID_BIT | XR_SPACE_VELOCITY_ANGULAR_VALID_BIT;

Eigen::Vector3d vector_of(const XrVector3f& v) noexcept {
  return Eigen::Vector3f(v.x, v.y, v.z).cast<double>();
}
XrVector3f xr(const Eigen::Vector3d& v) noexcept {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
XrQuaternionf xr(const Eigen::Quaterniond& q) noexcept {
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
          static_cast<float>(q.w())};
}

const XrHandJointVelocitiesEXT* velocities_of(const XrHandJointLocationsEXT& locations) noexcept {
  return in_chain<XrHandJointVelocitiesEXT>(static_cast<const void*>(locations.next),
                                            XR_TYPE_HAND_JOINT_VELOCITIES_EXT);
}

void set_velocities(const MovingHand& hand, const Eigen::Quaterniond& turn,
                    const XrSpaceVelocity& velocity,
                    const XrHandJointVelocitiesEXT& velocities) noexcept {
  if (!hand.has_velocity || (velocity.velocityFlags & velocity_bits) != velocity_bits) return;
  const Eigen::Vector3d linear = vector_of(velocity.linearVelocity);
  const Eigen::Vector3d angular = vector_of(velocity.angularVelocity);
  for (std::size_t k = 0; k < joint_count; ++k) {
    const Eigen::Vector3d arm = turn * hand.joints[k].position;
    const Eigen::Vector3d carried = linear + angular.cross(arm);
    velocities.jointVelocities[k] = {velocity_bits, xr(carried + turn * hand.linear_m_per_s[k]),
                                     xr(angular + turn * hand.angular_rad_per_s[k])};
  }
}

} // namespace

bool is_valid(const XrHandJointsLocateInfoEXT* info,
              const XrHandJointLocationsEXT* locations) noexcept {
  if (info == nullptr || info->type != XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT) return false;
  if (locations == nullptr || locations->type != XR_TYPE_HAND_JOINT_LOCATIONS_EXT) return false;
  if (locations->jointCount != joint_count || locations->jointLocations == nullptr) return false;
  const auto* const velocities = velocities_of(*locations);
  if (velocities != nullptr &&
      (velocities->jointCount != joint_count || velocities->jointVelocities == nullptr))
    return false;
  const auto* const range = in_chain<XrHandJointsMotionRangeInfoEXT>(
      info->next, XR_TYPE_HAND_JOINTS_MOTION_RANGE_INFO_EXT);
  return range == nullptr ||
         range->handJointsMotionRange == XR_HAND_JOINTS_MOTION_RANGE_UNOBSTRUCTED_EXT ||
         range->handJointsMotionRange == XR_HAND_JOINTS_MOTION_RANGE_CONFORMING_TO_CONTROLLER_EXT;
}

DataSourceState* source_state_of(XrHandJointLocationsEXT& locations) noexcept {
  return in_chain<DataSourceState>(locations.next, data_source_state_type);
}

void set_inactive(XrHandJointLocationsEXT& locations) noexcept {
  constexpr XrPosef nowhere{{0.0F, 0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, 0.0F}};
  locations.isActive = XR_FALSE;
  const auto* const velocities = velocities_of(locations);
  for (std::size_t k = 0; k < joint_count; ++k) {
    locations.jointLocations[k] = {0, nowhere, 0.0F};
    if (velocities != nullptr) velocities->jointVelocities[k] = {0, {}, {}};
  }
  if (DataSourceState* const state = source_state_of(locations)) {
    state->is_active = XR_FALSE;
    state->source = DataSource::unobstructed;
  }
}

void set_joints(const MovingHand& hand, const PublishedHand& published,
                const XrSpaceLocation& stage, const XrSpaceVelocity& velocity,
                XrHandJointLocationsEXT& locations) noexcept {
  if ((stage.locationFlags & valid_bits) != valid_bits) return;
  const XrQuaternionf& q = stage.pose.orientation;
  const Eigen::Quaterniond turn =
      Eigen::Quaternionf(q.w, q.x, q.y, q.z).cast<double>().normalized();
  const Eigen::Vector3d origin = vector_of(stage.pose.position);
  const XrSpaceLocationFlags flags =
      valid_bits | (published.is_silent ? 0 : stage.locationFlags & tracked_bits);
  locations.isActive = XR_TRUE;
  for (std::size_t k = 0; k < joint_count; ++k) {
    const JointPose& joint = hand.joints[k];
    locations.jointLocations[k] = {
        flags,
        {xr((turn * joint.orientation).normalized()), xr(origin + turn * joint.position)},
        published.radii_m[k]};
  }
  if (const auto* const velocities = velocities_of(locations))
    set_velocities(hand, turn, velocity, *velocities);
  if (DataSourceState* const state = source_state_of(locations)) state->is_active = XR_TRUE;
}

} // namespace nendo::openxr
