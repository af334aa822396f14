// The writer of OBJ.

#include <nendo/deform/corner_colours.hpp>

#include "files/mesh_formats.hpp"
#include "files/mtl_file.hpp"
#include "files/number_text.hpp"
#include "files/srgb.hpp"

namespace nendo::deform {

namespace {

template <class Column>
void append_column(std::string& text, const Column& column) {
  for (const auto number : column) {
    text += ' ';
    append_number(text, number);
  }
}

void append_vertices(std::string& text, const Mesh& mesh) {
  const Eigen::Matrix4Xf colours = mean_vertex_colours(mesh);
  for (Eigen::Index vertex = 0; vertex < mesh.vertices.cols(); ++vertex) {
    text += 'v';
    append_column(text, mesh.vertices.col(vertex));
    if (vertex < colours.cols())
      append_column(text, colours.col(vertex).head<3>().unaryExpr(&encoded_of).eval());
    text += '\n';
  }
}

/// Writes a line where the name of the faces changes.
class ChangingName {
public:
  ChangingName(const char* keyword, std::vector<std::string> names,
               const std::vector<std::uint32_t>& of_face)
      : keyword_(keyword), names_(std::move(names)), of_face_(of_face) {}

  void before_face(std::size_t face, std::string& text) {
    if (of_face_.empty() || of_face_[face] == current_) return;
    current_ = of_face_[face];
    text += keyword_;
    if (current_ != no_index) text += " " + names_[current_];
    text += '\n';
  }

private:
  const char* keyword_;
  std::vector<std::string> names_;
  const std::vector<std::uint32_t>& of_face_;
  std::uint32_t current_ = no_index;
};

std::vector<std::string> line_names(const FaceNames& names) {
  std::vector<std::string> lines;
  for (const std::string& name : names.names)
    lines.push_back(line_name(name));
  return lines;
}

void append_face_lines(std::string& text, const Mesh& mesh) {
  const Appearance& look = mesh.look;
  ChangingName object("o", line_names(look.objects), look.objects.of_face);
  ChangingName group("g", line_names(look.groups), look.groups.of_face);
  const bool textured = has_texture_places(mesh);
  ChangingName material("usemtl", unique_names(look.materials), look.face_materials);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    for (ChangingName* name : {&object, &group, &material})
      name->before_face(face, text);
    text += 'f';
    for (std::size_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at) {
      text += ' ';
      append_number(text, std::uint64_t{mesh.face_corners[at]} + 1);
      if (!textured) continue;
      text += '/';
      append_number(text, std::uint64_t{mesh.corner_texcoords[at]} + 1);
    }
    text += '\n';
  }
}

} // namespace

std::string obj_text(const Mesh& mesh, std::string_view library) {
  std::string text = "# nendo\n";
  if (!library.empty()) text += "mtllib " + std::string(library) + "\n";
  append_vertices(text, mesh);
  const Eigen::Index texcoords = has_texture_places(mesh) ? mesh.texcoords.cols() : 0;
  for (Eigen::Index texcoord = 0; texcoord < texcoords; ++texcoord) {
    text += "vt";
    append_column(text, mesh.texcoords.col(texcoord));
    text += '\n';
  }
  append_face_lines(text, mesh);
  return text;
}

} // namespace nendo::deform
