#pragma once
// Converts meshes from and to the contents of files. mesh_file.hpp says what is kept and which
// errors there are.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
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
  std::vector<std::string> libraries; ///< the words of each mtllib: one file, or several
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

/// The largest index of a list and its place. A face may come before its vertices, so that only the
/// end of the file shows whether an index is good.
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
template <int rows, class Number>
Eigen::Matrix<Number, rows, Eigen::Dynamic> columns_of(const std::vector<Number>& numbers) {
  return Eigen::Map<const Eigen::Matrix<Number, rows, Eigen::Dynamic>>(
      numbers.data(), rows, static_cast<Eigen::Index>(numbers.size()) / rows);
}

/// Returns the number of corners of the face that has the most.
inline std::size_t max_corners(const Mesh& mesh) noexcept {
  std::size_t most = 0;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    most = std::max(most, mesh.corners_of(face).size());
  return most;
}

/// Gives the mesh these texture coordinates, two numbers each. Corners that have none (no_index)
/// share one more at (0, 0).
inline void set_texcoords(std::vector<double>& numbers, Mesh& mesh) {
  auto& of_corner = mesh.corner_texcoords;
  const auto extra = static_cast<std::uint32_t>(numbers.size() / 2);
  if (std::find(of_corner.begin(), of_corner.end(), no_index) != of_corner.end())
    numbers.insert(numbers.end(), {0.0, 0.0});
  std::replace(of_corner.begin(), of_corner.end(), no_index, extra);
  mesh.texcoords = columns_of<2>(numbers);
}

/// Returns an Error of kind bad_input whose message is "name: what".
inline Error bad_file(std::string_view name, const std::string& what) {
  return {Errc::bad_input, std::string(name) + ": " + what};
}

/// Returns the file's format and what to do with it, as words after the file's name; nothing if its
/// first bytes are those of no other format.
std::optional<std::string> foreign_format(std::string_view bytes);

/// Returns why a text is no model, for one in which no vertex was found: what it seems to be, or
/// what its first line is. The words follow the file's name.
std::string why_no_model(std::string_view text);

/// The beginning of each STL that stl_text() writes.
inline constexpr std::string_view stl_mark = "binary STL by nendo";

/// Returns whether the text is an STL: it begins with "solid" and has facets, or with "facet
/// normal", or is binary and has as many bytes as its count says. If `name` ends in .stl, all that
/// is binary is one.
bool is_stl(std::string_view text, std::string_view name) noexcept;

/// Reads an STL, text or binary (3D Systems 1988). Each facet has vertices of its own. Solids are
/// objects; colours of facets, in the forms of VisCAM and of Magics, are materials. Notes say what
/// is left out.
Result<Mesh> parse_stl(std::string_view text, std::string_view name,
                       std::vector<std::string>& notes);

/// Returns the mesh as binary STL. Error: failed (more triangles than an STL can count, or a
/// coordinate beyond its floats), in words for after the file's name.
Result<std::string> stl_text(const Mesh& mesh);

/// Returns how far a float's rounding moves a vertex at the most, in parts of the model's size.
double rounding_in_floats(const Mesh& mesh) noexcept;

} // namespace nendo::deform
