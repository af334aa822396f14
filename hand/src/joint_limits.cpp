#include <nendo/hand/joint_limits.hpp>

#include <algorithm>

namespace nendo::hand {
namespace {

// How far into a stop of this width an angle goes that is `excess` beyond its beginning: w e / (w +
// e), of slope 1 at the beginning, 1/4 where e = w, and the inverse square of e far out, so that
// more than with an exponential is left of a badly calibrated joint's motion. Written so that each
// step is monotone, rounding included, and that infinity gives w.
double into_stop(double excess, double width) noexcept {
  return width * (1.0 - width / (width + excess));
}

} // namespace

double JointLimit::soften(double angle_rad) const noexcept {
  if (angle_rad > soft_max_rad) {
    const double into = into_stop(angle_rad - soft_max_rad, max_rad - soft_max_rad);
    return std::min(soft_max_rad + into, max_rad);
  }
  if (angle_rad >= soft_min_rad) return angle_rad;
  if (angle_rad < soft_min_rad) {
    const double into = into_stop(soft_min_rad - angle_rad, soft_min_rad - min_rad);
    return std::max(soft_min_rad - into, min_rad);
  }
  return min_rad; // NaN, of a broken calibration
}

} // namespace nendo::hand
