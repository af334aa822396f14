#include "calibrate/hand_drawing.hpp"

#include <cstdint>

#include "calibrate/limb_canvas.hpp"

namespace nendo::calibrate {
namespace {

using Eigen::Vector3d;
using hand::Joint;

constexpr std::uint8_t palm_part = 0;

} // namespace

std::vector<std::string> draw_hand(const hand::HandPose& pose, Side side, HandView view,
                                   int columns, int rows) {
  const double outwards = side == Side::right ? 1.0 : -1.0; // the little finger's side
  const auto seen_at = [&](const Vector3d& p) -> Vector3d {
    const double up = -p.z() - 0.09; // the middle of the hand
    // OpenXR's +Y comes out of the back of the hand.
    return view == HandView::palm ? Vector3d(-p.x(), up, -p.y())
                                  : Vector3d(outwards * p.y(), up, -outwards * p.x());
  };
  const auto seen = [&](Joint joint) { return seen_at(pose[joint].translation()); };
  LimbCanvas canvas(columns, rows);
  const auto limb = [&](Joint from, Joint to, double from_mm, double to_mm, std::size_t part) {
    canvas.draw(
        {seen(from), seen(to), 1e-3 * from_mm, 1e-3 * to_mm, static_cast<std::uint8_t>(part)});
  };
  canvas.draw({seen_at({0.0, 0.0, 0.03}), seen(Joint::wrist), 0.022, 0.020, palm_part});
  const auto next = [](Joint joint, int steps) {
    return static_cast<Joint>(static_cast<int>(hand::index_of(joint)) + steps);
  };
  for (const Joint base : {Joint::index_metacarpal, Joint::middle_metacarpal,
                           Joint::ring_metacarpal, Joint::little_metacarpal}) {
    limb(Joint::wrist, base, 18, 16, palm_part);
    limb(base, next(base, 1), 14, 11, palm_part);
    const std::size_t part =
        2 + (hand::index_of(base) - hand::index_of(Joint::index_metacarpal)) / 5;
    for (const int bone : {1, 2, 3})
      limb(next(base, bone), next(base, bone + 1), 9.5 - 1.2 * bone, 8.5 - 1.2 * bone, part);
  }
  limb(Joint::thumb_metacarpal, Joint::thumb_proximal, 15, 11, 1);
  limb(Joint::thumb_proximal, Joint::thumb_distal, 10, 9, 1);
  limb(Joint::thumb_distal, Joint::thumb_tip, 9, 7, 1);
  std::vector<std::string> lines;
  for (int row = 0; row < rows; ++row) {
    std::string line;
    for (int column = 0; column < columns; ++column)
      line += canvas.character(column, row);
    lines.push_back(line);
  }
  return lines;
}

} // namespace nendo::calibrate
