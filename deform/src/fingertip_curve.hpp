#pragma once
// Type-2's curves (the paper, 2.4): samples of all fingertips joined by one smooth curve, cut at
// constant arc length. A piece of Hermite's cubic leads from each sample to the next; its end
// tangent is that of the parabola through the last three samples, so that no sample has to be
// waited for, and the next piece begins with it.

#include <array>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Lengths are those of the fingertip that goes farthest: none goes farther than a piece between
/// two cuts. A fingertip that turns back has a corner there, and one that stops, stops: no curve
/// leads beyond its samples. Nothing allocates after the constructor, or takes other than bounded
/// time.
class FingertipCurve {
public:
  /// piece_length: > 0, in model units.
  FingertipCurve(Eigen::Index points, double piece_length);

  /// Starts at these fingertips, 3 by points.
  void begin(const Points& tips);
  /// Goes on to `tips`, if a fingertip is at least half a piece from where the curve ends; those
  /// that are nearer than a quarter rest there: trembling makes no way. More than `most_pieces`
  /// pieces are made that many longer ones.
  void extend(const Points& tips);
  /// Goes on to `tips` however near they are; the last cut is there.
  void end_at(const Points& tips);
  /// The next cut, if there is one yet.
  bool next_cut(Points& cut) noexcept;

  /// Where the curve ends, for now.
  const Points& end() const noexcept { return to_; }
  double piece_length() const noexcept { return piece_length_; }

  static constexpr int most_pieces = 16;

private:
  static constexpr std::size_t steps = 8; ///< in which a piece's length is measured

  void lead_to(const Points& tips);
  void set_tangents(double length) noexcept;
  void measure() noexcept;

  double piece_length_;
  double cut_length_ = 0.0;   ///< piece_length_, but for long ways
  Points chord_;              ///< from from_ to to_
  Points scratch_;            ///< where a sample leads
  Points from_, to_;          ///< the last piece of the curve
  Points leaving_, arriving_; ///< its tangents, as dp/du with u from 0 to 1
  Points tangent_;            ///< at to_, by length
  Points slope_, last_slope_; ///< of this piece's chord and the one before, by length
  double last_length_ = 0.0;
  std::array<double, steps + 1> lengths_{}; ///< along it, up to each step
  double position_ = 0.0;                   ///< how far it has been cut
  double carried_ = 0.0; ///< from the last cut to where this piece begins, or has been cut
  bool ends_ = false;
};

} // namespace nendo::deform
