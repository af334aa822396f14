#include <nendo/hand/skeleton.hpp>

#include <cmath>
#include <numbers>

namespace nendo::hand {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

constexpr double degrees(double d) noexcept {
  return d * std::numbers::pi / 180.0;
}

Matrix3d turn_x(double angle_rad) {
  return AngleAxisd(angle_rad, Vector3d::UnitX()).matrix();
}
Matrix3d turn_y(double angle_rad) {
  return AngleAxisd(angle_rad, Vector3d::UnitY()).matrix();
}
Matrix3d turn_z(double angle_rad) {
  return AngleAxisd(angle_rad, Vector3d::UnitZ()).matrix();
}

// Proportions: B. Buchholz, T. J. Armstrong, S. A. Goldstein, "Anthropometric data for describing
// the kinematics of the human hand", Ergonomics 35(3), 1992, 261-273: lengths and axial places as
// fractions of the hand's length, places across the hand as fractions of its breadth. Right hand:
// the thumb is at -X.
struct FingerProportions {
  Joint metacarpal;
  double mcp_axial;    ///< wrist crease to MCP, of length
  double mcp_across;   ///< from the third metacarpal's axis towards the little finger, of breadth
  double mcp_dorsal;   ///< of length: the heads lie on a shallow arch
  double phalanges[3]; ///< proximal, middle, distal, of length
};
constexpr FingerProportions fingers[4] = {
    {Joint::index_metacarpal, 0.463, -0.251, 0.000, {0.245, 0.143, 0.097}},
    {Joint::middle_metacarpal, 0.446, 0.000, 0.010, {0.266, 0.170, 0.108}},
    {Joint::ring_metacarpal, 0.409, 0.206, 0.005, {0.244, 0.165, 0.107}},
    {Joint::little_metacarpal, 0.368, 0.402, -0.010, {0.204, 0.117, 0.093}},
};
constexpr double thumb_cmc_axial = 0.118;
constexpr double thumb_cmc_across = -0.196;
constexpr double thumb_cmc_dorsal = -0.030;
constexpr double thumb_bones[3] = {0.251, 0.196, 0.158};

// The second row of the carpus ends about where the thumb's CMC joint lies; there the metacarpals
// stand at half the distance that their heads have from one another.
constexpr double metacarpal_base_axial = 0.118;
constexpr double metacarpal_base_across = 0.5;

// At zero angles the thumb lies beside the index finger, its bones parting from it by the width of
// the web, and its nail turned towards the thumb's side: its flexion runs across the palm and not
// towards it.
constexpr double thumb_rest_abduction_rad = degrees(15);
constexpr double thumb_pronation_rad = degrees(60);

// The little finger's metacarpal moves most when the palm arches, the ring finger's about half as
// much; those of index and middle finger are fixed to the carpus.
constexpr double arch_share[4] = {0.0, 0.0, 0.5, 1.0};

// The rotation that takes -Z to `direction` by the shortest way; `direction` is not +Z. (Eigen's
// own takes an SVD for the case that cannot be.)
Matrix3d pointing(const Vector3d& direction) {
  const Vector3d axis = (-Vector3d::UnitZ()).cross(direction);
  const double angle_rad = std::atan2(axis.norm(), -direction.z());
  return angle_rad > 0.0 ? AngleAxisd(angle_rad, axis.normalized()).matrix() : Matrix3d::Identity();
}

} // namespace

Eigen::Matrix<double, 3, 5> HandPose::fingertip_positions() const noexcept {
  Eigen::Matrix<double, 3, 5> tips;
  for (std::size_t f = 0; f < finger_count; ++f) {
    tips.col(static_cast<Eigen::Index>(f)) = (*this)[fingertips[f]].translation();
  }
  return tips;
}

