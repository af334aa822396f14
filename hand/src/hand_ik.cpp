#include "hand_ik.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::hand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// How far from the palm's origin its axes are compared: half a hand.
constexpr double palm_lever_m = 0.1;

/// The palm's origin, and a point on each of its axes.
Vector3d palm_point_m(int point) noexcept {
  Vector3d in_palm_m = Vector3d::Zero();
  if (point > 0) in_palm_m[point - 1] = palm_lever_m;
  return in_palm_m;
}

/// The whole hand, its wrist and its palm included.
struct HandIkProblem {
  const HandIk& hand;
  AllAngles start;
  Posture posture;

  NormalEquations<row_size> operator()(const AllAngles& at) const noexcept {
    NormalEquations<row_size> sum;
    sum.matrix.setZero();
    AllAngles weights = AllAngles::Constant(posture.start_m * posture.start_m);
    weights.tail<3>().setConstant(posture.shared_m * posture.shared_m);
    sum.matrix.diagonal() = weights;
    sum.gradient = weights.cwiseProduct(at - start);
    sum.cost = 0.5 * sum.gradient.dot(at - start);
    const Matrix3d turn = wrist_turn(at[pitch_at], at[yaw_at]);
    for (std::size_t f = 0; f < finger_count; ++f) {
      if (hand.aims[f].weight > 0.0) add_finger(sum, f, at, turn);
    }
    if (hand.palm.weight > 0.0) add_palm(sum, turn);
    return sum;
  }

private:
  void add_finger(NormalEquations<row_size>& sum, std::size_t f, const AllAngles& at,
                  const Matrix3d& turn) const noexcept {
    const auto block = 4 * static_cast<int>(f);
    const Fingertip tip = hand.chains[f].tip(at.segment<4>(block), at[arch_at]);
    const Vector3d place_m = turn * tip.position_m;
    const Vector3d off_m = place_m - hand.aims[f].place_m;
    const Eigen::Matrix<double, 3, 4> own = turn * tip.by_angle;
    Matrix3d shared; // by palm arch, pitch, yaw
    shared << turn * hand.chains[f].by_arch(tip.position_m), -turn.col(0).cross(place_m),
        Vector3d::UnitY().cross(place_m);
    const double weight = hand.aims[f].weight;
    sum.matrix.block<4, 4>(block, block) += weight * own.transpose() * own;
    sum.matrix.block<4, 3>(block, arch_at) += weight * own.transpose() * shared;
    sum.matrix.block<3, 4>(arch_at, block) += weight * shared.transpose() * own;
    sum.matrix.block<3, 3>(arch_at, arch_at) += weight * shared.transpose() * shared;
    sum.gradient.segment<4>(block) += weight * own.transpose() * off_m;
    sum.gradient.tail<3>() += weight * shared.transpose() * off_m;
    sum.cost += 0.5 * weight * off_m.squaredNorm();
    sum.farthest_m = std::max(sum.farthest_m, off_m.norm());
    if (posture.together_m > 0.0)
      add_together<row_size>(sum, at, block, f == 0, posture.together_m);
  }

  void add_palm(NormalEquations<row_size>& sum, const Matrix3d& turn) const noexcept {
    const auto& [rest, wanted, weight] = hand.palm;
    for (int point = 0; point < 4; ++point) {
      const Vector3d place_m = turn * (rest * palm_point_m(point));
      const Vector3d off_m = place_m - wanted * palm_point_m(point);
      Eigen::Matrix<double, 3, 2> slopes; // by pitch, yaw
      slopes << -turn.col(0).cross(place_m), Vector3d::UnitY().cross(place_m);
      sum.matrix.block<2, 2>(pitch_at, pitch_at) += weight * slopes.transpose() * slopes;
      sum.gradient.tail<2>() += weight * slopes.transpose() * off_m;
      sum.cost += 0.5 * weight * off_m.squaredNorm();
      sum.farthest_m = std::max(sum.farthest_m, off_m.norm());
    }
  }
};

} // namespace

Matrix3d wrist_turn(double pitch_rad, double yaw_rad) noexcept {
  const double sp = std::sin(pitch_rad);
  const double cp = std::cos(pitch_rad);
  const double sy = std::sin(yaw_rad);
  const double cy = std::cos(yaw_rad);
  Matrix3d turn; // about Y by yaw, then about X by -pitch
  turn << cy, -sy * sp, sy * cp, 0.0, cp, sp, -sy, -cy * sp, cy * cp;
  return turn;
}

int HandIk::solve(const Box<row_size>& box, double enough_m, AllAngles& at) const noexcept {
  HandIkProblem problem{*this, at, forming};
  NormalEquations<row_size> here;
  int iterations = minimise<row_size>(problem, box, to_form, at, here);
  problem.posture = reaching;
  iterations += minimise<row_size>(problem, box, to_reach(enough_m), at, here);
  return iterations;
}

double HandIk::palm_off_m(const Matrix3d& wrist_turn) const noexcept {
  double squares = 0.0;
  for (int point = 0; point < 4; ++point)
    squares += (wrist_turn * (palm.rest * palm_point_m(point)) - palm.wanted * palm_point_m(point))
                   .squaredNorm();
  return std::sqrt(0.25 * squares);
}

} // namespace nendo::hand
