#include "files/ply_look.hpp"

#include <tuple>

#include "files/mesh_formats.hpp"
#include "files/model_folder.hpp"
#include "files/number_text.hpp"
#include "geometry/usable.hpp"
#include "mesh/columns.hpp"

namespace nendo::deform {

void PlyLook::add(std::vector<double>& to, double across, double up) {
  const bool usable = is_usable(across) && is_usable(up);
  unusable_ += usable ? 0 : 1;
  to.push_back(usable ? across : 0.0);
  to.push_back(usable ? up : 0.0);
}

/// Faces without a texture have an empty list, or one that does not fit.
void PlyLook::end_face(std::size_t corners, double texture) {
  if (has_numbers) numbers_.push_back(texture);
  if (!has_faces) return list_.clear();
  const bool fits = list_.size() == 2 * corners;
  faces_without_ += fits ? 0 : 1;
  for (std::size_t at = 0; at < 2 * corners; at += 2)
    add(of_corners_, fits ? list_[at] : 0.0, fits ? list_[at + 1] : 0.0);
  list_.clear();
}

/// Corners of one vertex with the same coordinates share them: where they do not, a texture's
/// island ends.
void PlyLook::finish_corners(Mesh& mesh) const {
  const std::size_t count = mesh.face_corners.size();
  const std::vector<std::uint32_t> first = first_alike(count, [&](std::uint32_t at) {
    return std::tuple(mesh.face_corners[at], of_corners_[2 * std::size_t{at}],
                      of_corners_[2 * std::size_t{at} + 1]);
  });
  std::vector<std::uint32_t> number(count, no_index);
  std::vector<double> columns;
  mesh.corner_texcoords.reserve(count);
  for (std::uint32_t at = 0; at < count; ++at) {
    if (first[at] == at) {
      number[at] = static_cast<std::uint32_t>(columns.size() / 2);
      columns.insert(columns.end(),
                     {of_corners_[2 * std::size_t{at}], of_corners_[2 * std::size_t{at} + 1]});
    }
    mesh.corner_texcoords.push_back(number[first[at]]);
  }
  mesh.texcoords = columns_of<2>(columns);
}

/// Faces whose number is none of a texture have no material.
void PlyLook::finish_materials(const std::vector<std::string>& textures, Mesh& mesh) const {
  if (textures.empty() || mesh.face_count() == 0) return;
  for (const std::string& named : textures) {
    const std::string file = name_in_folder(named).value_or("texture");
    Material material;
    material.name = std::filesystem::path(file).stem().string();
    material.texture = to_index(mesh.look.textures.size());
    mesh.look.materials.push_back(std::move(material));
    mesh.look.textures.push_back({file, nullptr});
  }
  mesh.look.face_materials.assign(mesh.face_count(), 0);
  if (numbers_.size() != mesh.face_count()) return;
  for (std::size_t face = 0; face < numbers_.size(); ++face) {
    const double number = numbers_[face];
    const bool is_one = number >= 0.0 && number < static_cast<double>(textures.size());
    mesh.look.face_materials[face] = is_one ? static_cast<std::uint32_t>(number) : no_index;
  }
}

void PlyLook::finish(const std::vector<std::string>& textures, Mesh& mesh, ReadNotes& notes) {
  if (has_faces && of_corners_.size() == 2 * mesh.face_corners.size()) {
    finish_corners(mesh);
  } else if (has_vertices) {
    mesh.texcoords = columns_of<2>(of_vertices_);
    mesh.corner_texcoords = mesh.face_corners;
  }
  finish_materials(textures, mesh);
  if (has_faces && has_vertices)
    notes.emplace_back("the texture coordinates of vertices are left out, because faces have "
                       "their own");
  if (faces_without_ > 0)
    notes.push_back(count_words(faces_without_, "face has", "faces have") +
                    " no texture coordinates, or not two for each corner; their corners are at "
                    "(0, 0) of the texture");
  if (unusable_ > 0)
    notes.push_back(count_words(unusable_, "texture coordinate is", "texture coordinates are") +
                    " not finite; the corners there are at (0, 0) of the texture");
}

} // namespace nendo::deform
