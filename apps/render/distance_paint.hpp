#pragma once
// Colours that tell how far each place of a model went from where it was at rest.

#include <memory>

#include <nendo/deform/mesh.hpp>

#include "render/paint.hpp"

namespace nendo::render {

/// Returns the greatest distance between a vertex at rest and in `shape` (3 by #vertices), model
/// units. Vertices that are not finite do not count.
double farthest_way(const deform::Mesh& rest, const deform::Points& shape);

/// Returns a paint of the same triangles as the model's own: grey where a vertex is where it is at
/// rest, then yellow and red, and dark red where it went by `farthest` (> 0) or more. Allocates.
std::shared_ptr<const Paint> paint_by_distance(const deform::Mesh& rest,
                                               const deform::Points& shape, double farthest);

} // namespace nendo::render
