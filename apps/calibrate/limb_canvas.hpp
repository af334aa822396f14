#pragma once
// Limbs drawn with characters: dots that they cover, the nearer before the farther ones, and of
// these the outlines.

#include <cstdint>
#include <vector>

#include <nendo/hand/skeleton.hpp>

namespace nendo::calibrate {

/// A bone with flesh: what lies within the radius of a line, which shrinks towards its end.
struct Limb {
  Eigen::Vector3d begin, end; ///< x to the right, y up, z towards the viewer; metres
  double begin_radius, end_radius;
  std::uint8_t part; ///< palm or finger, so that what overlaps can be told apart; not `nothing`
};

class LimbCanvas {
public:
  // Dots that a character's cell is sampled with; they are as wide as high.
  static constexpr int dots_across = 4;
  static constexpr int dots_down = 8;
  static constexpr std::uint8_t nothing = 0xFF;

  /// Empty; the origin is its middle. A hand with spread fingers fits.
  LimbCanvas(int columns, int rows);

  void draw(const Limb& limb);

  /// The part that is seen at a dot, from the upper left; `nothing` also outside of the canvas.
  std::uint8_t part(int column, int row) const noexcept;
  /// Where a dot lies.
  Eigen::Vector2d place_m(int column, int row) const noexcept;
  /// The printable character that resembles the outlines within a cell most.
  char character(int column, int row) const;

private:
  struct DotRange {
    int first, last;
  };
  DotRange columns_within(double left_m, double right_m) const noexcept;
  DotRange rows_within(double low_m, double high_m) const noexcept;
  void draw_dot(const Limb& limb, int column, int row);
  bool is_edge(int column, int row) const noexcept;

  int width_, height_; ///< dots
  double metres_a_dot_;
  std::vector<std::uint8_t> parts_;
  std::vector<double> depths_;
};

} // namespace nendo::calibrate
