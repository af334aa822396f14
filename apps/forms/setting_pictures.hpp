#pragma once
// Pictures of brushes, each of which has shaped a small surface, and of kernels, each by its curve.

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <nendo/deform/brush.hpp>

namespace nendo::forms {

/// The lines of a grid on a surface around the origin, first five rows along x; z is outwards. The
/// brush has the radius 1.
using SurfaceLines = std::vector<std::vector<Eigen::Vector3d>>;

/// Returns a small surface after a stroke of that brush, by the deformer of type 2. The first call
/// takes some milliseconds a brush. Thread-safe.
const SurfaceLines& lines_of(deform::Brush brush);

/// Lines in a square from (0, 0) to (1, 1), y upwards, which is stretched to the picture.
using LinePicture = std::vector<std::vector<Eigen::Vector2d>>;

/// Returns the picture of the brush or the kernel of that name; null: there is none. Thread-safe.
const LinePicture* line_picture(std::string_view name);
/// Returns all pictures as a JavaScript object: the data of an SVG path in a square of 100 by name.
std::string line_pictures_js();

} // namespace nendo::forms
