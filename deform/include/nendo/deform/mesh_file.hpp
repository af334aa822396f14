#pragma once
// Reading and writing OBJ and PLY (ASCII, binary of either byte order). Files are hostile: every
// count is checked against the bytes that are there before anything is allocated.

#include <filesystem>
#include <span>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// By content for PLY ("ply" magic), otherwise OBJ. `name` is what error messages call it. Kept:
/// vertices, faces of any size, texture coordinates of an OBJ. Not kept: normals (they change),
/// materials, groups, colours. Error: bad_input with line or byte offset (no vertices, non-finite
/// coordinates, bad indices, truncated, ...).
Result<Mesh> parse_mesh(std::span<const std::byte> bytes, std::string_view name);

/// Errors: bad_input, also when the file is missing or cannot be read.
Result<Mesh> read_mesh(const std::filesystem::path& path);

/// Format by the ending, .obj or .ply (binary little-endian). Written to a temporary name beside
/// `path`, synced and renamed, so that a file of that name is always whole. Coordinates survive a
/// round trip exactly. Errors: usage (unknown ending), failed (cannot be written).
Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh);

} // namespace nendo::deform
