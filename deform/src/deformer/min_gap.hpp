#pragma once
// No injective map moves fingertips along paths that cross. Such pairs are held at a min gap:
// when a pair comes to it, a wall is put between the two, across the line that joins them. Neither
// of them passes the wall, and both slide along it freely. Each is displaced by the same amount.

#include <span>
#include <vector>

#include <nendo/deform/injective_chain.hpp>

namespace nendo::deform {

/// A wall depends continuously on the path that meets it: for a path that only touches it, the push
/// grows from zero and falls to zero again. A wall exists until the wanted places are apart again
/// along the normal.
class MinGap {
public:
  /// `fraction` is the gap as a part of the smaller radius of the two. Points that start nearer
  /// have half their distance as the gap. Points that coincide are never held; they move together.
  explicit MinGap(double fraction) noexcept : fraction_(fraction) {}

  /// Allocates for this many points.
  void reserve(Eigen::Index points);
  /// Removes all walls. Like the functions below, it does not allocate for up to the number of
  /// points reserved.
  void begin(const Points& starts, const Eigen::VectorXd& radii);
  /// Removes the walls whose pairs are wanted apart.
  void release(const Points& wanted) noexcept;
  /// Writes the places that respect all walls and are nearest to `wanted` (least sum of squares).
  void project(const Points& wanted, Points& allowed) noexcept;
  /// Returns the part, 0 to 1, of the straight way that is free until the first pair without a wall
  /// comes to its gap; 1 if no pair does.
  double free_part(const Points& from, const Points& to) const noexcept;
  /// Puts walls between the pairs that come to their gap on this part of the way. Returns false if
  /// there is no such pair.
  bool hold(const Points& from, const Points& to, double part);

  /// Returns all walls, also those that hold no pair back (push = 0).
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
