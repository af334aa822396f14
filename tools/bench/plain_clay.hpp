#pragma once
// Clay as one would write it first: plain loops in double over all vertices near the hands' boxes.
// The library's clay is compared with it. No friction, no volume, no sub-steps.

#include <span>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::bench {

/// Returns how deep a place is in the deepest part; 0 outside. By the exact distance, in double.
double plain_depth(std::span<const deform::ContactPart> parts, const Eigen::Vector3d& place);

/// Lengths are in millimetres.
class PlainClay {
public:
  PlainClay(deform::Points vertices, double radius)
      : vertices_(std::move(vertices)), radius_(radius) {}

  void begin(std::span<const deform::ContactPart>) noexcept {}
  /// Pushes the vertices out of the parts. Of the report, passes, constraints, distances and
  /// penetration are filled in.
  deform::ClayReport press_to(std::span<const deform::ContactPart> parts);
  const deform::Points& vertices() const noexcept { return vertices_; }

private:
  deform::Points vertices_;
  double radius_;
};

} // namespace nendo::bench
