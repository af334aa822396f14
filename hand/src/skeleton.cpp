#include <nendo/hand/skeleton.hpp>

#include <cmath>

#include <nendo/hand/joints.hpp>

#include "turns.hpp"

namespace nendo::hand {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector4d;

// Proportions: B. Buchholz, T. J. Armstrong, S. A. Goldstein, "Anthropometric data for describing
// the kinematics of the human hand", Ergonomics 35(3), 1992, 261-273: lengths and axial places as
// fractions of the hand's length, places across the hand as fractions of its breadth. Right hand:
// the thumb is at -X.
struct FingerProportions {
  Joint metacarpal;
  double mcp_axial;    ///< wrist crease to MCP, of length
  double mcp_across;   ///< from the third metacarpal's axis towards the little finger, of breadth
  double mcp_dorsal;   ///< fraction of length: the heads lie on a shallow arch
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
// are half as far from one another as their heads.
constexpr double metacarpal_base_axial = 0.118;
constexpr double metacarpal_base_across = 0.5;

// The rotation that takes -Z to `direction` by the shortest way; `direction` is not +Z. (Eigen's
// own takes an SVD for the case that cannot be.)
Matrix3d pointing(const Vector3d& direction) {
  const Vector3d axis = (-Vector3d::UnitZ()).cross(direction);
  const double angle_rad = std::atan2(axis.norm(), -direction.z());
  return angle_rad > 0.0 ? AngleAxisd(angle_rad, axis.normalized()).matrix() : Matrix3d::Identity();
}

/// A joint's frame while the hand is walked through: the columns of its homogeneous matrix. A turn
/// about one of its own axes only mixes the other two, a bone only moves the origin, so that no
/// matrices are multiplied. Columns have four rows because the vector unit takes them by twos.
struct Frame {
  Vector4d x, y, z, origin;

  explicit Frame(const Isometry3d& pose) noexcept
      : x(pose.matrix().col(0)), y(pose.matrix().col(1)), z(pose.matrix().col(2)),
        origin(pose.matrix().col(3)) {}

