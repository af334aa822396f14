#include <nendo/deform/offset.hpp>

#include <cmath>

namespace nendo::deform {
namespace {

constexpr double near_sizes = 4.0; // from zero: a float then has two bits less for the size

/// Of the vertices that faces have: a stray one may lie anywhere. Of all, if there are no faces.
Box box_of_faces(const Mesh& mesh) noexcept {
  if (mesh.face_corners.empty()) return finite_box_of(mesh.vertices);
  Box box = finite_box_of(Points(3, 0));
  for (const std::uint32_t corner : mesh.face_corners) {
    const auto place = mesh.vertices.col(static_cast<Eigen::Index>(corner));
    if (!place.allFinite()) continue;
    box.lowest = box.lowest.cwiseMin(place);
    box.highest = box.highest.cwiseMax(place);
  }
  return box;
}

} // namespace

Eigen::Vector3d usual_offset(const Mesh& mesh) noexcept {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  const Box box = box_of_faces(mesh);
  const double size = (box.highest - box.lowest).maxCoeff();
  if (!(size > 0.0) || !std::isfinite(size)) return offset;
  const Eigen::Vector3d middle = box.lowest / 2.0 + box.highest / 2.0 + mesh.offset;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (std::abs(middle[axis]) > near_sizes * size) offset[axis] = middle[axis];
  return offset;
}

void count_from(const Eigen::Vector3d& offset, Mesh& mesh) noexcept {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double before = mesh.offset[axis];
    if (before == offset[axis]) continue;
    // One of them is usually 0, and then there is one rounding, or none.
    if (before == 0.0)
      mesh.vertices.row(axis).array() -= offset[axis];
    else if (offset[axis] == 0.0)
      mesh.vertices.row(axis).array() += before;
    else
      mesh.vertices.row(axis).array() += before - offset[axis];
  }
  mesh.offset = offset;
}

} // namespace nendo::deform
