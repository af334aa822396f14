#include <nendo/flow/hand_contact.hpp>

#include <algorithm>
#include <array>
#include <cassert>

namespace nendo::flow {

void contact_parts(hand::HandBody& body, const hand::HandPose& pose, double units_per_metre,
                   std::span<deform::ContactPart> parts) noexcept {
  assert(parts.size() == hand::HandBody::part_count);
  body.follow(pose);
  for (std::size_t at = 0; at < parts.size(); ++at) {
    const hand::BodyPart& from = body.parts()[at];
    deform::ContactPart& part = parts[at];
    part.corner_count = from.corner_count;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      part.corners[corner] = units_per_metre * from.corners_m[corner];
      part.radii[corner] = units_per_metre * from.radii_m[corner];
    }
    part.frame = pose[from.carrier];
    part.frame.translation() *= units_per_metre;
  }
}

Eigen::Isometry3d beside(const deform::Mesh& model, double units_per_metre,
                         const hand::HandSkeleton& skeleton, const hand::JointAngles& angles,
                         const Eigen::Isometry3d& T_stage_wrist, double clear_m) {
  constexpr Eigen::Index max_looked_at = 4000;
  constexpr int max_moves = 60;
  const Eigen::Index vertices = model.vertices.cols();
  if (vertices == 0) return T_stage_wrist;
  const Eigen::Vector3d low = model.vertices.rowwise().minCoeff();
  const Eigen::Vector3d high = model.vertices.rowwise().maxCoeff();
  const Eigen::Vector3d middle = 0.5 / units_per_metre * (low + high);
  Eigen::Isometry3d wrist = T_stage_wrist;
  const Eigen::Vector3d palm =
      skeleton.pose(angles, wrist)[hand::Joint::middle_proximal].translation();
  Eigen::Vector3d away = palm - middle;
  if (!(away.norm() > 0.0)) away = Eigen::Vector3d::UnitX();
  away.normalize();
  hand::HandBody body(skeleton);
  for (int move = 0; move < max_moves; ++move) {
    body.follow(skeleton.pose(angles, wrist));
    double min_m = clear_m;
    for (Eigen::Index at = 0; at < vertices;
         at += std::max<Eigen::Index>(1, vertices / max_looked_at))
      min_m = std::min(min_m, body.nearest(model.vertices.col(at) / units_per_metre).distance_m);
    if (min_m >= clear_m) break;
    wrist.translation() += (clear_m - min_m + 1e-4) * away;
  }
  return wrist;
}

/// Two large triangles, of which the other parts are corners.
static void place_table(const Table& table, double units_per_metre,
                        std::span<deform::ContactPart> parts) {
  constexpr double half_thickness_m = 0.010;
  const double thick = half_thickness_m * units_per_metre;
  const auto corner = [&](double x, double z) {
    return Eigen::Vector3d(table.top.x() + x * table.half_side, table.top.y() - thick,
                           table.top.z() + z * table.half_side);
  };
  constexpr std::array sides{1.0, -1.0};
  for (std::size_t at = 0; at < parts.size(); ++at) {
    deform::ContactPart& part = parts[at];
    part.corner_count = at < sides.size() ? 3 : 2;
    const double side = sides[at % sides.size()];
    part.corners = {corner(-1.0, -1.0), corner(1.0, 1.0), corner(side, -side)};
    if (part.corner_count == 2) part.corners[1] = part.corners[0];
    part.radii = {thick, thick, thick};
    part.frame.setIdentity();
  }
}

HandBodies::HandBodies(std::span<const hand::HandSkeleton> hands, double units_per_metre,
                       const Table& table)
    : parts_((hands.size() + tables) * hand::HandBody::part_count), table_(table),
      units_per_metre_(units_per_metre) {
  place_table(table, units_per_metre, std::span(parts_).last(hand::HandBody::part_count));
  for (const hand::HandSkeleton& skeleton : hands) {
    bodies_.emplace_back(skeleton);
    follow(bodies_.size() - 1, skeleton.pose({}, Eigen::Isometry3d::Identity()));
  }
}

void HandBodies::follow(std::size_t hand, const hand::HandPose& pose) noexcept {
  constexpr std::size_t parts = hand::HandBody::part_count;
  contact_parts(bodies_[hand], pose, units_per_metre_,
                std::span(parts_).subspan(hand * parts, parts));
}

std::shared_ptr<HandBodies>
make_bodies(const std::array<std::optional<hand::HandSkeleton>, 2>& by_side,
            const deform::Mesh& model, double units_per_metre, const std::optional<Table>& table) {
  std::vector<hand::HandSkeleton> hands;
  for (const auto& hand : by_side)
    if (hand) hands.push_back(*hand);
  return std::make_shared<HandBodies>(hands, units_per_metre,
                                      table ? *table : table_under(model, units_per_metre));
}

} // namespace nendo::flow
