#pragma once
// Reads OBJ, PLY (ASCII, or binary of either byte order), STL (text or binary) and glTF, and writes
// OBJ, PLY and STL. Files are not trusted: every count is checked against the bytes that are there
// before anything is allocated.

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// The axis of the file that points up. Nendo's own is y.
enum class UpAxis { y, z };

/// The endings of files that write_mesh() can write.
inline constexpr std::array<std::string_view, 3> mesh_endings{".obj", ".ply", ".stl"};
/// What --help says of them.
inline constexpr const char* mesh_endings_text = ".obj, .ply or .stl";

struct ReadOptions {
  /// z: the model is turned about x by -90 degrees, unless it is a glTF, whose y is up. Nothing: y
  /// is up, and a note says so if the format cannot say which axis is.
  std::optional<UpAxis> up{};
  /// Whether vertices in one place become one vertex where the format cannot say that they are one.
  bool weld = true;
};

/// A model, and what its reader left out, changed or guessed: one sentence for each, without a
/// full stop. A sentence names the thing and the remedy, and goes behind the file's name and a
/// colon.
struct ReadModel {
  Mesh mesh;
  std::vector<std::string> notes;
};

/// Parses a PLY, which begins with "ply", a glTF, which begins with "glTF" or "{", an STL, which
/// begins with "solid" or has as many bytes as its count says, or else an OBJ. What is known to be
/// of another format is refused with the format's name and a remedy.
/// It keeps vertices, faces of any size and vertices' colours, of an OBJ and a PLY texture
/// coordinates and textures, and of an OBJ materials' names, groups and objects. Of a glTF (Khronos
/// specification 2.0) it takes all meshes of the default scene in the places of their nodes, with
/// materials, textures and texture coordinates; each node is an object. Vertices of a node's mesh
/// with the same place become one, because glTF splits them where normals, texture coordinates or
/// colours meet; so do those of a file in which no two faces share a vertex. Surfaces that only
/// touch stay apart. Normals are dropped, because they change. `name` is what error messages call
/// the file. Error: bad_input with the line, the byte offset or the part of the document, for
/// example if there are no vertices, a coordinate is not finite, an index is wrong, or the file is
/// cut off.
NENDO_API Result<ReadModel> parse_model(std::span<const std::byte> bytes, std::string_view name,
                                        const ReadOptions& options = {});

/// Reads and parses a file, and the materials (MTL), textures and buffers that it names. Those are
/// read from the file's own folder and below it, and from nowhere else; a model may lack materials
/// and textures. Blocks for as long as the disk does. Error: bad_input, also when the file is
/// missing or cannot be read.
NENDO_API Result<ReadModel> read_model(const std::filesystem::path& path,
                                       const ReadOptions& options = {});
/// The same, without the notes.
NENDO_API Result<Mesh> read_mesh(const std::filesystem::path& path);

/// Returns what a file of that ending cannot keep of the mesh, as notes (ReadModel::notes).
NENDO_API std::vector<std::string> lost_in_file(const std::filesystem::path& path,
                                                const Mesh& mesh);

/// Writes OBJ, PLY (binary little-endian) or STL (binary), by the ending of the path, in any case.
/// It turns the model so that the axis `up` of the file points up. It writes a temporary file
/// beside `path`, syncs and renames it, so that a file of that name is always whole. Coordinates
/// survive a round trip exactly, but in an STL, which has floats; Mesh::offset is added to them. An
/// OBJ has all that the mesh has, but one colour for each vertex; its materials and textures go
/// beside it, the materials into `materials`, or into a file of its name with .mtl if that is
/// empty. They never replace a file that was not written by this function. A PLY has colours of
/// vertices alone, an STL has triangles alone. Blocks for as long as the disk does. Errors: usage
/// (unknown ending), failed (a file cannot be written, or the model is too large for an STL).
NENDO_API Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh,
                                  const std::filesystem::path& materials = {},
                                  UpAxis up = UpAxis::y);

} // namespace nendo::deform
