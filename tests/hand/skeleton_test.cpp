#include <nendo/hand/skeleton.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "support/random_poses.hpp"

namespace skeleton_test {

using namespace nendo;
using namespace nendo::hand;
using Eigen::Isometry3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using nendo::test::random_place;

namespace {

/// All the way round, which no hand can do.
JointAngles random_angles(std::mt19937& random) {
  std::uniform_real_distribution<double> turn(-std::numbers::pi, std::numbers::pi);
  JointAngles angles;
  angles.thumb_roll_rad = turn(random);
  angles.thumb_abduction_rad = turn(random);
  angles.thumb_mcp_flexion_rad = turn(random);
  angles.thumb_ip_flexion_rad = turn(random);
  for (auto& finger : angles.fingers) {
    finger = {turn(random), turn(random), turn(random), turn(random)};
  }
  angles.palm_arch_rad = turn(random);
  angles.wrist_pitch_rad = turn(random);
  angles.wrist_yaw_rad = turn(random);
  return angles;
}

// The reference: products of 4x4 matrices written out by hand, with nothing of the code under test
// but the lengths.
Matrix4d move(const Vector3d& by) {
  Matrix4d m = Matrix4d::Identity();
  m(0, 3) = by.x();
  m(1, 3) = by.y();
  m(2, 3) = by.z();
  return m;
}
Matrix4d rot(int axis, double angle) {
  const int a = (axis + 1) % 3;
  const int b = (axis + 2) % 3;
  Matrix4d m = Matrix4d::Identity();
  m(a, a) = m(b, b) = std::cos(angle);
  m(b, a) = std::sin(angle);
  m(a, b) = -std::sin(angle);
  return m;
}
Matrix4d turned(const Eigen::Quaterniond& q) {
  Matrix4d m = Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = q.toRotationMatrix();
  return m;
}

constexpr int x_axis = 0;
constexpr int y_axis = 1;
constexpr int z_axis = 2;

using Matrices = std::array<Matrix4d, joint_count>;

Matrices product_of_matrices(const HandSkeleton& skeleton, const JointAngles& a,
                             const Isometry3d& base) {
  Matrices m;
  const auto offset = [&](Joint j) { return move(skeleton.rest_offset(j)); };
  const auto at = [&](Joint j) -> Matrix4d& { return m[index_of(j)]; };
  at(Joint::wrist) = rot(y_axis, a.wrist_yaw_rad) * rot(x_axis, -a.wrist_pitch_rad);
  const auto along = [&](Joint end) { // from -Z to the bone's direction, by the shortest way
    return turned(
        Eigen::Quaterniond::FromTwoVectors(-Vector3d::UnitZ(), skeleton.rest_offset(end)));
  };
  at(Joint::palm) = at(Joint::wrist) * offset(Joint::palm) * along(Joint::middle_proximal);

  const double deg = std::numbers::pi / 180.0;
  at(Joint::thumb_metacarpal) =
      at(Joint::wrist) * offset(Joint::thumb_metacarpal) * rot(z_axis, a.thumb_roll_rad) *
      rot(y_axis, 15 * deg + a.thumb_abduction_rad) *
      rot(z_axis, 47 * deg - 0.41 * a.thumb_roll_rad - 0.27 * a.thumb_abduction_rad);
  at(Joint::thumb_proximal) = at(Joint::thumb_metacarpal) * offset(Joint::thumb_proximal) *
                              rot(x_axis, -a.thumb_mcp_flexion_rad);
  at(Joint::thumb_distal) = at(Joint::thumb_proximal) * offset(Joint::thumb_distal) *
                            rot(x_axis, -a.thumb_ip_flexion_rad);
  at(Joint::thumb_tip) = at(Joint::thumb_distal) * offset(Joint::thumb_tip);

  const double arch[] = {0.0, 0.0, 0.5, 1.0};
  const Joint bases[] = {Joint::index_metacarpal, Joint::middle_metacarpal, Joint::ring_metacarpal,
                         Joint::little_metacarpal};
  for (std::size_t f = 0; f < 4; ++f) {
    const auto j = [&](std::size_t n) { return static_cast<Joint>(index_of(bases[f]) + n); };
    const FingerAngles& finger = a.fingers[f];
    const Matrix4d root = at(Joint::wrist) * offset(j(0)) * rot(x_axis, -arch[f] * a.palm_arch_rad);
    at(j(0)) = root * along(j(1));
    at(j(1)) = root * offset(j(1)) * rot(y_axis, finger.mcp_abduction_rad) *
               rot(x_axis, -finger.mcp_flexion_rad);
    at(j(2)) = at(j(1)) * offset(j(2)) * rot(x_axis, -finger.pip_flexion_rad);
    at(j(3)) = at(j(2)) * offset(j(3)) * rot(x_axis, -finger.dip_flexion_rad);
    at(j(4)) = at(j(3)) * offset(j(4));
  }
  // A left hand: everything seen in the mirror.
  const Matrix4d mirror = Eigen::Vector4d(-1.0, 1.0, 1.0, 1.0).asDiagonal();
  for (Matrix4d& joint : m) {
    if (skeleton.side() == Side::left) joint = (mirror * joint * mirror).eval();
    joint = (base.matrix() * joint).eval();
  }
  return m;
}

/// The farthest that any entry of any joint's matrix is off: metres, and parts of a unit vector.
double farthest_apart(const HandPose& pose, const Matrices& matrices) {
  double farthest = 0.0;
  for (std::size_t at = 0; at < joint_count; ++at) {
    const Matrix4d difference = pose.joints[at].matrix() - matrices[at];
    farthest = std::max(farthest, difference.cwiseAbs().maxCoeff());
  }
  return farthest;
}

} // namespace

TEST_SUITE("skeleton") {
  TEST_CASE("places and turns of all joints of both hands are a product of homogeneous matrices") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> length(0.12, 0.25);
    std::uniform_real_distribution<double> breadth(0.05, 0.12);
    for (int round = 0; round < 2000; ++round) {
      const HandSize size{length(random), breadth(random)};
      for (const Side side : {Side::left, Side::right}) {
        const HandSkeleton skeleton(side, size);
        const JointAngles a = random_angles(random);
        const Isometry3d base = random_place(random);
        REQUIRE(farthest_apart(skeleton.pose(a, base), product_of_matrices(skeleton, a, base)) <
                1e-13);
      }
    }
  }