HandSkeleton::HandSkeleton(Side side, HandSize size) : side_(side) {
  offsets_m_.fill(Vector3d::Zero());
  const double length = size.length_m;
  const double breadth = size.breadth_m;
  const auto along = [](double metres) { return Vector3d(0.0, 0.0, -metres); };
  const auto set = [&](Joint joint, std::size_t steps, const Vector3d& offset) {
    offsets_m_[index_of(joint) + steps] = offset;
  };
  set(Joint::thumb_metacarpal, 0,
      {thumb_cmc_across * breadth, thumb_cmc_dorsal * length, -thumb_cmc_axial * length});
  for (std::size_t bone = 0; bone < 3; ++bone) {
    set(Joint::thumb_metacarpal, bone + 1, along(thumb_bones[bone] * length));
  }
  for (const auto& finger : fingers) {
    const Vector3d base(metacarpal_base_across * finger.mcp_across * breadth, 0.0,
                        -metacarpal_base_axial * length);
    const Vector3d head(finger.mcp_across * breadth, finger.mcp_dorsal * length,
                        -finger.mcp_axial * length);
    set(finger.metacarpal, 0, base);
    set(finger.metacarpal, 1, head - base);
    for (std::size_t bone = 0; bone < 3; ++bone) {
      set(finger.metacarpal, bone + 2, along(finger.phalanges[bone] * length));
    }
  }
  const auto& metacarpal = offsets_m_[index_of(Joint::middle_metacarpal)];
  set(Joint::palm, 0, metacarpal + 0.5 * offsets_m_[index_of(Joint::middle_proximal)]);
}

HandPose HandSkeleton::right_hand_pose(const JointAngles& angles) const noexcept {
  HandPose pose;
  // Puts `joint` at its rest offset in `frame`, turned by `rotation`.
  const auto place = [&](Joint joint, const Isometry3d& frame, const Matrix3d& rotation) {
    Isometry3d& placed = pose.joints[index_of(joint)];
    placed = frame * Translation3d(rest_offset(joint));
    placed.linear() = frame.linear() * rotation;
    return placed;
  };
  const auto next = [](Joint joint, std::size_t steps) {
    return static_cast<Joint>(index_of(joint) + steps);
  };

  Isometry3d wrist = Isometry3d::Identity();
  wrist.linear() = turn_y(angles.wrist_yaw_rad) * turn_x(-angles.wrist_pitch_rad);
  pose.joints[index_of(Joint::wrist)] = wrist;
  // The palm's -Z is the middle finger's metacarpal's, which rises a little from wrist to knuckle.
  place(Joint::palm, wrist, pointing(rest_offset(Joint::middle_proximal)));

  const Isometry3d thumb = place(Joint::thumb_metacarpal, wrist,
                                 turn_z(angles.thumb_roll_rad) *
                                     turn_y(thumb_rest_abduction_rad + angles.thumb_abduction_rad) *
                                     turn_z(thumb_pronation_rad));
  const Isometry3d thumb_mcp =
      place(Joint::thumb_proximal, thumb, turn_x(-angles.thumb_mcp_flexion_rad));
  const Isometry3d thumb_ip =
      place(Joint::thumb_distal, thumb_mcp, turn_x(-angles.thumb_ip_flexion_rad));
  place(Joint::thumb_tip, thumb_ip, Matrix3d::Identity());

  for (std::size_t f = 0; f < 4; ++f) {
    const Joint base = fingers[f].metacarpal;
    const FingerAngles& finger = angles.fingers[f];
    // The offset of the metacarpal's head is given in the wrist's axes; seen from the metacarpal's
    // own frame, which points along the bone, the bone is straight ahead, and the finger's zero is
    // parallel to the wrist's axis.
    const Matrix3d bone = pointing(rest_offset(next(base, 1)));
    const Isometry3d root = place(base, wrist, turn_x(-arch_share[f] * angles.palm_arch_rad));
    const Isometry3d mcp = place(
        next(base, 1), root, turn_y(finger.mcp_abduction_rad) * turn_x(-finger.mcp_flexion_rad));
    pose.joints[index_of(base)].linear() = root.linear() * bone;
    const Isometry3d pip = place(next(base, 2), mcp, turn_x(-finger.pip_flexion_rad));
    const Isometry3d dip = place(next(base, 3), pip, turn_x(-finger.dip_flexion_rad));
    place(next(base, 4), dip, Matrix3d::Identity());
  }
  return pose;
}

HandPose HandSkeleton::pose(const JointAngles& angles,
                            const Isometry3d& T_world_wrist) const noexcept {
  HandPose pose = right_hand_pose(angles);
  // A left hand is the mirror image: with M = diag(-1, 1, 1), positions become M p and rotations M
  // R M.
  const Vector3d mirror(-1.0, 1.0, 1.0);
  for (auto& joint : pose.joints) {
    if (side_ == Side::left) {
      joint.translation() = mirror.cwiseProduct(joint.translation());
      joint.linear() = mirror.asDiagonal() * joint.linear() * mirror.asDiagonal();
    }
    joint = T_world_wrist * joint;
  }
  return pose;
}

} // namespace nendo::hand
