#pragma once
// Reads OBJ, PLY (ASCII, or binary of either byte order) and glTF, and writes OBJ and PLY. Files
// are not trusted: every count is checked against the bytes that are there before anything is
// allocated.

#include <filesystem>
#include <span>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Parses a PLY, which begins with "ply", a glTF, which begins with "glTF" or "{", or else an OBJ.
/// It keeps vertices, faces of any size and vertices' colours, and of an OBJ texture coordinates,
/// materials' names, groups and objects. Of a glTF (Khronos specification 2.0) it takes all meshes
/// of the default scene in the places of their nodes, with materials, textures and texture
/// coordinates; each node is an object. Vertices of a mesh that have the same place, normal and
/// colour become one, because glTF splits them where texture coordinates meet. Normals are dropped,
/// because they change. `name` is what error messages call the file. Error: bad_input with the
/// line, the byte offset or the part of the document, for example if there are no vertices, a
/// coordinate is not finite, an index is wrong, or the file is cut off.
Result<Mesh> parse_mesh(std::span<const std::byte> bytes, std::string_view name);

/// Reads and parses a file, and the materials (MTL), textures and buffers that it names. Those are
/// read from the file's own folder and below it, and from nowhere else; a model may lack materials
/// and textures. Blocks for as long as the disk does. Error: bad_input, also when the file is
/// missing or cannot be read.
Result<Mesh> read_mesh(const std::filesystem::path& path);

/// Writes OBJ or PLY (binary little-endian), by the ending of the path. It writes a temporary file
/// beside `path`, syncs and renames it, so that a file of that name is always whole. Coordinates
/// survive a round trip exactly. An OBJ has all that the mesh has; its materials go beside it into
/// `materials`, or into a file of its name with .mtl if that is empty, and textures too. They never
/// replace a file that was not written by this function. A PLY has colours of vertices alone.
/// Blocks for as long as the disk does. Errors: usage (unknown ending), failed (a file cannot be
/// written).
Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh,
                        const std::filesystem::path& materials = {});

} // namespace nendo::deform
