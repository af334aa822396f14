#include "solver/shared_kernel.hpp"

#include <algorithm>
#include <limits>

namespace nendo::deform {

namespace {

/// 1 at distance 0, 0 from distance 1 on, with a continuous slope.
double closeness(double distance) noexcept {
  if (!(distance < 1.0)) return 0.0;
  return 1.0 - distance * distance * (3.0 - 2.0 * distance);
}

} // namespace

Ties::Ties(const CsrbfOptions& options, const Supports& supports) noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (const Support& support : supports.shared)
    least = std::min(least, support.radius);
  reach_ = options.merge_fraction * least;
  size_ = 0.0;
  resistance_ = 0.0;
  for (const Support& support : supports.shared) {
    size_ += support.weight;
    const double fraction = options.merge_fraction * (least / support.radius);
    resistance_ += support.weight * (1.0 - wendland(options.kernel, fraction));
  }
}

double Ties::strength(double distance, double own_size, double own_resistance) const noexcept {
  const double near = distance > 0.0 ? closeness(distance / reach_) : 1.0;
  if (near == 0.0) return 0.0;
  const double most = size_ + own_size;
  if (!(near < 1.0)) return most;
  // The ties start on the scale of the matrix's own resistance to a difference, not on that of
  // its entries, or all would happen within a hair of the merge distance. What the own functions do
  // grows with the distance's square.
  const double farther = reach_ / distance;
  const double own = std::clamp(own_resistance * farther * farther, 0.0, most);
  const double resistance = resistance_ + own;
  return near * resistance / (1.0 - near + resistance / most);
}

} // namespace nendo::deform
