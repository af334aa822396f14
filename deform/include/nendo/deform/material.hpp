#pragma once
// The appearance of a model, as its files define it: materials, textures, and names of its parts.
// Deformations do not change it.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <nendo/deform/index.hpp>

namespace nendo::deform {

/// The bytes of an image file of any format, not decoded. It may be damaged.
struct Texture {
  /// Path relative to the model's folder, always inside it.
  std::string file;
  /// The whole file; null if it was missing.
  std::shared_ptr<const std::string> contents;
};

/// Colours are linear, red, green, blue and opacity, from 0 to 1.
struct Material {
  std::string name;
  /// Base colour; nullopt if the model's file names the material, but no file defines it.
  std::optional<Eigen::Vector4f> colour;
  std::uint32_t texture = no_index; ///< base colour texture, which multiplies `colour`
  bool drawn = true;                ///< false: fully transparent, so its faces are not drawn
};

/// Names of faces: face f has the name names[of_face[f]], or none if of_face[f] is no_index. Both
/// are empty if no face has a name.
struct FaceNames {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_face;
  bool operator==(const FaceNames&) const = default;
};

/// The appearance of a model. A list is empty if the model has no such data.
struct Appearance {
  std::vector<Material> materials;
  std::vector<std::uint32_t> face_materials; ///< one for each face, or no_index
  std::vector<Texture> textures;
  Eigen::Matrix4Xf vertex_colours; ///< 4 by #vertices, linear; they multiply the base colour
  /// Corner colours, 4 by #texcoords, linear, if faces at a vertex differ in colour. They replace
  /// vertex_colours. A model without a texture then has texture coordinates of 0.
  Eigen::Matrix4Xf texcoord_colours;
  FaceNames groups;  ///< OBJ's g; several names are joined by spaces
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
