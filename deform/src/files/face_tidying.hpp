#pragma once
// Faces that are none: files have them, and nothing can be done with them.

#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Takes a corner that a face names twice in a row once only, and leaves out faces with fewer than
/// three different corners. Adds a note for each of both, if there are any. Other faces, and all
/// vertices, stay as they are.
void tidy_faces(Mesh& mesh, std::vector<std::string>& notes);

} // namespace nendo::deform