  TEST_CASE("angles of many turns are as good as angles of less than one") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> far(-1e4, 1e4);
    const HandSkeleton skeleton(Side::left);
    for (int round = 0; round < 200; ++round) {
      JointAngles a = random_angles(random);
      a.thumb_mcp_flexion_rad = far(random);
      a.fingers[0].pip_flexion_rad = far(random);
      a.fingers[2].mcp_abduction_rad = far(random);
      const Isometry3d base = random_place(random);
      REQUIRE(farthest_apart(skeleton.pose(a, base), product_of_matrices(skeleton, a, base)) <
              1e-13);
    }
  }

  TEST_CASE("an angle that is not finite counts as zero") {
    const HandSkeleton skeleton(Side::right);
    std::mt19937 random(6);
    for (const double none :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
          -std::numeric_limits<double>::infinity()}) {
      JointAngles zero = random_angles(random);
      zero.fingers[1].pip_flexion_rad = zero.wrist_yaw_rad = zero.palm_arch_rad = 0.0;
      JointAngles broken = zero;
      broken.fingers[1].pip_flexion_rad = broken.wrist_yaw_rad = broken.palm_arch_rad = none;
      const HandPose expected = skeleton.pose(zero, Isometry3d::Identity());
      const HandPose pose = skeleton.pose(broken, Isometry3d::Identity());
      for (std::size_t at = 0; at < joint_count; ++at)
        CHECK((pose.joints[at].matrix() - expected.joints[at].matrix()).norm() < 1e-13);
    }
  }

  TEST_CASE("the largest angles that a double can hold give finite poses") {
    JointAngles a;
    a.thumb_roll_rad = std::numeric_limits<double>::max();
    a.fingers[3].dip_flexion_rad = -std::numeric_limits<double>::max();
    const HandPose pose = HandSkeleton(Side::left).pose(a, Isometry3d::Identity());
    for (const auto& joint : pose.joints)
      CHECK(joint.matrix().allFinite());
  }

  TEST_CASE("bones keep their length in every pose") {
    std::mt19937 random(2);
    for (const Side side : {Side::left, Side::right}) {
      const HandSkeleton skeleton(side);
      for (int round = 0; round < 100; ++round) {
        const HandPose pose = skeleton.pose(random_angles(random), random_place(random));
        for (std::size_t at = 0; at < joint_count; ++at) {
          const auto joint = static_cast<Joint>(at);
          const auto parent = parent_of(joint);
          if (!parent) continue;
          const double length = (pose[joint].translation() - pose[*parent].translation()).norm();
          CHECK(length == doctest::Approx(skeleton.rest_offset(joint).norm()).epsilon(1e-12));
        }
      }
    }
  }

  TEST_CASE("a left hand is the mirror image of a right hand with the same angles") {
    std::mt19937 random(3);
    const HandSkeleton left(Side::left);
    const HandSkeleton right(Side::right);
    for (int round = 0; round < 100; ++round) {
      const JointAngles angles = random_angles(random);
      const HandPose l = left.pose(angles, Isometry3d::Identity());
      const HandPose r = right.pose(angles, Isometry3d::Identity());
      for (std::size_t at = 0; at < joint_count; ++at) {
        const Vector3d p = r.joints[at].translation();
        CHECK((l.joints[at].translation() - Vector3d(-p.x(), p.y(), p.z())).norm() < 1e-15);
        CHECK(l.joints[at].linear().determinant() == doctest::Approx(1.0));
      }
    }
  }

  TEST_CASE("moving the wrist moves the whole hand rigidly") {
    std::mt19937 random(4);
    const HandSkeleton skeleton(Side::left);
    const JointAngles angles = random_angles(random);
    const HandPose at_origin = skeleton.pose(angles, Isometry3d::Identity());
    const Isometry3d moved = random_place(random);
    const HandPose pose = skeleton.pose(angles, moved);
    for (std::size_t at = 0; at < joint_count; ++at) {
      CHECK((pose.joints[at].matrix() - (moved * at_origin.joints[at]).matrix()).norm() < 1e-12);
    }
  }

  TEST_CASE("each bone lies along its joint's -Z") {
    std::mt19937 random(6);
    for (const Side side : {Side::left, Side::right}) {
      const HandSkeleton skeleton(side);
      const HandPose pose = skeleton.pose(random_angles(random), random_place(random));
      for (std::size_t at = index_of(Joint::thumb_metacarpal) + 1; at < joint_count; ++at) {
        const auto joint = static_cast<Joint>(at);
        const Joint parent = *parent_of(joint);
        if (parent == Joint::wrist) continue;
        const Vector3d in_parent = pose[parent].inverse() * pose[joint].translation();
        CAPTURE(name_of(joint));
        CHECK((in_parent - Vector3d(0, 0, -in_parent.norm())).norm() < 1e-12);
      }
    }
  }

  TEST_CASE("the flat hand is as long as it is said to be, and flat") {
    const HandSize size{0.200, 0.090};
    const HandPose pose = HandSkeleton(Side::right, size).pose({}, Isometry3d::Identity());
    CHECK(-pose[Joint::middle_tip].translation().z() ==
          doctest::Approx(size.length_m).epsilon(0.02));
    for (const Joint tip :
         {Joint::index_tip, Joint::middle_tip, Joint::ring_tip, Joint::little_tip}) {
      CHECK(std::abs(pose[tip].translation().y()) < 0.005);
    }
    const double across = pose[Joint::little_proximal].translation().x() -
                          pose[Joint::index_proximal].translation().x();
    CHECK(across > 0.5 * size.breadth_m);
    CHECK(across < size.breadth_m);
  }

  TEST_CASE("signs: bending goes to the palm, the thumb is at the right hand's left") {
    const HandSkeleton skeleton(Side::right);
    const HandPose flat = skeleton.pose({}, Isometry3d::Identity());
    CHECK(flat[Joint::thumb_tip].translation().x() <
          flat[Joint::index_tip].translation().x() - 0.01);
    JointAngles bent;
    for (auto& finger : bent.fingers)
      finger.mcp_flexion_rad = 0.5;
    const HandPose pose = skeleton.pose(bent, Isometry3d::Identity());
    for (const Joint tip :
         {Joint::index_tip, Joint::middle_tip, Joint::ring_tip, Joint::little_tip}) {
      CHECK(pose[tip].translation().y() < flat[tip].translation().y() - 0.02);
    }
    JointAngles rolled;
    rolled.thumb_abduction_rad = 0.6;
    rolled.thumb_roll_rad = 1.2;
    CHECK(skeleton.pose(rolled, Isometry3d::Identity())[Joint::thumb_tip].translation().y() <
          -0.04);
    JointAngles spread;
    spread[Finger::index].mcp_abduction_rad = 0.3;
    CHECK(skeleton.pose(spread, Isometry3d::Identity())[Joint::index_tip].translation().x() <
          flat[Joint::index_tip].translation().x() - 0.02);
  }

  TEST_CASE("thumb and index finger can pinch within their ranges of motion") {
    const HandSkeleton skeleton(Side::right);
    double nearest = 1.0;
    for (double roll = 0.2; roll <= 1.4; roll += 0.1) {
      for (double abduction = 0.1; abduction <= 0.8; abduction += 0.1) {
        for (double mcp = 0.2; mcp <= 1.4; mcp += 0.1) {
          for (double pip = 0.2; pip <= 1.4; pip += 0.2) {
            JointAngles angles;
            angles.thumb_roll_rad = roll;
            angles.thumb_abduction_rad = abduction;
            angles.thumb_mcp_flexion_rad = 0.3;
            angles.thumb_ip_flexion_rad = 0.3;
            angles[Finger::index] = {mcp, 0.0, pip, pip * 2 / 3};
            const HandPose pose = skeleton.pose(angles, Isometry3d::Identity());
            nearest = std::min(nearest, (pose[Joint::thumb_tip].translation() -
                                         pose[Joint::index_tip].translation())
                                            .norm());
          }
        }
      }
    }
    CHECK(nearest < 0.010);
  }
}

} // namespace skeleton_test
