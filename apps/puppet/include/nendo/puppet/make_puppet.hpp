#pragma once
// Writes a puppet file for a face without a description. It is a beginning: a person looks
// at it (`nendo puppet show --picture`) and corrects it in an editor.

#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::puppet {

struct MadePuppet {
  std::string text;               ///< the file's text, with comments that say what was found
  std::vector<std::string> found; ///< the same, a line each
};

/// Places points on the face and gives it the functions that these allow. Functions whose triangles
/// turn over (RigCheck) are made to move less. `model_name` is the file's name, beside which the
/// puppet's file will be. Error: bad_input (find_face() finds no face, or the points are too
/// near to each other). Takes about a second.
NENDO_API Result<MadePuppet> make_face_puppet(const deform::Mesh& model,
                                              std::string_view model_name);

} // namespace nendo::puppet
