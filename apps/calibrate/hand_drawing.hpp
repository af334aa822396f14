#pragma once
// Draws hands with characters. A limb covers dots, where nearer limbs hide farther ones; the
// characters show the outlines of the covered areas.

#include <cstdint>
#include <string>
#include <vector>

#include <nendo/hand/skeleton.hpp>

namespace nendo::calibrate {

/// A bone with flesh: everything within a radius of a line. The radius changes from `begin_radius`
/// to `end_radius` along the line.
struct Limb {
  Eigen::Vector3d begin, end; ///< x to the right, y up, z towards the viewer; metres
  double begin_radius, end_radius;
  std::uint8_t part; ///< palm or finger, to distinguish overlapping limbs; not `nothing`
};

class LimbCanvas {
public:
  // The number of dots in a character's cell. The dots are as wide as high.
  static constexpr int dots_across = 4;
  static constexpr int dots_down = 8;
  static constexpr std::uint8_t nothing = 0xFF;

  /// Makes an empty canvas with the origin in its middle. A hand with spread fingers fits.
  LimbCanvas(int columns, int rows);

  void draw(const Limb& limb);

  /// Returns the part that is seen at a dot, counted from the upper left; `nothing` also outside of
  /// the canvas.
  std::uint8_t part(int column, int row) const noexcept;
  Eigen::Vector2d place_m(int column, int row) const noexcept;
  /// Returns the printable character that most resembles the outlines within a cell.
  char character(int column, int row) const;

private:
  void draw_dot(const Limb& limb, int column, int row);
  bool is_edge(int column, int row) const noexcept;
  std::size_t dot_index(int column, int row) const noexcept;

  int width_, height_; ///< dots
  double metres_a_dot_;
  std::vector<std::uint8_t> parts_;
  std::vector<double> depths_;
};

/// From where a drawing shows the hand; the fingers of a flat hand point up in all of them.
enum class HandView {
  palm, ///< as one sees one's own palm
  side, ///< from the thumb's side
};

/// Returns `rows` lines of `columns` printable ASCII characters. The forearm of `pose` must end at
/// the origin and point along -Z. The hand is centred, and drawn so large that a flat hand with
/// spread fingers fits. Characters are taken to be twice as high as wide.
std::vector<std::string> draw_hand(const hand::HandPose& pose, Side side, HandView view,
                                   int columns, int rows);

} // namespace nendo::calibrate
