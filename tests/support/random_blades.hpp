#pragma once
// Random planes, wires and knives through a model, many of them through vertices, along edges, or
// in faces.

#include <cmath>
#include <cstdint>
#include <random>
#include <variant>

#include <Eigen/Geometry>

#include <nendo/deform/cut.hpp>

namespace nendo::test {

using AnyBlade = std::variant<deform::CutPlane, deform::CutWire>;

inline Result<deform::CutModel> cut_by(const deform::Mesh& mesh, const AnyBlade& blade) {
  return std::visit([&](const auto& one) { return deform::cut_model(mesh, one); }, blade);
}

class RandomBlades {
public:
  RandomBlades(const deform::Mesh& mesh, std::uint32_t seed)
      : mesh_(mesh), box_(deform::finite_box_of(mesh.vertices)), random_(seed) {}

  /// By turns: any plane, one that meets vertices, edges or faces, a wire, and a knife.
  AnyBlade next(std::uint32_t number) {
    switch (number % 4) {
    case 0:
      return deform::CutPlane{middle() + 0.4 * size().cwiseProduct(vector()), vector()};
    case 1:
      return aligned_plane(number / 4);
    case 2:
      return wire(1.4);
    default:
      return knife();
    }
  }
  deform::CutPlane aligned_plane(std::uint32_t number) {
    const Eigen::Vector3d a = corner(), b = corner(), c = corner();
    const std::size_t face = random_() % mesh_.face_count();
    const auto at = [&](std::uint32_t k) -> Eigen::Vector3d {
      return mesh_.vertices.col(mesh_.face_corners[mesh_.face_starts[face] + k]);
    };
    Eigen::Vector3d normal = Eigen::Vector3d::Unit(number % 3);
    if (number % 5 == 0) normal = (at(1) - at(0)).cross(at(2) - at(0));
    if (number % 5 == 1) normal = (at(1) - at(0)).cross(vector());
    if (number % 5 == 2) normal = (b - a).cross(c - a);
    if (!(normal.norm() > 1e-12)) normal = Eigen::Vector3d::UnitZ();
    return {number % 5 == 2 ? a : at(0), normal};
  }
  /// A wire that is pulled right through, bent and twisted on its way.
  deform::CutWire wire(double length) {
    const Eigen::Vector3d onward = vector().normalized();
    const Eigen::Vector3d one = onward.unitOrthogonal();
    const double turn = 3.0 * number(), bend = 0.3 * number(), tilt = 0.5 * number(),
                 offset = 0.25 * number();
    const Eigen::Vector3d along = Eigen::AngleAxisd(turn, onward) * one;
    const Eigen::Vector3d up = onward.cross(along);
    deform::CutWire wire;
    for (int k = 0; k <= 30; ++k) {
      const double t = k / 15.0 - 1.0;
      const Eigen::Vector3d centre =
          middle() +
          size().norm() *
              (0.8 * t * onward + (offset + bend * (t * t - 0.3) + 0.05 * std::sin(4.0 * t)) * up);
      const Eigen::Vector3d half =
          0.5 * length * size().norm() * (along + tilt * t * up).normalized();
      wire.places.push_back({centre - half, centre + half});
    }
    return wire;
  }
  /// A long knife, whose tip goes past the model on a bent path.
  deform::CutWire knife() {
    const Eigen::Vector3d edge = vector().normalized();
    const Eigen::Vector3d onward = edge.unitOrthogonal();
    const Eigen::Vector3d up = edge.cross(onward);
    const double bend = 0.2 * number(), offset = 0.3 * number(), wave = 0.05 * number();
    deform::CutWire wire;
    for (int k = 0; k <= 24; ++k) {
      const double t = k / 12.0 - 1.0;
      const Eigen::Vector3d tip =
          middle() + size().norm() * (0.7 * t * onward - 0.7 * edge +
                                      (offset + bend * t * t + wave * std::cos(5 * t)) * up);
      wire.places.push_back({tip, tip + 1.4 * size().norm() * edge});
    }
    return wire;
  }

private:
  double number() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
  Eigen::Vector3d vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  Eigen::Vector3d corner() {
    return mesh_.vertices.col(
        static_cast<Eigen::Index>(random_() % static_cast<std::uint32_t>(mesh_.vertices.cols())));
  }
  Eigen::Vector3d middle() const { return (box_.lowest + box_.highest) / 2.0; }
  Eigen::Vector3d size() const { return box_.highest - box_.lowest; }

  const deform::Mesh& mesh_;
  deform::Box box_;
  std::mt19937 random_;
};

} // namespace nendo::test
