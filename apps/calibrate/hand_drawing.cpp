#include "calibrate/hand_drawing.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace nendo::calibrate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using hand::Joint;

/// The dots that a character covers, row by row from the top. A row has four bits, of which the
/// highest is the dot on the left.
struct Glyph {
  char character;
  std::array<std::uint8_t, LimbCanvas::dots_down> rows;
};
constexpr std::array<Glyph, 14> glyphs{{
    {'|', {6, 6, 6, 6, 6, 6, 6, 6}},
    {'-', {0, 0, 0, 15, 15, 0, 0, 0}},
    {'_', {0, 0, 0, 0, 0, 0, 15, 15}},
    {'/', {1, 1, 2, 2, 4, 4, 8, 8}},
    {'\\', {8, 8, 4, 4, 2, 2, 1, 1}},
    {'(', {2, 4, 8, 8, 8, 8, 4, 2}},
    {')', {4, 2, 1, 1, 1, 1, 2, 4}},
    {'.', {0, 0, 0, 0, 0, 0, 6, 6}},
    {'\'', {6, 6, 6, 0, 0, 0, 0, 0}},
    {',', {0, 0, 0, 0, 0, 6, 6, 4}},
    {'`', {12, 6, 0, 0, 0, 0, 0, 0}},
    {'~', {0, 0, 0, 5, 10, 0, 0, 0}},
    {'+', {0, 6, 6, 15, 15, 6, 6, 0}},
    {'"', {15, 9, 9, 0, 0, 0, 0, 0}},
}};

/// Safe for any double: a NaN becomes 0.
int dot_of(double place, int most) {
  return place > 0.0 ? static_cast<int>(std::min(place, static_cast<double>(most))) : 0;
}

} // namespace

LimbCanvas::LimbCanvas(int columns, int rows)
    : width_(columns * dots_across), height_(rows * dots_down),
      parts_(static_cast<std::size_t>(width_ * height_), nothing),
      depths_(parts_.size(), -std::numeric_limits<double>::infinity()) {
  // A hand with spread fingers is as wide as it is long. The wrist must fit.
  metres_a_dot_ = std::max(0.235 / height_, 0.21 / width_);
}

Vector2d LimbCanvas::place_m(int column, int row) const noexcept {
  return {(column - 0.5 * width_) * metres_a_dot_, (0.5 * height_ - row) * metres_a_dot_};
}

void LimbCanvas::draw(const Limb& limb) {
  const double radius = std::max(limb.begin_radius, limb.end_radius);
  const auto low = limb.begin.cwiseMin(limb.end).eval();
  const auto high = limb.begin.cwiseMax(limb.end).eval();
  // The ranges have a dot more at either end, because of rounding.
  const auto column_of = [&](double x_m) { return x_m / metres_a_dot_ + 0.5 * width_; };
  const auto row_of = [&](double y_m) { return 0.5 * height_ - y_m / metres_a_dot_; };
  const int right = dot_of(column_of(high.x() + radius) + 2.0, width_ - 1);
  const int bottom = dot_of(row_of(low.y() - radius) + 2.0, height_ - 1);
  for (int row = dot_of(row_of(high.y() + radius) - 1.0, height_); row <= bottom; ++row)
    for (int column = dot_of(column_of(low.x() - radius) - 1.0, width_); column <= right; ++column)
      draw_dot(limb, column, row);
}

void LimbCanvas::draw_dot(const Limb& limb, int column, int row) {
  const Vector2d at = place_m(column, row);
  const Vector2d along = (limb.end - limb.begin).head<2>();
  const double length2 = along.squaredNorm();
  const double part =
      length2 > 0.0 ? std::clamp((at - limb.begin.head<2>()).dot(along) / length2, 0.0, 1.0) : 0.0;
  const double radius = limb.begin_radius + part * (limb.end_radius - limb.begin_radius);
  const double off2 = (at - limb.begin.head<2>() - part * along).squaredNorm();
  if (!(off2 <= radius * radius)) return; // also if it is not a number
  const double depth =
      limb.begin.z() + part * (limb.end.z() - limb.begin.z()) + std::sqrt(radius * radius - off2);
  const std::size_t dot = dot_index(column, row);
  if (depth <= depths_[dot]) return;
  depths_[dot] = depth;
  parts_[dot] = limb.part;
}

char LimbCanvas::character(int column, int row) const {
  std::array<std::uint8_t, dots_down> edges{};
  int count = 0;
  for (int y = 0; y < dots_down; ++y)
    for (int x = 0; x < dots_across; ++x) {
      if (!is_edge(column * dots_across + x, row * dots_down + y)) continue;
      edges[static_cast<std::size_t>(y)] |= static_cast<std::uint8_t>(8 >> x);
      ++count;
    }
  if (count < 3) return ' ';
  const auto distance = [&](const Glyph& glyph) {
    int differing = 0;
    for (std::size_t y = 0; y < edges.size(); ++y)
      differing += std::popcount(static_cast<unsigned>(edges[y] ^ glyph.rows[y]));
    return differing;
  };
  return std::min_element(
             glyphs.begin(), glyphs.end(),
             [&](const Glyph& one, const Glyph& other) { return distance(one) < distance(other); })
      ->character;
}

std::size_t LimbCanvas::dot_index(int column, int row) const noexcept {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
         static_cast<std::size_t>(column);
}

std::uint8_t LimbCanvas::part(int column, int row) const noexcept {
  if (column < 0 || row < 0 || column >= width_ || row >= height_) return nothing;
  return parts_[dot_index(column, row)];
}

bool LimbCanvas::is_edge(int column, int row) const noexcept {
  const std::uint8_t here = part(column, row);
  return part(column + 1, row) != here || part(column, row + 1) != here ||
         part(column - 1, row) != here || part(column, row - 1) != here;
}

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
  constexpr std::uint8_t palm_part = 0;
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
