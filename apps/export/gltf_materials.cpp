#include "export/gltf_materials.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "render/paint.hpp"

namespace nendo::exporting {
namespace {

using Json = GlbFile::Json;

const Eigen::Vector4f clay(0.72F, 0.56F, 0.44F, 1.0F);

/// The media type of a picture that glTF allows.
const char* media_type_of(std::string_view contents) noexcept {
  return render::picture_kind_of(contents) == render::PictureKind::png ? "image/png" : "image/jpeg";
}

std::string without_ending(const std::string& file) {
  return std::filesystem::path(file).stem().string();
}

/// Of each texture of the look, its index in the file.
std::vector<std::optional<GlbFile::Index>> add_textures(const deform::Appearance& look,
                                                        GlbFile& file) {
  std::vector<std::optional<GlbFile::Index>> indices;
  for (const deform::Texture& texture : look.textures) {
    const auto contents = render::as_png_or_jpeg(texture.contents);
    indices.emplace_back();
    if (!contents) continue;
    const char* const type = media_type_of(*contents);
    const auto image = file.add("images", {{"name", without_ending(texture.file)},
                                           {"mimeType", type},
                                           {"bufferView", file.add_bytes(*contents)}});
    indices.back() = file.add("textures", {{"source", image}});
  }
  return indices;
}

Json material_named(const std::string& name, const Eigen::Vector4f& colour) {
  Json material{{"name", name},
                {"doubleSided", true},
                {"pbrMetallicRoughness",
                 {{"baseColorFactor", {colour[0], colour[1], colour[2], colour[3]}},
                  {"metallicFactor", 0.0},
                  {"roughnessFactor", 0.8}}}};
  if (colour[3] < 1.0F) material["alphaMode"] = "BLEND";
  return material;
}

} // namespace

const deform::Appearance& richest_of(std::span<const deform::Appearance* const> looks) noexcept {
  return **std::max_element(looks.begin(), looks.end(), [](const auto* one, const auto* other) {
    return one->materials.size() < other->materials.size();
  });
}

GltfMaterials::GltfMaterials(const deform::Appearance& look, GlbFile& file) {
  const auto textures = add_textures(look, file);
  for (const deform::Material& given : look.materials) {
    const bool has_texture = given.texture != deform::no_index && textures[given.texture];
    Eigen::Vector4f colour =
        given.colour.value_or(has_texture ? Eigen::Vector4f(Eigen::Vector4f::Ones()) : clay);
    if (!given.drawn) colour[3] = 0.0F;
    Json material = material_named(given.name, colour);
    if (has_texture)
      material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", *textures[given.texture]}};
    indices_.push_back(file.add("materials", std::move(material)));
  }
  const auto& of_face = look.face_materials;
  if (!of_face.empty() &&
      std::find(of_face.begin(), of_face.end(), deform::no_index) == of_face.end())
    return;
  plain_ = file.add("materials", look.has_colours() // they multiply it
                                     ? material_named("white", Eigen::Vector4f::Ones())
                                     : material_named("clay", clay));
}

} // namespace nendo::exporting
