#include "bench/plain_clay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include <Eigen/Eigenvalues>

#include <nendo/deform/wendland.hpp>
#include <nendo/hand/hand_body.hpp>

namespace nendo::bench {

using deform::ContactPart;
using Eigen::Vector3d;

namespace {

constexpr double skin_mm = 0.02;
constexpr double margin_mm = 1.0;
constexpr int max_plain_passes = 40;

struct Touch {
  Vector3d at, normal;
  double depth;
};

hand::BodyPart body_part(const ContactPart& part) {
  return {part.corners, part.radii, part.corner_count, hand::Joint::wrist};
}

bool is_in_box(const ContactPart& part, const Vector3d& place, double margin) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t at = 0; at < part.corner_count; ++at) {
      low = std::min(low, part.corners[at][axis] - part.radii[at]);
      high = std::max(high, part.corners[at][axis] + part.radii[at]);
    }
    if (place[axis] < low - margin || place[axis] > high + margin) return false;
  }
  return true;
}

/// The deepest vertex of each cell and part, the deepest first, none too near to another.
std::vector<Touch> touches(const deform::Points& vertices, std::span<const ContactPart> parts,
                           double cell, std::size_t& distances) {
  std::map<std::array<long, 4>, Touch> cells;
  for (Eigen::Index vertex = 0; vertex < vertices.cols(); ++vertex) {
    const Vector3d place = vertices.col(vertex);
    hand::ClosestPoint best;
    best.distance_m = margin_mm;
    long which = -1;
    for (std::size_t part = 0; part < parts.size(); ++part) {
      if (!is_in_box(parts[part], place, margin_mm)) continue;
      ++distances;
      const hand::ClosestPoint near = nearest_of(body_part(parts[part]), place);
      if (near.distance_m >= best.distance_m) continue;
      best = near;
      which = static_cast<long>(part);
    }
    if (which < 0) continue;
    const Eigen::Array3d index = (place.array() / cell).floor();
    const std::array<long, 4> key{static_cast<long>(index[0]), static_cast<long>(index[1]),
                                  static_cast<long>(index[2]), which};
    const Touch touch{place, best.normal, -best.distance_m};
    const auto [found, is_new] = cells.try_emplace(key, touch);
    if (!is_new && touch.depth > found->second.depth) found->second = touch;
  }
  std::vector<Touch> all, chosen;
  for (const auto& [key, touch] : cells)
    all.push_back(touch);
  std::stable_sort(all.begin(), all.end(),
                   [](const Touch& a, const Touch& b) { return a.depth > b.depth; });
  for (const Touch& touch : all)
    if (std::none_of(chosen.begin(), chosen.end(), [&](const Touch& other) {
          return (other.at - touch.at).norm() < 0.6 * cell && other.normal.dot(touch.normal) > 0.5;
        }))
      chosen.push_back(touch);
  return chosen;
}

/// Projected Gauss-Seidel on the dense matrix.
Eigen::VectorXd pressures(const std::vector<Touch>& touches, double radius) {
  const auto count = static_cast<Eigen::Index>(touches.size());
  Eigen::MatrixXd matrix(count, count);
  Eigen::VectorXd depths(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Touch& one = touches[static_cast<std::size_t>(i)];
    depths[i] = one.depth + skin_mm / 2.0;
    for (Eigen::Index j = 0; j < count; ++j) {
      const Touch& other = touches[static_cast<std::size_t>(j)];
      matrix(i, j) = one.normal.dot(other.normal) *
                     wendland(deform::Wendland::c2, (one.at - other.at).norm() / radius);
    }
  }
  Eigen::VectorXd result = Eigen::VectorXd::Zero(count);
  for (int sweep = 0; sweep < 50; ++sweep)
    for (Eigen::Index i = 0; i < count; ++i)
      result[i] = std::max(0.0, result[i] + depths[i] - matrix.col(i).dot(result));
  return result;
}

double bound_of(const std::vector<Touch>& touches, const Eigen::VectorXd& pressure, double radius) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < touches.size(); ++i)
    for (std::size_t j = 0; j < touches.size(); ++j)
      gram += pressure[static_cast<Eigen::Index>(i)] * pressure[static_cast<Eigen::Index>(j)] *
              wendland(deform::Wendland::c2, (touches[i].at - touches[j].at).norm() / radius) *
              touches[i].normal * touches[j].normal.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(gram);
  return std::sqrt(20.0 * std::max(0.0, solver.eigenvalues()[2])) / radius;
}

void displace(deform::Points& vertices, const std::vector<Touch>& touches,
              const Eigen::VectorXd& pressure, double radius, double part) {
  for (Eigen::Index vertex = 0; vertex < vertices.cols(); ++vertex) {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t at = 0; at < touches.size(); ++at) {
      const double along = pressure[static_cast<Eigen::Index>(at)];
      if (along <= 0.0) continue;
      const double squared = (vertices.col(vertex) - touches[at].at).squaredNorm();
      if (squared >= radius * radius) continue;
      sum +=
          along * wendland(deform::Wendland::c2, std::sqrt(squared) / radius) * touches[at].normal;
    }
    vertices.col(vertex) += part * sum;
  }
}

} // namespace

double plain_depth(std::span<const ContactPart> parts, const Vector3d& place) {
  double deepest = 0.0;
  for (const ContactPart& part : parts)
    if (is_in_box(part, place, 0.0))
      deepest = std::max(deepest, -nearest_of(body_part(part), place).distance_m);
  return deepest;
}

deform::ClayReport PlainClay::press_to(std::span<const ContactPart> parts) {
  deform::ClayReport report;
  for (int pass = 0; pass < max_plain_passes; ++pass) {
    const std::vector<Touch> found = touches(vertices_, parts, radius_ / 3.0, report.distances);
    report.penetration_mm = found.empty() ? 0.0 : std::max(0.0, found.front().depth);
    if (report.penetration_mm <= skin_mm) break;
    const Eigen::VectorXd pressure = pressures(found, radius_);
    const double bound = bound_of(found, pressure, radius_);
    displace(vertices_, found, pressure, radius_, std::min(1.0, 0.9 / bound));
    ++report.passes;
    report.max_constraints = std::max(report.max_constraints, static_cast<int>(found.size()));
  }
  for (Eigen::Index vertex = 0; vertex < vertices_.cols(); ++vertex)
    for (const ContactPart& part : parts) {
      if (!is_in_box(part, vertices_.col(vertex), 0.0)) continue;
      const hand::ClosestPoint near = nearest_of(body_part(part), vertices_.col(vertex));
      if (near.distance_m < 0.0) vertices_.col(vertex) = near.place_m;
    }
  return report;
}

} // namespace nendo::bench
