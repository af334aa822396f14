#include <map>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

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

} // namespace

TEST_SUITE("hand_skin") {
  TEST_CASE("the skin is closed, faces outwards, and has the joints within and the tips upon it") {
    std::mt19937 random(6);
    for (const Side side : {Side::left, Side::right}) {
      const HandSkin skin(side);
      for (int round = 0; round < 6; ++round) {
        // Hands of other sizes, too, and bent as far as hands bend.
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

        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        for (std::size_t at = 0; at < surface.corners.size(); at += 3)
          for (std::size_t k = 0; k < 3; ++k)
            ++edges[{surface.corners[at + k], surface.corners[at + (k + 1) % 3]}];
        int open = 0;
        for (const auto& [edge, count] : edges) {
          const auto back = edges.find({edge.second, edge.first});
          open += back == edges.end() || back->second != count ? 1 : 0;
        }
        CHECK(open == 0);
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
    CHECK(worst < 0.0035); // a cell of the net
  }
}

} // namespace hand_skin_test
