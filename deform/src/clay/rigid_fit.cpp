#include "clay/rigid_fit.hpp"

#include <algorithm>

#include <nendo/deform/dense.hpp>

namespace nendo::deform {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr int max_fit_rounds = 12;
constexpr double inertia = 1e-6;       // resists motions that nothing determines
constexpr double enough_change = 1e-3; // share of the yielding depth

/// The equations of a round. The unknowns are the middle's way and the turn about it.
struct Equations {
  Matrix6d matrix = inertia * Matrix6d::Identity();
  Vector6d right = Vector6d::Zero();

  /// Wants the place `arm` from the middle to go by `way`, with a weight a direction.
  void add(const Vector3d& arm, const Matrix3d& weights, const Vector3d& way) noexcept {
    Matrix3d cross;
    cross << 0.0, -arm.z(), arm.y(), arm.z(), 0.0, -arm.x(), -arm.y(), arm.x(), 0.0;
    const Matrix3d turned = cross * weights; // of the turn's rows
    matrix.topLeftCorner<3, 3>() += weights;
    matrix.bottomLeftCorner<3, 3>() += turned;
    matrix.bottomRightCorner<3, 3>() -= turned * cross;
    const Vector3d force = weights * way;
    right.head<3>() += force;
    right.tail<3>() += arm.cross(force);
  }
  Vector6d solved() noexcept {
    matrix.topRightCorner<3, 3>() = matrix.bottomLeftCorner<3, 3>().transpose();
    return solve_spd6(matrix, right);
  }
};

double weight_of(double limit, double residue) noexcept {
  return residue > limit ? limit / residue : 1.0;
}

} // namespace

Eigen::Isometry3d fit_rigid_motion(std::span<const Carrier> carriers, const Vector3d& middle,
                                   double friction, double yields) noexcept {
  Vector6d motion = Vector6d::Zero();
  for (int round = 0; round < max_fit_rounds; ++round) {
    Equations equations;
    for (const Carrier& one : carriers) {
      const Vector3d arm = one.at - middle;
      const Vector3d gone = motion.head<3>() + motion.tail<3>().cross(arm);
      if (one.normal.isZero(0.0)) {
        const double weight = weight_of(yields, (one.way - gone).norm());
        equations.add(arm, weight * Matrix3d::Identity(), one.way);
        continue;
      }
      const double deep = one.depth - one.normal.dot(gone);
      const double pressed = std::clamp(deep, 0.0, yields);
      const Vector3d left = one.way - gone;
      const double sideways = (left - left.dot(one.normal) * one.normal).norm();
      const double limit = friction * (pressed + one.load);
      const double tangential = limit > 0.0 ? weight_of(limit, sideways) : 0.0;
      const double across = deep > 0.0 ? weight_of(yields, deep) : 0.0;
      const Matrix3d along = one.normal * one.normal.transpose();
      const Vector3d wanted = one.way + (one.depth - one.way.dot(one.normal)) * one.normal;
      equations.add(arm, tangential * (Matrix3d::Identity() - along) + across * along, wanted);
    }
    const Vector6d before = motion;
    motion = equations.solved();
    if ((motion - before).norm() < enough_change * yields) break;
  }
  Eigen::Isometry3d rigid = Eigen::Isometry3d::Identity();
  const double angle = motion.tail<3>().norm();
  if (angle > 0.0) rigid.linear() = Eigen::AngleAxisd(angle, motion.tail<3>() / angle).matrix();
  rigid.translation() = middle + motion.head<3>() - rigid.linear() * middle;
  return rigid;
}

Eigen::Isometry3d motion_between(const Eigen::Isometry3d& from,
                                 const Eigen::Isometry3d& to) noexcept {
  return to * from.inverse(Eigen::Isometry);
}

Vector3d before_motion(const Eigen::Isometry3d& motion, const Vector3d& point) noexcept {
  return motion.inverse(Eigen::Isometry) * point;
}

} // namespace nendo::deform
