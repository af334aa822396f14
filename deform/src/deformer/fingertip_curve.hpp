#pragma once
// Type-2's curves (the paper, 2.3.2): one smooth curve joins the samples of all fingertips and is
// cut at constant arc length. A cubic Hermite piece leads from each sample to the next. Its end
// tangent is that of the parabola through the last three samples, so that the curve need not wait
// for a later sample; the next piece begins with that tangent.

#include <array>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Lengths are those of the fingertip that goes farthest, so that between two cuts no fingertip
/// goes farther than a piece. A curve has a corner where its fingertip turns back, and it never
/// leads beyond its samples. After the constructor nothing allocates, and every call takes a
/// bounded time.
class FingertipCurve {
public:
  /// piece_length is > 0, in model units.
  FingertipCurve(Eigen::Index points, double piece_length);

  /// Starts at these fingertips, 3 by points.
  void begin(const Points& tips);
  /// Continues to `tips` if a fingertip is at least half a piece away from the curve's end.
  /// Fingertips that are nearer than a quarter of a piece stay, so that trembling does not lengthen
  /// the curve. If this gives more than `max_pieces` pieces, `max_pieces` longer ones are made
  /// instead.
  void extend(const Points& tips);
  /// Continues to `tips`, however near they are. The last cut is there.
  void end_at(const Points& tips);
  /// Writes the next cut. Returns false if there is none yet.
  bool next_cut(Points& cut) noexcept;

  /// Returns the present end of the curve.
  const Points& end() const noexcept { return to_; }

  static constexpr int max_pieces = 16;

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
  Points slope_, last_slope_; ///< chords of this and the previous piece, by length
  double last_length_ = 0.0;
  std::array<double, steps + 1> lengths_{}; ///< along it, up to each step
  double position_ = 0.0;                   ///< how far it has been cut
  double carried_ = 0.0; ///< from the last cut to where this piece begins, or has been cut
  bool ends_ = false;
};

} // namespace nendo::deform
