#pragma once
// Models in other places, for joining.

#include <random>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>

namespace nendo::test {

/// Moves the middle of its box to the origin and makes the box's diagonal 2.
inline deform::Mesh normalised(deform::Mesh mesh) {
  const deform::Box box = deform::finite_box_of(mesh.vertices);
  const Eigen::Vector3d middle = 0.5 * (box.lowest + box.highest);
  mesh.vertices = (mesh.vertices.colwise() - middle) * (2.0 / (box.highest - box.lowest).norm());
  return mesh;
}

inline deform::Mesh turned(deform::Mesh mesh, std::mt19937& random) {
  std::normal_distribution<double> number;
  const double w = number(random);
  const double x = number(random);
  const double y = number(random);
  const Eigen::Quaterniond turn(w, x, y, number(random));
  mesh.vertices = (turn.normalized().toRotationMatrix() * mesh.vertices).eval();
  return mesh;
}

inline deform::Mesh moved(deform::Mesh mesh, const Eigen::Vector3d& way) {
  mesh.vertices.colwise() += way;
  return mesh;
}

} // namespace nendo::test
