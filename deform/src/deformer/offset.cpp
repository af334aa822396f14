#include <nendo/deform/offset.hpp>

#include <cmath>
#include <cstdio>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {
namespace {

constexpr double near_sizes = 4.0; // from zero: a float then has two bits less for the size
constexpr int middle_bits = 20;    // of the size; without them, rounding would show in the middle

} // namespace

Eigen::Vector3d usual_offset(const Mesh& mesh) noexcept {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  const Box box = box_of_faces(mesh);
  const double size = (box.highest - box.lowest).maxCoeff();
  if (!(size > 0.0) || !std::isfinite(size)) return offset;
  const double step = std::ldexp(1.0, std::ilogb(size) - middle_bits);
  const Eigen::Vector3d middle = box.lowest / 2.0 + box.highest / 2.0 + mesh.offset;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (std::abs(middle[axis]) > near_sizes * size)
      offset[axis] = step * std::round(middle[axis] / step);
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

std::string place_text(const Eigen::Vector3d& place, const Eigen::Vector3d& offset) {
  const Eigen::Vector3d at = place + offset;
  const int digits = offset.isZero(0.0) ? 6 : 10; // far from zero the first ones say nothing
  char text[96];
  std::snprintf(text, sizeof text, "(%.*g, %.*g, %.*g)", digits, at.x(), digits, at.y(), digits,
                at.z());
  return text;
}

} // namespace nendo::deform
