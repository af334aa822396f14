#pragma once
// Holes of a surface whose edges have at most two faces: how to close them.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// A part whose holes stay open.
struct UnfilledPart {
  std::uint32_t vertex; ///< one of it
  std::string why;      ///< the words follow the part's name
  std::string remedy;
};

struct FilledHoles {
  std::size_t count = 0;
  std::size_t crossing = 0; ///< whose lid goes through the model, because each way to close it does
  std::vector<UnfilledPart> unfilled; ///< some of whose holes may be closed, but not counted
};

/// Closes holes by triangles between their corners: in the plane that fits the rim best, or, where
/// that folds or goes through the model, as the least area. A lid looks as the face beside it. A
/// part stays open if it is a sheet, which a lid would only double, or if a rim is too long and too
/// crooked. Faces around each vertex must form one fan, open or closed. Error: bad_input, with the
/// place: they do not. Allocates.
Result<FilledHoles> fill_holes(Mesh& mesh);

} // namespace nendo::deform
