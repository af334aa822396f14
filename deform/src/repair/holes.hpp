#pragma once
// Holes of a surface whose edges have at most two faces: how to close them.

#include <cstddef>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

struct FilledHoles {
  std::size_t count = 0;
  std::size_t crossing = 0; ///< whose lid goes through the model, because each way to close it does
};

/// Closes all holes by triangles between their corners: in the plane that fits the rim best, or,
/// where that folds or goes through the model, as the least area. A lid looks as the face beside
/// it. Faces around each vertex must form one fan, open or closed. Error: bad_input, with the
/// place: a part is a sheet, which a lid would only double; a rim is too long and too crooked.
/// Allocates.
Result<FilledHoles> fill_holes(Mesh& mesh);

} // namespace nendo::deform
