#include "studio/page_figures.hpp"

#include <cmath>

#include <nendo/flow/placement.hpp>

namespace nendo::studio {
namespace {

/// Rounded, because a message that is the same as before is not sent.
double rounded(double number) {
  return std::round(1e5 * number) / 1e5;
}

nlohmann::ordered_json numbers_of(const Eigen::Vector3d& place) {
  return {rounded(place.x()), rounded(place.y()), rounded(place.z())};
}

} // namespace

void PageFigures::add(Side side, const hand::HandPose& pose, Look look) {
  constexpr const char* looks[] = {"live", "ghost", "glass"};
  auto joints = nlohmann::ordered_json::array();
  for (const Eigen::Isometry3d& joint : pose.joints) {
    const Eigen::Quaterniond turn(joint.linear());
    joints.push_back(
        {{"place", numbers_of(joint.translation())},
         {"turn", {rounded(turn.x()), rounded(turn.y()), rounded(turn.z()), rounded(turn.w())}}});
  }
  whole_["hands"].push_back({{"side", name_of(side)},
                             {"look", looks[static_cast<std::size_t>(look)]},
                             {"joints", std::move(joints)}});
}

void PageFigures::add(const render::SceneFrame& frame) {
  for (const Side side : {Side::left, Side::right})
    if (const auto& hand = frame.hands[flow::Placement::index_of(side)])
      add(side, hand->pose, hand->silent ? Look::glass : Look::live);
}

void PageFigures::add_mark(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius_m,
                           const Eigen::Vector3f& colour) {
  whole_["marks"].push_back({{"from", numbers_of(from)},
                             {"to", numbers_of(to)},
                             {"radius", radius_m},
                             {"colour", {colour.x(), colour.y(), colour.z()}}});
}

void PageFigures::look_by(const render::View& view, double width_m, double height_m,
                          double middle_m) {
  whole_["view"] = {{"azimuth", view.azimuth_deg},
                    {"elevation", view.elevation_deg},
                    {"low", {-width_m / 2.0, middle_m - height_m / 2.0, 0.0}},
                    {"high", {width_m / 2.0, middle_m + height_m / 2.0, 0.0}}};
}

} // namespace nendo::studio
