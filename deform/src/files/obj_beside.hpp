#pragma once
// The files beside an OBJ: its materials and their textures.

#include <filesystem>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

#include "files/mesh_formats.hpp"
#include "files/model_folder.hpp"

namespace nendo::deform {

/// Reads what `libraries` name, as each mtllib has it, into the mesh's materials, and then their
/// textures. What is missing stays unknown, and is noted. Blocks.
void read_materials(const ModelFolder& folder, const std::vector<std::string>& libraries,
                    Mesh& mesh, ReadNotes& notes);

/// Writes the materials of the OBJ in the file `obj`, and their textures, and returns the name for
/// its mtllib; empty, and nothing is written, if there are none. `wanted` is the materials' file;
/// `obj` with another ending if it is empty. Where another program's file has that name, the name
/// gets an addition. Blocks. Error: failed.
Result<std::string> write_materials(const std::filesystem::path& obj, const Appearance& look,
                                    const std::filesystem::path& wanted);

} // namespace nendo::deform
