#include <nendo/hand/hand_body.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "support/random_poses.hpp"
#include "support/restraint.hpp"

namespace hand_body_test {

using namespace nendo;
using namespace nendo::hand;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using nendo::test::random_place;

namespace {

Vector3d random_vector(std::mt19937& random, double half_edge) {
  std::uniform_real_distribution<double> coordinate(-half_edge, half_edge);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

/// Of any shape: slender, thick, of even thickness, one ball within another.
BodyPart random_part(std::mt19937& random, std::size_t corners) {
  std::uniform_real_distribution<double> radius(0.0, 0.6);
  BodyPart part;
  part.corner_count = corners;
  const bool even = random() % 4 == 0;
  for (std::size_t at = 0; at < 3; ++at) {
    part.corners_m[at] = random_vector(random, 1.0);
    part.radii_m[at] = even && at > 0 ? part.radii_m[0] : radius(random);
  }
  return part;
}

// The reference: the hull of balls is the union of all balls between them. This looks at many, in
// finer and finer grids about the best, and knows nothing of slopes.
double sampled_distance(const BodyPart& part, const Vector3d& place) {
  double u_middle = 0.5;
  double v_middle = part.corner_count == 3 ? 0.5 : 0.0;
  double best = std::numeric_limits<double>::infinity();
  for (double width = 1.0; width > 1e-10; width *= 0.5) {
    const double u_centre = u_middle;
    const double v_centre = v_middle;
    for (int i = -8; i <= 8; ++i)
      for (int j = -8; j <= 8; ++j) {
        const double u = std::clamp(u_centre + width * i / 16.0, 0.0, 1.0);
        const double v =
            part.corner_count == 3 ? std::clamp(v_centre + width * j / 16.0, 0.0, 1.0 - u) : 0.0;
        const Vector3d centre =
            (1.0 - u - v) * part.corners_m[0] + u * part.corners_m[1] + v * part.corners_m[2];
        const double distance = (place - centre).norm() - (1.0 - u - v) * part.radii_m[0] -
                                u * part.radii_m[1] - v * part.radii_m[2];
        if (distance >= best) continue;
        best = distance;
        u_middle = u;
        v_middle = v;
      }
  }
  return best;
}

/// How far the hull reaches in that direction: the farthest of its balls.
double reach(const BodyPart& part, const Vector3d& direction) {
  double far = -std::numeric_limits<double>::infinity();
  for (std::size_t at = 0; at < part.corner_count; ++at)
    far = std::max(far, part.corners_m[at].dot(direction) + part.radii_m[at]);
  return far;
}

HandPose random_pose(std::mt19937& random, const HandSkeleton& skeleton) {
  std::uniform_real_distribution<double> bend(0.0, 1.2);
  JointAngles angles;
  for (auto& finger : angles.fingers)
    finger = {bend(random), 0.1 * bend(random), bend(random), 0.5 * bend(random)};
  angles.thumb_abduction_rad = 0.5 * bend(random);
  angles.thumb_roll_rad = bend(random);
  angles.palm_arch_rad = 0.2 * bend(random);
  return skeleton.pose(angles, random_place(random));
}

} // namespace

TEST_SUITE("hand_body") {
  TEST_CASE("the distance from cones and triangles is that of the union of all their balls") {
    std::mt19937 random(11);
    double worst = 0.0;
    for (int trial = 0; trial < 4000; ++trial) {
      const BodyPart part = random_part(random, trial % 2 == 0 ? 2 : 3);
      const Vector3d place = random_vector(random, 1.6);
      worst = std::max(
          worst, std::abs(nearest_of(part, place).distance_m - sampled_distance(part, place)));
    }
    CHECK(worst < 1e-8);
  }

  TEST_CASE("a convex hull lies behind each tangent plane, and the plane of the nearest place "
            "touches it") {
    std::mt19937 random(12);
    double worst_gap = 0.0;
    for (int trial = 0; trial < 4000; ++trial) {
      const BodyPart part = random_part(random, trial % 2 == 0 ? 2 : 3);
      const ClosestPoint near = nearest_of(part, random_vector(random, 1.6));
      CHECK(std::abs(near.normal.norm() - 1.0) < 1e-12);
      worst_gap =
          std::max(worst_gap, std::abs(reach(part, near.normal) - near.normal.dot(near.place_m)));
    }
    CHECK(worst_gap < 1e-9);
  }

  TEST_CASE("the normal is the distance's gradient, and leads from the nearest place") {
    std::mt19937 random(13);
    constexpr double step = 1e-6;
    for (int trial = 0; trial < 2000; ++trial) {
      const BodyPart part = random_part(random, trial % 2 == 0 ? 2 : 3);
      const Vector3d place = random_vector(random, 1.6);
      const ClosestPoint near = nearest_of(part, place);
      CHECK((near.place_m + near.distance_m * near.normal - place).norm() < 1e-12);
      if (near.distance_m < 0.05) continue; // inside there are places with two nearest ones
      Vector3d gradient;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const Vector3d by = step * Vector3d::Unit(axis);
        gradient[axis] =
            (nearest_of(part, place + by).distance_m - nearest_of(part, place - by).distance_m) /
            (2.0 * step);
      }
      CHECK((gradient - near.normal).norm() < 1e-5);
    }
  }

