#pragma once
// CGAL's judgement of a mesh.

#include <cstdint>
#include <set>
#include <utility>

#include <nendo/deform/mesh.hpp>

namespace nendo::evidence {

/// Pairs of faces that meet elsewhere than at corners and edges that they share, by
/// CGAL::Polygon_mesh_processing::self_intersections with exact predicates. Ends the program with a
/// message if the faces are no triangles of an oriented manifold.
std::set<std::pair<std::uint32_t, std::uint32_t>> self_intersections(const deform::Mesh& triangles);

} // namespace nendo::evidence
