#pragma once
// Fingertips whose paths cross have no injective map. Pairs of them are held at a least gap: when a
// pair comes to it, a wall stands between the two, across the line that joins them. Neither the one
// nor the other goes through; along the wall both slide freely. Each gives way by the same amount.

#include <span>
#include <vector>

#include <nendo/deform/injective_chain.hpp>

namespace nendo::deform {

/// A wall depends continuously on the path that meets it, and yields to a path that only grazes it:
/// what the pair is kept from grows from nothing and falls to nothing again. Walls stand until the
/// pair is told to go apart again along the normal.
class LeastGap {
public:
  /// fraction: of the smaller radius of the two. Points that start nearer get half their distance;
  /// points that coincide are never held, they move together.
  explicit LeastGap(double fraction) noexcept : fraction_(fraction) {}

  /// Allocates for this many points.
  void reserve(Eigen::Index points);
  /// Takes the walls down. No allocation up to the number reserved, as with all that follow.
  void begin(const Points& starts, const Eigen::VectorXd& radii);
  /// Takes those walls down whose pairs are told to be apart.
  void release(const Points& wanted) noexcept;
  /// The places nearest to `wanted` (least sum of squares) that respect all walls.
  void project(const Points& wanted, Points& allowed) noexcept;
  /// The part, 0 to 1, of the straight way that is free until the first pair without a wall comes
  /// to its gap; 1 if none does.
  double free_part(const Points& from, const Points& to) const noexcept;
  /// Puts walls between the pairs that come to their gap on this part of the way. False if there
  /// was no such pair.
  bool hold(const Points& from, const Points& to, double part);

  /// All walls, also those that nobody leans against (push = 0).
  std::span<const HeldPair> walls() const noexcept { return walls_; }

private:
  bool has_wall(Eigen::Index first, Eigen::Index second) const noexcept;
  double gap_of(Eigen::Index first, Eigen::Index second) const noexcept;
  double contact(Eigen::Index first, Eigen::Index second, const Points& from,
                 const Points& to) const noexcept;

  double fraction_;
  Points starts_;
  Eigen::VectorXd radii_;
  std::vector<HeldPair> walls_;
};

} // namespace nendo::deform
