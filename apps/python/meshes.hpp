#pragma once
// A mesh that never changes, so that all threads may use it.

#include <memory>
#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "python/arrays.hpp"

namespace nendo::python {

struct PyMesh {
  std::shared_ptr<const deform::Mesh> mesh;
  std::vector<std::string> notes{}; ///< what its reader or a repair did

  explicit PyMesh(deform::Mesh made, std::vector<std::string> said = {})
      : mesh(std::make_shared<const deform::Mesh>(std::move(made))), notes(std::move(said)) {}
};

/// Returns the triangles of a mesh, (t, 3) uint32.
py::array faces_of(const deform::Mesh& mesh);
/// Reads a model file, and returns it with its vertices near zero (deform::Mesh::offset).
deform::Mesh read_near_zero(const std::filesystem::path& file);

} // namespace nendo::python