  TEST_CASE("places on axes and triangles, and parts without any extent, have normals") {
    BodyPart part{{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)}, {0.2, 0.2, 0.2}, 2};
    ClosestPoint near = nearest_of(part, {0.5, 0, 0});
    CHECK(near.distance_m == doctest::Approx(-0.2));
    CHECK(std::abs(near.normal.x()) < 1e-12);
    part.corner_count = 3;
    near = nearest_of(part, {0.25, 0.25, 0});
    CHECK(near.distance_m == doctest::Approx(-0.2));
    CHECK(std::abs(near.normal.z()) == doctest::Approx(1.0));
    for (const std::size_t corners : {std::size_t{2}, std::size_t{3}}) {
      const BodyPart point{{Vector3d::Ones(), Vector3d::Ones(), Vector3d::Ones()}, {}, corners};
      near = nearest_of(point, Vector3d::Ones());
      CHECK(near.distance_m == 0.0);
      CHECK(near.normal.norm() == doctest::Approx(1.0));
    }
    // A triangle whose corners are in line.
    part.corners_m = {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(3, 0, 0)};
    CHECK(nearest_of(part, {2, 1, 0}).distance_m == doctest::Approx(0.8));
  }

  TEST_CASE("the body goes where the hand goes, and a left hand is a right hand's mirror image") {
    std::mt19937 random(14);
    const HandSkeleton right(Side::right);
    const HandSkeleton left(Side::left);
    HandBody body(right);
    HandBody moved(right);
    HandBody mirrored(left);
    for (int trial = 0; trial < 20; ++trial) {
      JointAngles angles;
      std::uniform_real_distribution<double> bend(0.0, 1.0);
      for (auto& finger : angles.fingers)
        finger = {bend(random), 0.2 * bend(random), bend(random), bend(random)};
      angles.thumb_roll_rad = bend(random);
      const Isometry3d way = random_place(random);
      body.follow(right.pose(angles, Isometry3d::Identity()));
      moved.follow(right.pose(angles, way));
      mirrored.follow(left.pose(angles, Isometry3d::Identity()));
      for (int at = 0; at < 50; ++at) {
        const Vector3d place = random_vector(random, 0.2);
        const ClosestPoint near = body.nearest(place);
        const ClosestPoint far = moved.nearest(way * place);
        CHECK(far.distance_m == doctest::Approx(near.distance_m));
        CHECK((far.place_m - way * near.place_m).norm() < 1e-9);
        const Vector3d image(-place.x(), place.y(), place.z());
        CHECK(mirrored.nearest(image).distance_m == doctest::Approx(near.distance_m));
      }
    }
  }

  TEST_CASE("a hand of another size has a body of that size") {
    const HandSkeleton usual(Side::right);
    const HandSkeleton large(Side::right, {1.2 * 0.187, 1.2 * 0.083});
    const HandBody body(usual);
    const HandBody larger(large);
    std::mt19937 random(15);
    for (int trial = 0; trial < 200; ++trial) {
      const Vector3d place = random_vector(random, 0.2);
      CHECK(larger.nearest(1.2 * place).distance_m ==
            doctest::Approx(1.2 * body.nearest(place).distance_m));
    }
  }

