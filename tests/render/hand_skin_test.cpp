#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/hand_body.hpp>

#include "render/hand_skin.hpp"

namespace hand_skin_test {

using namespace nendo;
using namespace nendo::render;

namespace {

// How often a closed surface goes round a point: by the solid angles of its triangles (A. van
// Oosterom, J. Strackee, "The solid angle of a plane triangle", 1983).
double turns_round(const Surface& surface, const Eigen::Vector3d& point) {
  double sum = 0.0;
  for (std::size_t at = 0; at < surface.corners.size(); at += 3) {
    std::array<Eigen::Vector3d, 3> r;
    for (std::size_t k = 0; k < 3; ++k)
      r[k] = surface.places[surface.corners[at + k]].cast<double>() - point;
    const double a = r[0].norm();
    const double b = r[1].norm();
    const double c = r[2].norm();
    sum +=
        2.0 * std::atan2(r[0].dot(r[1].cross(r[2])),
                         a * b * c + r[0].dot(r[1]) * c + r[0].dot(r[2]) * b + r[1].dot(r[2]) * a);
  }
  return sum / (4.0 * std::numbers::pi);
}

double distance_from(const Surface& surface, const Eigen::Vector3d& point) {
  double least = 1e9;
  for (const auto& place : surface.places)
    least = std::min(least, (place.cast<double>() - point).norm());
  return least;
}

using Edges = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

// How often each edge is run along, in that direction.
Edges edges_of(const Surface& surface) {
  Edges edges;
  for (std::size_t at = 0; at < surface.corners.size(); at += 3)
    for (std::size_t k = 0; k < 3; ++k)
      ++edges[{surface.corners[at + k], surface.corners[at + (k + 1) % 3]}];
  return edges;
}

// By the divergence theorem: the sum of the tetrahedra to the origin.
double volume_of(const Surface& surface) {
  double sum = 0.0;
  for (std::size_t at = 0; at < surface.corners.size(); at += 3) {
    const auto corner = [&](std::size_t k) {
      return Eigen::Vector3d(surface.places[surface.corners[at + k]].cast<double>());
    };
    sum += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
  }
  return sum;
}

Surface draped(const HandSkin& skin, Side side, const hand::JointAngles& angles) {
  Surface surface;
  skin.drape(hand::HandSkeleton(side).pose(angles, Eigen::Isometry3d::Identity()),
             Eigen::Vector3d::Zero(), surface);
  return surface;
}

hand::JointAngles fist() {
  hand::JointAngles angles;
  for (auto& finger : angles.fingers)
    finger = {1.5, 0.0, 1.8, 1.1};
  angles.thumb_roll_rad = 1.1;
  angles.thumb_abduction_rad = 0.25;
  angles.thumb_mcp_flexion_rad = 0.6;
  angles.thumb_ip_flexion_rad = 0.9;
  angles.palm_arch_rad = 0.15;
  return angles;
}

} // namespace

TEST_SUITE("hand_skin") {
  TEST_CASE("the skin is closed, faces outwards, and has the joints within and the tips upon it") {
    std::mt19937 random(6);
    for (const Side side : {Side::left, Side::right}) {
      const HandSkin skin(side);
      for (int round = 0; round < 6; ++round) {
        // Hands of other sizes, and bent as far as hands bend.
        const hand::HandSkeleton skeleton(side, {0.16 + 0.01 * round, 0.075 + 0.004 * round});
        hand::JointAngles angles;
        std::uniform_real_distribution<double> bend(0.0, 1.0);
        for (auto& finger : angles.fingers)
          finger = {bend(random), 0.1 * bend(random), bend(random), 0.5 * bend(random)};
        angles.thumb_roll_rad = 0.5 * bend(random);
        angles.thumb_mcp_flexion_rad = 0.6 * bend(random);
        Eigen::Isometry3d T_world_wrist = Eigen::Isometry3d::Identity();
        T_world_wrist.translation() << 0.2, 1.0, -0.3;
        T_world_wrist.rotate(Eigen::AngleAxisd(bend(random), Eigen::Vector3d::UnitY()));
        const auto pose = skeleton.pose(angles, T_world_wrist);
        const Eigen::Vector3d origin(0.1, 0.5, 0.0);
        Surface surface;
        skin.drape(pose, origin, surface);

        const Edges edges = edges_of(surface);
        int open = 0;
        for (const auto& [edge, count] : edges)
          open += count != 1 || !edges.contains({edge.second, edge.first}) ? 1 : 0;
        CHECK(open == 0); // two triangles at each edge
        for (std::size_t at = 0; at < hand::joint_count; ++at) {
          const auto joint = static_cast<hand::Joint>(at);
          const Eigen::Vector3d place = pose[joint].translation() - origin;
          CAPTURE(name_of(joint));
          if (std::find(hand::fingertips.begin(), hand::fingertips.end(), joint) !=
              hand::fingertips.end()) {
            CHECK(distance_from(surface, place) < 0.004);
          } else {
            CHECK(turns_round(surface, place) > 0.5); // positive: outwards
          }
        }
        for (const auto& normal : surface.normals)
          REQUIRE(std::abs(static_cast<double>(normal.norm()) - 1.0) < 1e-4);
      }
    }
  }

  TEST_CASE("a left hand's skin is the mirror image of a right hand's") {
    std::array<Surface, 2> skins;
    for (const Side side : {Side::left, Side::right})
      HandSkin(side).drape(hand::HandSkeleton(side).pose({}, Eigen::Isometry3d::Identity()),
                           Eigen::Vector3d::Zero(), skins[side == Side::left ? 0 : 1]);
    double worst = 0.0;
    for (const auto& place : skins[0].places)
      worst = std::max(worst, distance_from(skins[1], {-static_cast<double>(place.x()),
                                                       static_cast<double>(place.y()),
                                                       static_cast<double>(place.z())}));
    CHECK(worst < 1e-5);
  }

  TEST_CASE("the skin is one piece without holes: no finger has grown onto another one") {
    const HandSkin skin(Side::right);
    Surface surface;
    skin.drape(HandSkin::bind_pose(Side::right), Eigen::Vector3d::Zero(), surface);
    CHECK(surface.places.size() >= 3000);
    CHECK(surface.places.size() <= 6000);
    const Edges edges = edges_of(surface);
    // Euler: a sphere's number is 2, and each bridge between two fingers takes 2 away.
    const auto faces = static_cast<long>(surface.corners.size() / 3);
    CHECK(static_cast<long>(surface.places.size()) - static_cast<long>(edges.size() / 2) + faces ==
          2);
    std::vector<std::uint32_t> piece(surface.places.size());
    std::iota(piece.begin(), piece.end(), 0U);
    const auto first_of = [&](std::uint32_t at) {
      while (piece[at] != at)
        at = piece[at] = piece[piece[at]];
      return at;
    };
    for (const auto& [edge, count] : edges)
      piece[first_of(edge.first)] = first_of(edge.second);
    for (std::uint32_t at = 0; at < piece.size(); ++at)
      REQUIRE(first_of(at) == first_of(0));
  }

  TEST_CASE("weights sum to 1, change smoothly, and beyond the knuckles are of one finger") {
    const HandSkin skin(Side::left);
    const Surface surface = draped(skin, Side::left, {});
    std::vector<std::array<double, hand::joint_count>> weights(surface.places.size());
    for (std::size_t at = 0; at < weights.size(); ++at) {
      weights[at].fill(0.0);
      double sum = 0.0;
      for (const auto& [joint, weight] : skin.influences(at)) {
        REQUIRE(weight >= 0.0F);
        weights[at][hand::index_of(joint)] += static_cast<double>(weight);
        sum += static_cast<double>(weight);
      }
      REQUIRE(sum == doctest::Approx(1.0).epsilon(1e-5));
      int fingers = 0;
      for (const auto tip : hand::fingertips)
        fingers +=
            weights[at][hand::index_of(tip) - 1] + weights[at][hand::index_of(tip) - 2] > 0.05;
      // The joint before the thumb's last one is its knuckle.
      REQUIRE(fingers <= 1);
    }
    double worst = 0.0;
    for (const auto& [edge, count] : edges_of(surface))
      for (std::size_t joint = 0; joint < hand::joint_count; ++joint)
        worst = std::max(worst, std::abs(weights[edge.first][joint] - weights[edge.second][joint]));
    CHECK(worst < 0.4);
  }

  TEST_CASE("a fist has about the flat hand's volume, and so has a bigger hand's, to its scale") {
    const HandSkin skin(Side::right);
    const double flat = volume_of(draped(skin, Side::right, {}));
    // Hands of 187 mm displace some 350 to 450 ml up to the wrist; here is some forearm.
    CHECK(flat > 300e-6);
    CHECK(flat < 600e-6);
    const double bent = volume_of(draped(skin, Side::right, fist()));
    CHECK(bent > 0.93 * flat);
    CHECK(bent < 1.07 * flat);
    Surface large;
    const hand::HandSize size{1.2 * 0.187, 1.2 * 0.083};
    skin.drape(hand::HandSkeleton(Side::right, size).pose({}, Eigen::Isometry3d::Identity()),
               Eigen::Vector3d::Zero(), large);
    CHECK(volume_of(large) == doctest::Approx(1.728 * flat).epsilon(0.001));
  }

  TEST_CASE("a twisted joint keeps its thickness, which linear mixing would take from it") {
    const HandSkin skin(Side::right);
    hand::HandPose pose = HandSkin::bind_pose(Side::right);
    const auto twisted = pose[hand::Joint::index_distal];
    const Eigen::Vector3d axis = twisted.linear().col(2);
    const Eigen::Vector3d place = twisted.translation();
    const auto thickness = [&](HandSkin::Mix mix) {
      Surface surface;
      skin.drape(pose, Eigen::Vector3d::Zero(), surface, mix);
      double least = 1.0;
      for (std::size_t at = 0; at < surface.places.size(); ++at) {
        const Eigen::Vector3d from = surface.places[at].cast<double>() - place;
        if (std::abs(from.dot(axis)) < 0.003 && from.norm() < 0.02)
          least = std::min(least, from.cross(axis).norm());
      }
      return least;
    };
    const double before = thickness(HandSkin::Mix::screws);
    CHECK(before == doctest::Approx(thickness(HandSkin::Mix::linear)).epsilon(1e-4));
    CHECK(before > 0.005);
    for (const hand::Joint joint : {hand::Joint::index_distal, hand::Joint::index_tip})
      pose.joints[hand::index_of(joint)] = Eigen::Translation3d(place) *
                                           Eigen::AngleAxisd(2.5, axis) *
                                           Eigen::Translation3d(-place) * pose[joint];
    CHECK(thickness(HandSkin::Mix::screws) > 0.9 * before);
    CHECK(thickness(HandSkin::Mix::linear) < 0.6 * before);
  }

  TEST_CASE("the body that presses lies close to the skin that is drawn") {
    for (const Side side : {Side::left, Side::right}) {
      const HandSkin skin(side);
      const hand::HandSkeleton skeleton(side);
      hand::JointAngles angles;
      for (const double bend_rad : {0.05, 0.5}) {
        for (auto& finger : angles.fingers)
          finger = {bend_rad, 0.0, bend_rad, bend_rad};
        const hand::HandPose pose = skeleton.pose(angles, Eigen::Isometry3d::Identity());
        hand::HandBody body(skeleton);
        body.follow(pose);
        Surface surface;
        skin.drape(pose, Eigen::Vector3d::Zero(), surface);
        std::vector<double> distances_m;
        for (const auto& place : surface.places) {
          if (place.z() > -0.03F) continue; // the wrist and the forearm do not press
          distances_m.push_back(std::abs(body.nearest(place.cast<double>()).distance_m));
        }
        REQUIRE(distances_m.size() > 1000);
        std::sort(distances_m.begin(), distances_m.end());
        CHECK(distances_m[distances_m.size() / 2] < 0.0015);
        CHECK(distances_m[distances_m.size() * 95 / 100] < 0.006);
      }
    }
  }
}

} // namespace hand_skin_test
