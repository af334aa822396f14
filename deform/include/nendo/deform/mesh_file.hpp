#pragma once
// Reads OBJ, PLY (ASCII, or binary of either byte order), STL (text or binary) and glTF, and writes
// OBJ, PLY and STL. Files are not trusted: every count is checked against the file's size before
// memory is allocated.

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

/// The up axis of a file. Nendo's up axis is y.
enum class UpAxis { y, z };

/// Rotates z-up points to y-up, in place. This function and its inverse are exact.
inline void lay_from_z_up(Points& points) {
  points.row(1).swap(points.row(2));
  points.row(2).array() = 0.0 - points.row(2).array(); // no -0
}
/// Rotates y-up points to z-up, in place.
inline void lay_z_up(Points& points) {
  points.row(2).array() = 0.0 - points.row(2).array(); // no -0
  points.row(1).swap(points.row(2));
}

/// The file name extensions that write_mesh() supports.
inline constexpr std::array<std::string_view, 3> mesh_endings{".obj", ".ply", ".stl"};
/// The same as text for --help.
inline constexpr const char* mesh_endings_text = ".obj, .ply or .stl";

struct ReadOptions {
  /// z: the model is rotated about x by -90 degrees, except glTF, which is always y-up. nullopt: y
  /// is up, and a note reports this if the format does not define the up axis.
  std::optional<UpAxis> up{};
  /// Whether vertices at the same position are merged if the format cannot express shared vertices.
  bool weld = true;

  UpAxis up_axis() const noexcept { return up.value_or(UpAxis::y); }
};

/// A model, and notes about data that its reader ignored, changed or guessed. A note is one
/// sentence without a full stop, names the problem and the remedy, and follows the file's name and
/// a colon.
struct ReadModel {
  Mesh mesh;
  std::vector<std::string> notes;
};

/// Detects the format and parses the file: a PLY begins with "ply", a glTF with "glTF" or "{", and
/// an STL begins with "solid" or has the size that its triangle count implies; other files are
/// parsed as OBJ. Other known formats are rejected with their name and a remedy. Reads vertices,
/// polygons and vertex colours; from OBJ and PLY also texture coordinates and textures; from OBJ
/// also material names, groups and objects. From glTF (Khronos specification 2.0) it reads all
/// meshes of the default scene, transformed by their nodes, with materials, textures and texture
/// coordinates; each node is an object. Vertices at the same position in a node's mesh are merged,
/// because glTF splits them at seams of normals, texture coordinates or colours; so are those of a
/// file in which no two faces share a vertex. Surfaces that only touch stay separate. Normals are
/// dropped, because deformations change them. Error messages call the file `name`. Error: bad_input
/// with the line, the byte offset or the part of the document, for example if there are no
/// vertices, a coordinate is not finite, an index is wrong, or the file is cut off.
NENDO_API Result<ReadModel> parse_model(std::span<const std::byte> bytes, std::string_view name,
                                        const ReadOptions& options = {});

/// Reads and parses a file, and the materials (MTL), textures and buffers that it names. These are
/// read only from the file's folder and its subfolders; materials and textures may be missing.
/// Blocks during disk access. Error: bad_input, also if the file is missing or cannot be read.
NENDO_API Result<ReadModel> read_model(const std::filesystem::path& path,
                                       const ReadOptions& options = {});
/// Does the same without the notes.
NENDO_API Result<Mesh> read_mesh(const std::filesystem::path& path);

/// Returns notes (ReadModel::notes) about the mesh data that a file with this extension cannot
/// store.
NENDO_API std::vector<std::string> lost_in_file(const std::filesystem::path& path,
                                                const Mesh& mesh);

/// Writes OBJ, PLY (binary little-endian) or STL (binary), selected by the extension of `path`,
/// which is case-insensitive. Rotates the model so that the file's axis `up` points up. Writes a
/// temporary file beside `path`, syncs and renames it, so that the file is never incomplete. Adds
/// Mesh::offset to the coordinates; they survive a round trip exactly, except in STL, which stores
/// floats. OBJ stores all mesh data, but only one colour per vertex; its materials and textures are
/// written beside it, the materials to `materials`, or if that is empty to the same name with .mtl.
/// They never replace a file that this function did not write. Of the appearance, PLY stores only
/// vertex colours; STL stores only triangles. Blocks during disk access. Errors: usage (unknown
/// extension), failed (a file cannot be written, or the model is too large for an STL).
NENDO_API Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh,
                                  const std::filesystem::path& materials = {},
                                  UpAxis up = UpAxis::y);

} // namespace nendo::deform
