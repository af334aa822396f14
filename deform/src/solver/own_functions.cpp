#include "solver/kernel_system.hpp"

#include <algorithm>
#include <cassert>

#include "geometry/point_grid.hpp"

namespace nendo::deform {

bool OwnFunctions::evaluate(Wendland kernel, const Points& starts, const Supports& supports) {
  const Eigen::Index n = starts.cols();
  begins_.assign(1, 0);
  values_.clear();
  weights_.clear();
  if (supports.own.empty()) return true;
  const bool many = n > CsrbfSolver::lean_size;
  if (!many) values_.reserve(supports.own.size() * static_cast<std::size_t>(n));
  double edge = 0.0;
  for (const OwnSupport& own : supports.own)
    edge += own.support.radius / static_cast<double>(supports.own.size());
  const PointGrid grid(many ? starts : Points(3, 0), many ? edge : 1.0);
  for (const OwnSupport& own : supports.own) {
    assert(own.point >= 0 && own.point < n);
    const auto visit = [&](std::uint32_t point) {
      const double distance = (starts.col(point) - starts.col(own.point)).norm();
      if (distance < own.support.radius)
        values_.push_back({point, wendland(kernel, distance / own.support.radius)});
    };
    const std::size_t begin = values_.size();
    if (many) {
      const Eigen::Vector3d centre = starts.col(own.point);
      grid.visit_near(centre, centre, own.support.radius, visit);
      std::sort(values_.begin() + static_cast<std::ptrdiff_t>(begin), values_.end(),
                [](const Value& a, const Value& b) { return a.point < b.point; });
    } else {
      for (Eigen::Index i = 0; i < n; ++i)
        visit(static_cast<std::uint32_t>(i));
    }
    begins_.push_back(values_.size());
    weights_.push_back(own.support.weight);
    if (values_.size() > CsrbfSolver::max_own_values) return false;
  }
  return true;
}

double OwnFunctions::pairs() const noexcept {
  double pairs = 0.0;
  for (std::size_t e = 0; e < size(); ++e) {
    const auto count = static_cast<double>(values(e).size());
    pairs += count * (count + 1.0) / 2.0;
  }
  return pairs;
}

double OwnFunctions::trace() const noexcept {
  double sum = 0.0;
  for (std::size_t e = 0; e < size(); ++e)
    for (const Value& value : values(e))
      sum += weights_[e] * value.psi * value.psi;
  return sum;
}

void OwnFunctions::diagonal(Eigen::VectorXd& out) const noexcept {
  out.setZero();
  for (std::size_t e = 0; e < size(); ++e)
    for (const Value& value : values(e))
      out[value.point] += weights_[e] * value.psi * value.psi;
}

Eigen::RowVector4d OwnFunctions::coefficient(std::size_t function, const Rows& a) const noexcept {
  Eigen::RowVector4d sum = Eigen::RowVector4d::Zero();
  for (const Value& value : values(function))
    sum += value.psi * a.row(value.point);
  return weights_[function] * sum;
}

} // namespace nendo::deform
