#include "studio/calibration_scene.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "viewer/pointing.hpp"

namespace nendo::studio {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using hand::Joint;
using hand::PoseId;
using render::Material;
using render::Surface;

// Linear colours.
const Material live_skin{{0.52F, 0.42F, 0.36F}, 0.10F};
const Vector3f wrong{0.80F, 0.16F, 0.02F}, right{0.10F, 0.50F, 0.12F}, way{0.95F, 0.30F, 0.02F};
const Material shell{{0.10F, 0.28F, 0.62F}, 0.0F, 0.20F, 0.75F, 0.0F, 0.0F, false, true};
const Material glass{{0.33F, 0.345F, 0.37F}, 0.05F, 0.30F, 0.85F, 0.0F, 0.0F, false, true};
const Material arrow_look{way, 0.20F, 1.0F, 1.0F, 0.0F, 0.0F, false, true};

constexpr float arrow_width_m = 0.008F;

/// Returns the finger whose joints carry a place beyond its knuckle.
std::optional<std::size_t> finger_of(Joint joint) noexcept {
  const std::size_t at = index_of(joint);
  if (at <= index_of(Joint::thumb_metacarpal)) return std::nullopt;
  if (at <= index_of(Joint::thumb_tip)) return 0;
  const std::size_t from_index = at - index_of(Joint::index_metacarpal);
  if (from_index % 5 == 0) return std::nullopt; // in the palm
  return 1 + from_index / 5;
}

/// As seen by the right hand's wearer: degrees from the view of the own palm towards the view from
/// the thumb's side.
struct OwnView {
  double to_thumb_deg, elevation_deg;
};
OwnView own_view_of(PoseId pose) noexcept {
  switch (pose) {
  case PoseId::flat:
  case PoseId::spread:
  case PoseId::thumb_out:
  case PoseId::wrist_inwards:
  case PoseId::wrist_outwards:
    return {180.0, -8.0}; // the back of a hand on the table
  case PoseId::table_top:
  case PoseId::hook:
  case PoseId::straight_fist:
  case PoseId::wrist_down:
  case PoseId::wrist_back:
    return {68.0, 6.0};
  case PoseId::thumb_up:
  case PoseId::pinch_index:
  case PoseId::pinch_index_flat:
    return {58.0, 8.0};
  case PoseId::edge_index:
    return {100.0, 8.0};
  case PoseId::edge_little:
    return {-75.0, 8.0};
  case PoseId::fist:
  case PoseId::point:
  case PoseId::two:
  case PoseId::three:
  case PoseId::pinch_middle:
  case PoseId::pinch_ring:
    return {38.0, 8.0};
  case PoseId::thumb_across:
  case PoseId::thumb_bent:
  case PoseId::pinch_little:
    break;
  }
  return {18.0, 6.0};
}

} // namespace

Vector3d place_of(Sensor sensor, const hand::HandPose& pose) {
  const auto at = [&](Joint joint) -> Vector3d { return pose[joint].translation(); };
  const auto between = [&](Joint one, Joint other) -> Vector3d {
    return 0.5 * (at(one) + at(other));
  };
  // The web of two fingers, beyond their knuckles.
  const auto web = [&](Joint one, Joint other) -> Vector3d {
    return between(one, other) + pose[Joint::wrist].linear() * Vector3d(0.0, 0.0, -0.018);
  };
  switch (sensor) {
  case Sensor::thumb_roll:
    return at(Joint::thumb_metacarpal);
  case Sensor::thumb_abduction:
    return between(Joint::thumb_proximal, Joint::index_proximal);
  case Sensor::thumb_mcp:
    return at(Joint::thumb_proximal);
  case Sensor::thumb_ip:
    return at(Joint::thumb_distal);
  case Sensor::index_middle_abduction:
    return web(Joint::index_proximal, Joint::middle_proximal);
  case Sensor::middle_ring_abduction:
    return web(Joint::middle_proximal, Joint::ring_proximal);
  case Sensor::ring_little_abduction:
    return web(Joint::ring_proximal, Joint::little_proximal);
  case Sensor::palm_arch:
    return between(Joint::little_metacarpal, Joint::little_proximal);
  case Sensor::wrist_pitch:
  case Sensor::wrist_yaw: {
    const double aside_m = sensor == Sensor::wrist_pitch ? -0.012 : 0.012;
    return pose[Joint::wrist] * Vector3d(aside_m, 0.0, 0.0);
  }
  default:
    break;
  }
  for (std::size_t finger = 0; finger < finger_sensors.size(); ++finger)
    for (std::size_t joint = 0; joint < 3; ++joint)
      if (finger_sensors[finger][joint] == sensor)
        return at(joint_after(hand::metacarpals[finger + 1], joint + 1));
  return at(Joint::palm);
}

Eigen::Isometry3d upright(const Vector3d& wrist_m) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, -1.0, 0.0;
  pose.translation() = wrist_m;
  return pose;
}

render::View view_of(PoseId pose, Side side) noexcept {
  const OwnView own = own_view_of(pose);
  return {side == Side::right ? own.to_thumb_deg : -own.to_thumb_deg, own.elevation_deg};
}

