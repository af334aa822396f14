#include "repair/near_places.hpp"

#include <array>
#include <cmath>
#include <map>

namespace nendo::deform {
namespace {

/// A cube as wide as the tolerance. In double, because coordinates may be large beside it.
using SpaceCell = std::array<double, 3>;

/// The first points of places, by their cells. Two of them are farther apart than the tolerance, so
/// a cell holds few.
class FirstPoints {
public:
  FirstPoints(const Points& points, double tolerance) : points_(points), tolerance_(tolerance) {}

  /// Returns the first point within the tolerance, or the point itself, which then is one.
  std::uint32_t place_of(std::uint32_t point) {
    const SpaceCell own = cell_of(point);
    std::uint32_t found = no_index;
    if (tolerance_ > 0.0) {
      for (const double x : {-1.0, 0.0, 1.0})
        for (const double y : {-1.0, 0.0, 1.0})
          for (const double z : {-1.0, 0.0, 1.0})
            look({own[0] + x, own[1] + y, own[2] + z}, point, found);
    } else {
      look(own, point, found);
    }
    if (found != no_index) return found;
    cells_[own].push_back(point);
    return point;
  }

private:
  SpaceCell cell_of(std::uint32_t point) const {
    SpaceCell cell;
    for (std::size_t k = 0; k < 3; ++k) {
      const double at = points_(static_cast<Eigen::Index>(k), point);
      cell[k] = tolerance_ > 0.0 ? std::floor(at / tolerance_) : at + 0.0;
    }
    return cell;
  }
  void look(const SpaceCell& cell, std::uint32_t point, std::uint32_t& found) const {
    const auto here = cells_.find(cell);
    if (here == cells_.end()) return;
    for (const std::uint32_t other : here->second)
      if (other < found && (points_.col(other) - points_.col(point)).norm() <= tolerance_)
        found = other;
  }

  const Points& points_;
  double tolerance_;
  std::map<SpaceCell, std::vector<std::uint32_t>> cells_;
};

} // namespace

std::vector<std::uint32_t> near_places(const Points& points, std::span<const std::uint8_t> joins,
                                       double tolerance) {
  FirstPoints first(points, tolerance);
  std::vector<std::uint32_t> places;
  for (std::uint32_t point = 0; point < joins.size(); ++point)
    places.push_back(joins[point] != 0 ? first.place_of(point) : point);
  return places;
}

} // namespace nendo::deform
