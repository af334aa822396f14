#include <nendo/hand/joint_limits.hpp>

#include <algorithm>

namespace nendo::hand {
namespace {

// How far into a stop of this width an angle goes that is `excess` beyond its beginning: w e / (w +
// e), of slope 1 at the beginning, 1/4 where e = w, and the inverse square of e far out, so that
// more than with an exponential is left of what a badly calibrated joint does. Written so that each
// step is monotone, rounding included, and that infinity gives w.
double into_stop(double excess, double width) noexcept {
  return width * (1.0 - width / (width + excess));
}

} // namespace

double JointLimit::soften(double angle_rad) const noexcept {
  if (angle_rad > soft_most_rad) {
    const double into = into_stop(angle_rad - soft_most_rad, most_rad - soft_most_rad);
    return std::min(soft_most_rad + into, most_rad);
  }
  if (angle_rad >= soft_least_rad) return angle_rad;
  if (angle_rad < soft_least_rad) {
    const double into = into_stop(soft_least_rad - angle_rad, soft_least_rad - least_rad);
    return std::max(soft_least_rad - into, least_rad);
  }
  return least_rad; // NaN, of a broken calibration
}

} // namespace nendo::hand
