#pragma once
// Morph targets of glTF: the default shape has them in it (glTF 2.0, 3.7.2.2).

#include <vector>

#include "files/gltf_document.hpp"

namespace nendo::deform {

/// Returns the default weights of a node's mesh: the node's own, or the mesh's. None if all are 0.
std::vector<double> default_weights(const GltfDocument::Json& node, const GltfDocument::Json& mesh);

/// Moves the vertices of a primitive as its targets say at these weights. Returns how many numbers
/// of vertices it read for that. Throws GltfRefusal.
std::size_t apply_targets(const GltfDocument& document, const GltfDocument::Json& primitive,
                          const std::vector<double>& weights, GltfNumbers& places);

} // namespace nendo::deform
