#pragma once
// Converts meshes from and to the strings of the two file formats. mesh_file.hpp says what is kept
// and which errors there are.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/read_notes.hpp>

namespace nendo::deform {

struct ObjModel {
  Mesh mesh;                          ///< its materials have names only
  std::vector<std::string> libraries; ///< what each mtllib says: one file, or several
};

Result<ObjModel> parse_obj(std::string_view text, std::string_view name, ReadNotes& notes);

struct PlyModel {
  Mesh mesh;                         ///< its textures have no contents
  std::vector<std::string> textures; ///< what the file calls each of them
};

Result<PlyModel> parse_ply(std::string_view text, std::string_view name, ReadNotes& notes);

class ModelFolder;
/// Reads a glTF, binary or JSON. `folder` has the other files that it names; null: there are none.
Result<Mesh> parse_gltf(std::string_view text, std::string_view name, const ModelFolder* folder,
                        const ReadOptions& options, ReadNotes& notes);

/// Returns the mesh as OBJ. `library` names the file with its materials; it is left out if empty.
std::string obj_text(const Mesh& mesh, std::string_view library);
/// Returns the mesh as binary little-endian PLY, with coordinates in double.
std::string ply_text(const Mesh& mesh);

/// The largest index of a list and where it stood. A face may come before its vertices, so that
/// only the end of the file tells whether an index is good.
struct HighestIndex {
  std::uint32_t index = 0;
  std::size_t place = 0; ///< line or byte offset, as the format counts; 0 if there was no index

  void note(std::uint32_t seen, std::size_t where) noexcept {
    if (place != 0 && seen <= index) return;
    index = seen;
    place = where;
  }
  bool is_beyond(std::size_t count) const noexcept { return place != 0 && index >= count; }
};

/// Returns the numbers as columns of `rows` numbers each.
template <int rows>
Eigen::Matrix<double, rows, Eigen::Dynamic> columns_of(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::Matrix<double, rows, Eigen::Dynamic>>(
      numbers.data(), rows, static_cast<Eigen::Index>(numbers.size()) / rows);
}

} // namespace nendo::deform
