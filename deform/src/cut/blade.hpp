#pragma once
// The surface that a plane is, or that a wire sweeps, with a chart: two lengths that name a point
// on it. It has no end. Which part of it cuts is said by covers().

#include <span>
#include <vector>

#include "geometry/space.hpp"

namespace nendo::deform {

class Blade {
public:
  virtual ~Blade() = default;
  /// Returns a length: positive on the upper side, zero on the blade, negative below.
  virtual double side(const SpacePoint& point) const noexcept = 0;
  /// Returns the place on the blade beside the point. Seen from above, the second axis lies to the
  /// left of the first.
  virtual PlanePoint chart(const SpacePoint& point) const noexcept = 0;
  /// Returns the point of this place, so far above the blade.
  virtual SpacePoint lift(const PlanePoint& place, double above) const noexcept = 0;
  /// True if the blade cuts beside the point.
  virtual bool covers(const SpacePoint& point) const noexcept = 0;
  /// True if it is no plane, so that triangles are only near it.
  virtual bool bends() const noexcept = 0;
};

class PlaneBlade final : public Blade {
public:
  /// The normal points to the upper side, and is not zero.
  PlaneBlade(const SpacePoint& point, const SpacePoint& normal) noexcept;
  double side(const SpacePoint& point) const noexcept override;
  PlanePoint chart(const SpacePoint& point) const noexcept override;
  SpacePoint lift(const PlanePoint& place, double above) const noexcept override;
  bool covers(const SpacePoint&) const noexcept override { return true; }
  bool bends() const noexcept override { return false; }

private:
  SpacePoint origin_, normal_, first_, second_;
};

/// A straight wire at one moment.
struct WireEnds {
  SpacePoint from, to;
};

/// The surface through all places of a wire. Between two of them it is interpolated, before the
/// first and past the last it goes straight on, and the wire itself has no end. It cuts from the
/// first place to the last, between the ends.
class WireBlade final : public Blade {
public:
  /// Takes at least two places. The ends of each differ, and so do the middles of neighbours.
  explicit WireBlade(std::span<const WireEnds> places);
  double side(const SpacePoint& point) const noexcept override;
  PlanePoint chart(const SpacePoint& point) const noexcept override;
  SpacePoint lift(const PlanePoint& place, double above) const noexcept override;
  bool covers(const SpacePoint& point) const noexcept override;
  bool bends() const noexcept override { return true; }

private:
  struct Station {
    SpacePoint from, to, middle, onward; ///< onward: the wire's motion, square to it, of length 1
    double along;                        ///< the way of the middle from the first place
  };
  /// Where the wire is when it passes a point.
  struct Passing {
    std::size_t before;                ///< it comes from this place
    double part;                       ///< so far towards the next; below 0 or above 1 beyond all
    SpacePoint from, wire, onward, up; ///< the last three of length 1
  };
  Passing passing(std::size_t before, double part) const noexcept;
  Passing passing(const SpacePoint& point) const noexcept;

  std::vector<Station> stations_;
};

} // namespace nendo::deform
