#pragma once
// Looks for cut faces that meet other faces than they should, before a cut is handed out.

#include "cut/cut_assembly.hpp"

namespace nendo::deform {

/// Returns true if no cut face and no piece of a crossed face meets another of these, or a face
/// beside them on its side of the cut, but at shared corners and edges. `reach` is how far cut
/// faces may lie from the blade: 0 for a plane. The places `rest` decide about triangles of faces
/// that are not cut. Allocates.
bool is_sound(const CutAssembly& assembly, const CutSurface& surface, const Points& rest,
              double reach);

} // namespace nendo::deform