render::Camera camera_for(const render::View& view, double width_m, double aspect) noexcept {
  render::Camera camera;
  camera.view = view;
  camera.target = {0.0, middle_height_m, 0.0};
  const double height_m = std::max(picture_height_m, width_m / std::max(aspect, 0.2));
  camera.distance_m = height_m / (2.0 * camera.tangent());
  return camera;
}

void turn_towards(render::Camera& camera, const render::View& view, double elapsed_s) noexcept {
  constexpr double time_constant_s = 0.15;
  const double share = 1.0 - std::exp(-elapsed_s / time_constant_s);
  const double turn_deg = std::remainder(view.azimuth_deg - camera.view.azimuth_deg, 360.0);
  camera.view.azimuth_deg = std::remainder(camera.view.azimuth_deg + share * turn_deg, 360.0);
  camera.view.elevation_deg += share * (view.elevation_deg - camera.view.elevation_deg);
}

std::vector<Surface> HandPainter::draw(const ShownHand& hand) const {
  constexpr float shell_m = 0.0018F; // outside of a hand that is in the pose
  if (hand.look == ShownHand::Look::live) return live(hand);
  const bool is_ghost = hand.look == ShownHand::Look::ghost;
  std::vector<Surface> surfaces{{{}, {}, {}, is_ghost ? shell : glass}};
  Surface& surface = surfaces[0];
  skin_.drape(hand.pose, Vector3d::Zero(), surface);
  for (std::size_t at = 0; is_ghost && at < surface.places.size(); ++at)
    surface.places[at] += shell_m * surface.normals[at];
  return surfaces;
}

std::vector<Surface> HandPainter::live(const ShownHand& hand) const {
  Surface whole{{}, {}, {}, live_skin};
  skin_.drape(hand.pose, Vector3d::Zero(), whole);
  const auto is_marked = [&](std::span<const std::uint32_t, 3> corners) {
    const auto finger = finger_of(skin_.influences(corners[0])[0].joint);
    return finger && hand.marked[*finger];
  };
  return {part_of(whole, live_skin, std::not_fn(is_marked)),
          part_of(whole, Material{mark_colour(hand.is_wrong), 0.10F}, is_marked)};
}

std::vector<Surface> HandPainter::balls(const std::vector<JointMark>& joints) {
  std::vector<Surface> surfaces;
  for (const auto certainty : {calibrate::Certainty::sure, calibrate::Certainty::less_sure,
                               calibrate::Certainty::average, calibrate::Certainty::estimated}) {
    Surface balls{{}, {}, {}, Material{colour_of(certainty), 0.2F}};
    for (const JointMark& joint : joints)
      if (joint.certainty == certainty)
        add_sphere(balls, joint.place_m.cast<float>(), static_cast<float>(ball_radius_m), 14);
    if (!balls.is_empty()) surfaces.push_back(std::move(balls));
  }
  return surfaces;
}

const JointMark* mark_at(const Eigen::Vector2d& pixel, const render::Camera& camera,
                         render::Size size, const std::vector<JointMark>& joints) {
  const Vector3d aside = ball_radius_m * camera.axes().row(0).transpose();
  const JointMark* nearest = nullptr;
  double least = 1.0; // of a ball's radius
  for (const JointMark& joint : joints) {
    const auto middle = viewer::pixel_of(camera, joint.place_m, size);
    const auto edge = viewer::pixel_of(camera, joint.place_m + aside, size);
    if (!middle || !edge) continue;
    const double share = (pixel - *middle).norm() / (*edge - *middle).norm();
    if (share >= least) continue;
    least = share;
    nearest = &joint;
  }
  return nearest;
}

Ways ways(const hand::HandPose& live, const hand::HandPose& asked, const Fingers& marked) {
  constexpr double visible_m = 0.015;
  Ways found;
  const auto from = live.fingertip_positions(), to = asked.fingertip_positions();
  for (std::size_t finger = 0; finger < marked.size(); ++finger) {
    const auto at = static_cast<Eigen::Index>(finger);
    if (marked[finger] && (to.col(at) - from.col(at)).norm() >= visible_m)
      found.emplace_back(from.col(at), to.col(at));
  }
  return found;
}

Surface arrows(const Ways& ways) {
  Surface surface{{}, {}, {}, arrow_look};
  for (const auto& [from, to] : ways)
    add_arrow(surface, from.cast<float>(), to.cast<float>(), arrow_width_m);
  return surface;
}

Vector3f way_colour() noexcept {
  return way;
}

Vector3f mark_colour(bool is_wrong) noexcept {
  return is_wrong ? wrong : right;
}

Vector3f colour_of(calibrate::Certainty certainty) noexcept {
  switch (certainty) {
  case calibrate::Certainty::sure:
    return {0.05F, 0.42F, 0.10F};
  case calibrate::Certainty::less_sure:
    return {0.85F, 0.50F, 0.02F};
  case calibrate::Certainty::average:
    return {0.30F, 0.30F, 0.32F};
  case calibrate::Certainty::estimated:
    break;
  }
  return {0.70F, 0.04F, 0.03F};
}

} // namespace nendo::studio