  void turn_x(Turn turn) noexcept { mix(y, z, turn); }
  void turn_y(Turn turn) noexcept { mix(z, x, turn); }
  void turn_z(Turn turn) noexcept { mix(x, y, turn); }
  void turn(const Matrix3d& by) noexcept {
    const Frame before = *this;
    x = by(0, 0) * before.x + by(1, 0) * before.y + by(2, 0) * before.z;
    y = by(0, 1) * before.x + by(1, 1) * before.y + by(2, 1) * before.z;
    z = by(0, 2) * before.x + by(1, 2) * before.y + by(2, 2) * before.z;
  }
  void move(const Vector3d& by) noexcept { origin += by.x() * x + by.y() * y + by.z() * z; }
  void go_ahead(double length_m) noexcept { origin -= length_m * z; }
  void store(Isometry3d& pose) const noexcept {
    pose.matrix().col(0) = x;
    pose.matrix().col(1) = y;
    pose.matrix().col(2) = z;
    pose.matrix().col(3) = origin;
  }

private:
  static void mix(Vector4d& from, Vector4d& to, Turn turn) noexcept {
    const Vector4d turned = turn.cos * from + turn.sin * to;
    to = turn.cos * to - turn.sin * from;
    from = turned;
  }
};

constexpr Eigen::Index first_arched = 2; // ring finger: the first that the palm's arch moves

// The index of each angle's turn. A finger's four begin at `finger_turns`.
enum : Eigen::Index {
  yaw_turn,
  pitch_turn,
  roll_turn,
  thumb_abduction_turn,
  pronation_turn,
  thumb_mcp_turn,
  thumb_ip_turn,
  arch_turns, // of ring and little finger
  finger_turns = arch_turns + 2,
  spare_turn = finger_turns + 16, // for turns() takes them by twos
  turn_count
};

double finite_or_zero(double angle_rad) noexcept {
  return std::isfinite(angle_rad) ? angle_rad : 0.0;
}

/// Signed as turns about +X, +Y, +Z of a right hand.
Turns<turn_count> turns_of(const JointAngles& angles, const HandSkeleton::Axes& axes) noexcept {
  Eigen::Array<double, turn_count, 1> row;
  row[yaw_turn] = angles.wrist_yaw_rad;
  row[pitch_turn] = -angles.wrist_pitch_rad;
  const double roll_rad = finite_or_zero(angles.thumb_roll_rad);
  const double abduction_rad = finite_or_zero(angles.thumb_abduction_rad);
  row[roll_turn] = roll_rad;
  row[thumb_abduction_turn] = axes.thumb_rest_rad + abduction_rad;
  row[pronation_turn] = axes.thumb_pronation.at(roll_rad, abduction_rad);
  row[thumb_mcp_turn] = -angles.thumb_mcp_flexion_rad;
  row[thumb_ip_turn] = -angles.thumb_ip_flexion_rad;
  row[arch_turns] = -arch_share[first_arched] * angles.palm_arch_rad;
  row[arch_turns + 1] = -arch_share[first_arched + 1] * angles.palm_arch_rad;
  Eigen::Index at = finger_turns;
  for (const FingerAngles& finger : angles.fingers) {
    row[at++] = finger.mcp_abduction_rad;
    row[at++] = -finger.mcp_flexion_rad;
    row[at++] = -finger.pip_flexion_rad;
    row[at++] = -finger.dip_flexion_rad;
  }
  row[spare_turn] = 0.0;
  return turns(row);
}

HandSkeleton::Axes axes_of(const WearerShape& shape) {
  HandSkeleton::Axes axes;
  const double tilt_x = shape[ShapeTerm::thumb_tilt_x], tilt_y = shape[ShapeTerm::thumb_tilt_y];
  axes.thumb_is_tilted = tilt_x != 0.0 || tilt_y != 0.0;
  axes.thumb =
      axes.thumb_is_tilted
          ? Matrix3d(AngleAxisd(tilt_x, Vector3d::UnitX()) * AngleAxisd(tilt_y, Vector3d::UnitY()))
          : Matrix3d(Matrix3d::Identity());
  axes.thumb_rest_rad = thumb_rest_abduction_rad + shape[ShapeTerm::thumb_rest];
  axes.thumb_pronation = {thumb_pronation_rad + shape[ShapeTerm::thumb_pronation],
                          pronation_by_roll + shape[ShapeTerm::thumb_pronation_by_roll],
                          pronation_by_abduction + shape[ShapeTerm::thumb_pronation_by_abduction]};
  for (std::size_t f = 0; f < 4; ++f)
    axes.knuckle_tilts_rad[f] = shape.terms[static_cast<std::size_t>(ShapeTerm::index_tilt) + f];
  return axes;
}

} // namespace

Eigen::Matrix<double, 3, 5> HandPose::fingertip_positions() const noexcept {
  Eigen::Matrix<double, 3, 5> tips;
  for (std::size_t f = 0; f < finger_count; ++f) {
    tips.col(static_cast<Eigen::Index>(f)) = (*this)[fingertips[f]].translation();
  }
  return tips;
}

HandSkeleton::Offsets HandSkeleton::offsets_of(const HandSize& size) {
  Offsets offsets_m;
  offsets_m.fill(Vector3d::Zero());
  const double length = size.length_m;
  const double breadth = size.breadth_m;
  const WearerShape& shape = size.shape;
  const auto longer = [&](ShapeTerm first, std::size_t bone) {
    const double term = shape.terms[static_cast<std::size_t>(first) + bone];
    return term == 0.0 ? 1.0 : std::exp(term);
  };
  const auto along = [](double metres) { return Vector3d(0.0, 0.0, -metres); };
  const auto set = [&](Joint joint, std::size_t steps, const Vector3d& offset) {
    offsets_m[index_of(joint) + steps] = offset;
  };
  set(Joint::thumb_metacarpal, 0,
      {thumb_cmc_across * breadth + shape[ShapeTerm::thumb_base_x],
       thumb_cmc_dorsal * length + shape[ShapeTerm::thumb_base_y],
       -thumb_cmc_axial * length + shape[ShapeTerm::thumb_base_z]});
  for (std::size_t bone = 0; bone < 3; ++bone) {
    set(Joint::thumb_metacarpal, bone + 1,
        along(longer(ShapeTerm::thumb_metacarpal, bone) * thumb_bones[bone] * length));
  }
  for (std::size_t f = 0; f < 4; ++f) {
    const FingerProportions& finger = fingers[f];
    const Vector3d base(metacarpal_base_across * finger.mcp_across * breadth, 0.0,
                        -metacarpal_base_axial * length);
    const Vector3d head(finger.mcp_across * breadth, finger.mcp_dorsal * length,
                        -finger.mcp_axial * length);
    set(finger.metacarpal, 0, base);
    set(finger.metacarpal, 1, head - base);
    for (std::size_t bone = 0; bone < 3; ++bone) {
      set(finger.metacarpal, bone + 2,
          along(longer(ShapeTerm::index_proximal, 3 * f + bone) * finger.phalanges[bone] * length));
    }
  }
  return offsets_m;
}

HandSkeleton::HandSkeleton(Side side, const HandSize& size)
    : side_(side), offsets_m_(offsets_of(size)), axes_(axes_of(size.shape)),
      pad_m_(0.0, -pad_depth_m - size.shape[ShapeTerm::pad_depth],
             pad_behind_tip_m + size.shape[ShapeTerm::pad_behind]) {
  offsets_m_[index_of(Joint::palm)] =
      rest_offset(Joint::middle_metacarpal) + 0.5 * rest_offset(Joint::middle_proximal);
  // A left hand is the mirror image of a right one: with M = diag(-1, 1, 1), places become M p and
  // rotations M R M.
  const Vector3d mirror(side == Side::left ? -1.0 : 1.0, 1.0, 1.0);
  own_thumb_axes_ = mirror.asDiagonal() * axes_.thumb * mirror.asDiagonal();
  palm_m_ = mirror.cwiseProduct(rest_offset(Joint::palm));
  thumb_base_m_ = mirror.cwiseProduct(rest_offset(Joint::thumb_metacarpal));
  for (std::size_t f = 0; f < fingers_.size(); ++f) {
    const Vector3d& head = rest_offset(joint_after(fingers[f].metacarpal, 1));
    fingers_[f] = {
        mirror.cwiseProduct(rest_offset(fingers[f].metacarpal)),
        mirror.cwiseProduct(head),
        mirror.asDiagonal() * pointing(head) * mirror.asDiagonal(),
        {mirror.x() * std::sin(axes_.knuckle_tilts_rad[f]), std::cos(axes_.knuckle_tilts_rad[f])}};
  }
}

/// From the wrist outwards, one chain of bones after the other.
struct HandSkeleton::Walk {
  const HandSkeleton& hand;
  Turns<turn_count> turns;
  HandPose& pose;

