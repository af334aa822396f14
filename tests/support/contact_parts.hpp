#pragma once
// Bodies that press clay, and how far a place is from them by another method than the library's.

#include <algorithm>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include <nendo/deform/contact_part.hpp>

namespace nendo::test {

inline deform::ContactPart cone(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                double radius, double end_radius) {
  deform::ContactPart part{{from, to, to}, {radius, end_radius, end_radius}, 2, {}};
  part.frame = Eigen::Translation3d(from);
  return part;
}

/// The distance from the union of all balls between the corners' balls, by finer and finer grids of
/// them.
inline double sampled_distance(const deform::ContactPart& part, const Eigen::Vector3d& place) {
  double u_middle = 0.5;
  double v_middle = part.corner_count == 3 ? 0.5 : 0.0;
  double best = std::numeric_limits<double>::infinity();
  for (double width = 1.0; width > 1e-9; width *= 0.5) {
    const double u_centre = u_middle;
    const double v_centre = v_middle;
    for (int i = -8; i <= 8; ++i)
      for (int j = part.corner_count == 3 ? -8 : 0; j <= (part.corner_count == 3 ? 8 : 0); ++j) {
        const double u = std::clamp(u_centre + width * i / 16.0, 0.0, 1.0);
        const double v =
            part.corner_count == 3 ? std::clamp(v_centre + width * j / 16.0, 0.0, 1.0 - u) : 0.0;
        const double first = 1.0 - u - v;
        const Eigen::Vector3d centre =
            first * part.corners[0] + u * part.corners[1] + v * part.corners[2];
        const double distance =
            (place - centre).norm() - first * part.radii[0] - u * part.radii[1] - v * part.radii[2];
        if (distance >= best) continue;
        best = distance;
        u_middle = u;
        v_middle = v;
      }
  }
  return best;
}

inline double sampled_distance(std::span<const deform::ContactPart> parts,
                               const Eigen::Vector3d& place) {
  double best = std::numeric_limits<double>::infinity();
  for (const deform::ContactPart& part : parts)
    best = std::min(best, sampled_distance(part, place));
  return best;
}

inline std::vector<deform::ContactPart> moved(std::vector<deform::ContactPart> parts,
                                              const Eigen::Isometry3d& by) {
  for (deform::ContactPart& part : parts) {
    for (Eigen::Vector3d& corner : part.corners)
      corner = by * corner;
    part.frame = by * part.frame;
  }
  return parts;
}
inline std::vector<deform::ContactPart> moved(std::vector<deform::ContactPart> parts,
                                              const Eigen::Vector3d& by) {
  return moved(std::move(parts), Eigen::Isometry3d(Eigen::Translation3d(by)));
}

/// Two fingers of one hand, above each other, at this distance from each other; millimetres.
inline std::vector<deform::ContactPart> pinch(double gap, const Eigen::Vector3d& middle) {
  const double up = 0.5 * gap + 8.0;
  return moved({cone({0, 0, up}, {40, 0, up}, 8.0, 9.0), cone({0, 0, -up}, {40, 0, -up}, 8.0, 9.0)},
               middle);
}

} // namespace nendo::test
