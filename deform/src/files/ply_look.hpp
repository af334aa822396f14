#pragma once
// Texture coordinates and textures of a PLY. The format's paper has none; these are the forms that
// MeshLab, Blender and scanners' programs write: two numbers of each vertex, or a list of two for
// each corner of a face, `comment TextureFile NAME`, and a face's number among these files.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/read_notes.hpp>

namespace nendo::deform {

/// The names that programs give a vertex' texture coordinates, across and up.
inline constexpr std::array<std::array<std::string_view, 2>, 4> ply_texcoord_names{
    {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}};

/// Collects what a body says, value by value.
class PlyLook {
public:
  /// Texture coordinates of the next vertex.
  void add_vertex(double across, double up) { add(of_vertices_, across, up); }
  /// The next number of a face's list.
  void add_number(double number) { list_.push_back(number); }
  /// All of a face was read: it has so many corners, and the texture of this number.
  void end_face(std::size_t corners, double texture);

  /// Which of these the body has.
  bool has_vertices = false, has_faces = false, has_numbers = false;

  /// Gives the mesh, whose faces are complete, its texture coordinates, a material for each of
  /// these textures, and the textures without their contents.
  void finish(const std::vector<std::string>& textures, Mesh& mesh, ReadNotes& notes);

private:
  void add(std::vector<double>& to, double across, double up);
  void finish_corners(Mesh& mesh) const;
  void finish_materials(const std::vector<std::string>& textures, Mesh& mesh) const;

  std::vector<double> of_vertices_, of_corners_; ///< two numbers each
  std::vector<double> list_;                     ///< numbers of the face that is read
  std::vector<double> numbers_;                  ///< one per face
  std::size_t unusable_ = 0;                     ///< texture coordinates that are no number
  std::size_t faces_without_ = 0;
};

} // namespace nendo::deform
