#include "evidence/intersection_count.hpp"

#include <cstdlib>
#include <iostream>
#include <iterator>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

namespace nendo::evidence {

std::set<std::pair<std::uint32_t, std::uint32_t>>
self_intersections(const deform::Mesh& triangles) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  Surface surface;
  std::vector<Surface::Vertex_index> vertices;
  for (Eigen::Index i = 0; i < triangles.vertices.cols(); ++i) {
    const Eigen::Vector3d x = triangles.vertices.col(i);
    vertices.push_back(surface.add_vertex(Kernel::Point_3(x.x(), x.y(), x.z())));
  }
  for (std::size_t face = 0; face < triangles.face_count(); ++face) {
    const std::uint32_t* corner = &triangles.face_corners[triangles.face_starts[face]];
    const auto added =
        surface.add_face(vertices[corner[0]], vertices[corner[1]], vertices[corner[2]]);
    if (added == Surface::null_face()) {
      std::cerr << "self_intersections: face " << face << " does not fit an oriented manifold\n";
      std::exit(1);
    }
  }
  std::vector<std::pair<Surface::Face_index, Surface::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections(surface, std::back_inserter(found));
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& [first, second] : found)
    pairs.insert(std::minmax<std::uint32_t>(first, second));
  return pairs;
}

} // namespace nendo::evidence