  /// The mirror turns rotations about Y and Z round, and leaves those about X as they are.
  Turn sideways(Turn turn) const noexcept {
    return hand.side_ == Side::left ? turn.reversed() : turn;
  }
  void place(Joint joint, const Frame& frame) noexcept {
    frame.store(pose.joints[index_of(joint)]);
  }
  void go_along(Joint joint, Frame& frame) const noexcept {
    frame.go_ahead(-hand.rest_offset(joint_after(joint, 1)).z());
  }
  void bend(Joint joint, Turn turn, Frame& frame) noexcept {
    frame.turn_x(turn);
    place(joint, frame);
    go_along(joint, frame);
  }

  void thumb(Frame frame) noexcept {
    frame.move(hand.thumb_base_m_);
    if (hand.axes_.thumb_is_tilted) frame.turn(hand.own_thumb_axes_);
    frame.turn_z(sideways(turns[roll_turn]));
    frame.turn_y(sideways(turns[thumb_abduction_turn]));
    frame.turn_z(sideways(turns[pronation_turn]));
    place(Joint::thumb_metacarpal, frame);
    go_along(Joint::thumb_metacarpal, frame);
    bend(Joint::thumb_proximal, turns[thumb_mcp_turn], frame);
    bend(Joint::thumb_distal, turns[thumb_ip_turn], frame);
    place(Joint::thumb_tip, frame);
  }

  /// f: 0, the index finger, to 3.
  void finger(std::size_t f, Frame frame) noexcept {
    const FingerRoot& root = hand.fingers_[f];
    const Joint metacarpal = fingers[f].metacarpal;
    const auto turn = finger_turns + 4 * static_cast<Eigen::Index>(f);
    frame.move(root.base_m);
    if (arch_share[f] > 0.0)
      frame.turn_x(turns[arch_turns + static_cast<Eigen::Index>(f) - first_arched]);
    Frame along_bone = frame;
    along_bone.turn(root.metacarpal_axes);
    place(metacarpal, along_bone);
    frame.move(root.head_m);
    frame.turn_y(sideways(turns[turn]));
    if (root.tilt[0] != 0.0) frame.turn_z({root.tilt[0], root.tilt[1]});
    bend(joint_after(metacarpal, 1), turns[turn + 1], frame);
    bend(joint_after(metacarpal, 2), turns[turn + 2], frame);
    bend(joint_after(metacarpal, 3), turns[turn + 3], frame);
    place(joint_after(metacarpal, 4), frame);
  }
};

HandPose HandSkeleton::pose(const JointAngles& angles,
                            const Isometry3d& T_world_wrist) const noexcept {
  HandPose pose;
  Walk walk{*this, turns_of(angles, axes_), pose};
  Frame wrist(T_world_wrist);
  wrist.turn_y(walk.sideways(walk.turns[yaw_turn]));
  wrist.turn_x(walk.turns[pitch_turn]);
  walk.place(Joint::wrist, wrist);
  Frame palm = wrist;
  palm.move(palm_m_);
  palm.turn(fingers_[1].metacarpal_axes); // OpenXR's palm points along the middle metacarpal
  walk.place(Joint::palm, palm);
  walk.thumb(wrist);
  for (std::size_t f = 0; f < fingers_.size(); ++f)
    walk.finger(f, wrist);
  return pose;
}

} // namespace nendo::hand
