#pragma once
// Pictures of brushes, each of which has shaped a small surface, and of kernels, each by its curve.
// Main thread.

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include <nendo/deform/brush.hpp>

struct ImDrawList;
struct ImVec2;

namespace nendo::viewer {

/// The lines of a grid on a surface around the origin, first five rows along x; z is outwards. The
/// brush has the radius 1.
using SurfaceLines = std::vector<std::vector<Eigen::Vector3d>>;

/// Returns a small surface after a stroke of that brush, by the deformer of type 2. The first call
/// for a brush takes some milliseconds.
const SurfaceLines& lines_of(deform::Brush brush);

/// Draw the brush, or the kernel, of that number into a rectangle, in that colour.
void draw_brush(ImDrawList& list, ImVec2 low, ImVec2 high, std::size_t brush, unsigned colour);
void draw_kernel(ImDrawList& list, ImVec2 low, ImVec2 high, std::size_t kernel, unsigned colour);

} // namespace nendo::viewer
