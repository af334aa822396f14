#pragma once
// What a model looks like, as far as its files say: materials, textures, and names of its parts. A
// deformation changes none of it.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <nendo/deform/index.hpp>

namespace nendo::deform {

/// A picture file as it was read, of any format. It is not decoded, and may be damaged.
struct Texture {
  /// Its name relative to the model's folder. It never leads out of that folder.
  std::string file;
  /// The whole file; null if there was none.
  std::shared_ptr<const std::string> contents;
};

/// Colours are linear, red, green, blue and opacity, from 0 to 1.
struct Material {
  std::string name;
  /// Unknown if the model's file names the material, but no file says what it is like.
  std::optional<Eigen::Vector4f> colour;
  std::uint32_t texture = no_index; ///< the texture of the base colour, which it multiplies
  bool drawn = true;                ///< false: wholly transparent, so pictures leave its faces out
};

/// Names of faces: face f belongs to names[of_face[f]], or to none if that is no_index. Both are
/// empty if no face has a name.
struct FaceNames {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_face;
  bool operator==(const FaceNames&) const = default;
};

/// What a model looks like. Each list is empty if the model has nothing of the kind.
struct Appearance {
  std::vector<Material> materials;
  std::vector<std::uint32_t> face_materials; ///< one for each face, or no_index
  std::vector<Texture> textures;
  Eigen::Matrix4Xf vertex_colours; ///< 4 by #vertices, linear; they multiply the base colour
  /// 4 by #texcoords, linear: colours of corners, where the faces at a vertex differ in colour.
  /// They replace vertex_colours. A model without a texture then has texture coordinates of 0.
  Eigen::Matrix4Xf texcoord_colours;
  FaceNames groups;  ///< OBJ's g; several names are one, with blanks between them
  FaceNames objects; ///< OBJ's o, or glTF's nodes

  bool has_colours() const noexcept {
    return vertex_colours.cols() > 0 || texcoord_colours.cols() > 0;
  }
  /// Returns the face's material, or null. The pointer is valid as long as `materials` is.
  const Material* material_of(std::size_t face) const noexcept {
    if (face_materials.empty() || face_materials[face] == no_index) return nullptr;
    return &materials[face_materials[face]];
  }
};

} // namespace nendo::deform
