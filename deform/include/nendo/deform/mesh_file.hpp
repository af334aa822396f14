#pragma once
// Reads and writes OBJ and PLY (ASCII, or binary of either byte order). Files are not trusted:
// every count is checked against the bytes that are there before anything is allocated.

#include <filesystem>
#include <span>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Parses a PLY, which begins with "ply", or else an OBJ. It keeps vertices, faces of any size and
/// vertices' colours, and of an OBJ texture coordinates, materials' names, groups and objects. It
/// drops normals, because they change. `name` is what error messages call the file. Error:
/// bad_input with the line or the byte offset, for example if there are no vertices, a coordinate
/// is not finite, an index is wrong, or the file is cut off.
Result<Mesh> parse_mesh(std::span<const std::byte> bytes, std::string_view name);

/// Reads and parses a file, and the materials (MTL) and textures that it names. Those are read from
/// the file's own folder and below it, and from nowhere else; a model may lack them. Blocks for as
/// long as the disk does. Error: bad_input, also when the file is missing or cannot be read.
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