  TEST_CASE("a finger ends in its tip") {
    std::mt19937 random(16);
    const HandSkeleton skeleton(Side::right);
    HandBody body(skeleton);
    for (int trial = 0; trial < 20; ++trial) {
      const HandPose pose = random_pose(random, skeleton);
      body.follow(pose);
      for (std::size_t finger = 0; finger < finger_count; ++finger) {
        const BodyPart& last = body.parts()[3 * finger + 2];
        const double distance_m =
            nearest_of(last, pose[fingertips[finger]].translation()).distance_m;
        CHECK(std::abs(distance_m) < 0.0002); // fingers lie a millimetre below their bones
      }
    }
  }

  /// How far below the back of the hand the palm's surface is, along the wrist's -Y.
  static double palm_height_m(const HandBody& body, double x_m, double z_m) {
    Vector3d place(x_m, -0.08, z_m);
    for (int step = 0; step < 200; ++step)
      place.y() += body.nearest(place).distance_m;
    return place.y();
  }

  TEST_CASE("the palm has no grooves between the metacarpals") {
    const HandSkeleton skeleton(Side::right);
    HandBody body(skeleton);
    const HandPose pose = skeleton.pose({}, Isometry3d::Identity());
    body.follow(pose);
    // Where a metacarpal is, seen from the palm.
    const auto across_m = [&](Joint metacarpal, double z_m) {
      const Vector3d base = pose[metacarpal].translation();
      const Vector3d head = pose.joints[index_of(metacarpal) + 1].translation();
      return base.x() + (z_m - base.z()) / (head.z() - base.z()) * (head.x() - base.x());
    };
    const double end_m = pose[Joint::little_proximal].translation().z();
    for (const double along : {0.5, 0.65, 0.8, 0.95})
      for (const Joint first :
           {Joint::index_metacarpal, Joint::middle_metacarpal, Joint::ring_metacarpal}) {
        const auto second = static_cast<Joint>(index_of(first) + 5);
        const double from_m = across_m(first, along * end_m);
        const double to_m = across_m(second, along * end_m);
        const auto height_m = [&](double share) {
          return palm_height_m(body, from_m + share * (to_m - from_m), along * end_m);
        };
        // The palm's arch is hollow by less than this. Cones of these radii without triangles
        // between would leave grooves of 1.8 to 4.7 mm.
        for (const double share : {0.25, 0.5, 0.75}) {
          const double chord_m = (1.0 - share) * height_m(0.0) + share * height_m(1.0);
          CHECK(height_m(share) - chord_m < 0.0008);
        }
      }
  }

  TEST_CASE("following a pose and asking for distances does not allocate") {
    std::mt19937 random(17);
    const HandSkeleton skeleton(Side::left);
    const HandPose pose = random_pose(random, skeleton);
    HandBody body(skeleton);
    const test::Restraint restraint;
    body.follow(pose);
    const ClosestPoint near = body.nearest(pose[Joint::palm].translation());
    CHECK(restraint.counts().allocations == 0);
    CHECK(near.distance_m < 0.0);
  }

  TEST_CASE("joints of fingers have the radius of the body around them, in hands of each size") {
    for (const double length_m : {0.15, 0.187, 0.22})
      for (const Side side : {Side::left, Side::right}) {
        const HandSkeleton skeleton(side, {.length_m = length_m});
        const HandPose pose = skeleton.pose({}, Isometry3d::Identity());
        const HandBody body(skeleton);
        const JointRadii radii = joint_radii_m(skeleton);
        for (std::size_t at = 0; at < joint_count; ++at)
          CHECK(radii[at] > 0.005 * length_m / 0.187);
        for (const Joint metacarpal : metacarpals)
          for (std::size_t step = 1; step < (metacarpal == metacarpals[0] ? 3U : 4U); ++step) {
            const Joint joint = joint_after(metacarpal, step);
            // Bones lie nearer to the back of a finger than to its pad, by a millimetre, and
            // knuckles lie in the palm.
            const double depth_m = -body.nearest(pose[joint].translation()).distance_m;
            CHECK(depth_m > radii[index_of(joint)] - 0.0012 * length_m / 0.187);
            CHECK(depth_m < radii[index_of(joint)] + 0.003 * length_m / 0.187);
          }
      }
  }
}

} // namespace hand_body_test
