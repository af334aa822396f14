#pragma once
// The faces that close both sides of a cut: a triangulation, in the blade's chart, of the area
// that the loops of crossings enclose.

#include <cstdint>
#include <span>
#include <vector>

#include "cut/blade.hpp"
#include "geometry/constrained_triangulation.hpp"

namespace nendo::deform {

/// A rim as places in the chart, in order.
struct CapLoop {
  std::vector<std::uint32_t> crossings;
  std::vector<PlanePoint> places;
};

struct Cap {
  PlaneFault fault = PlaneFault::none;
  std::vector<PlanePoint> inner; ///< places of new points
  /// Corners below `crossings` are crossings; corner crossings + k is inner point k. They turn to
  /// the left in the chart.
  std::vector<Corners> triangles;
  std::vector<std::uint8_t> on_left; ///< whether the inside lies on each loop's left
};

struct CapOptions {
  double edge = 0.0; ///< wanted length of edges inside
  bool bends = false;
};

/// Fills what an odd number of loops encloses. `crossings` is the number of all crossings. A blade
/// that bends gets a row of points along the rim: three points of a rim that lie on one flat face
/// would else make a triangle in that face. A fault says that loops cross or touch. Allocates.
Cap make_cap(std::span<const CapLoop> loops, std::uint32_t crossings, const CapOptions& options);

} // namespace nendo::deform
