#pragma once
// Faces that are there more than once.

#include <cstddef>
#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Drops faces with the same places as a face before, whichever way they face. Two faces back to
/// back stay where they and their neighbours alike are the wall between two bodies.
/// `place_of` has one entry for each corner, and loses those of dropped faces. Returns how many.
/// Allocates.
std::size_t drop_double_faces(Mesh& mesh, std::vector<std::uint32_t>& place_of);

} // namespace nendo::deform
