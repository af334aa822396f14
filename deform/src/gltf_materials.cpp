#include "gltf_materials.hpp"

#include <algorithm>
#include <map>

#include "uri.hpp"

namespace nendo::deform {

namespace {

using Json = GltfDocument::Json;

/// Keeps the textures of a document, each image once.
class GltfTextures {
public:
  GltfTextures(const GltfDocument& document, Appearance& look) : document_(document), look_(look) {}

  /// The number, in the look, of the texture that a textureInfo names.
  std::uint32_t number_of(const Json& info) {
    const Json& texture = document_.item("textures", gltf_count(info, "index", 0));
    if (gltf_member(texture, "source") == nullptr) return no_index;
    const std::uint64_t source = gltf_count(texture, "source", 0);
    const Json& image = document_.item("images", source);
    const auto next = static_cast<std::uint32_t>(look_.textures.size());
    const auto [place, is_new] = numbers_.emplace(source, next);
    if (is_new) add(image, source);
    return place->second;
  }

private:
  void add(const Json& image, std::uint64_t source) {
    std::string contents = document_.image(image);
    Texture texture{name_of(image, source, contents), nullptr};
    if (!contents.empty() && contents.size() <= left_) {
      left_ -= contents.size();
      texture.contents = std::make_shared<const std::string>(std::move(contents));
    }
    look_.textures.push_back(std::move(texture));
  }

  static std::string name_of(const Json& image, std::uint64_t source, std::string_view contents) {
    const std::string uri = gltf_text(image, "uri");
    if (!uri.empty() && !is_data_uri(uri))
      if (auto name = name_in_folder(percent_decoded(uri))) return *std::move(name);
    const std::string ending = contents.starts_with("\xFF\xD8") ? ".jpg" : ".png";
    auto name = name_in_folder(gltf_text(image, "name"));
    if (!name) name = "texture-" + std::to_string(source + 1);
    return name->ends_with(ending) ? *name : *name + ending;
  }

  const GltfDocument& document_;
  Appearance& look_;
  std::map<std::uint64_t, std::uint32_t> numbers_;
  std::uint64_t left_ = ModelFolder::most_texture_bytes; // many images could be one view
};

Eigen::Affine2d transform_of(const Json& info) {
  Eigen::Affine2d transform = Eigen::Affine2d::Identity();
  const Json* const extensions = gltf_member(info, "extensions");
  const Json* const given =
      extensions == nullptr ? nullptr : gltf_member(*extensions, "KHR_texture_transform");
  if (given == nullptr) return transform;
  const auto offset = gltf_numbers(*given, "offset", 2);
  const auto scale = gltf_numbers(*given, "scale", 2);
  if (!offset.empty()) transform.translate(Eigen::Vector2d(offset[0], offset[1]));
  const Json* const rotation = gltf_member(*given, "rotation");
  // Its axes are those of glTF's pictures, whose y points down.
  if (rotation != nullptr && rotation->is_number())
    transform.rotate(Eigen::Rotation2Dd(-rotation->get<double>()));
  if (!scale.empty()) transform.scale(Eigen::Vector2d(scale[0], scale[1]));
  return transform;
}

Eigen::Vector4f base_colour(const Json* pbr) {
  Eigen::Vector4f colour = Eigen::Vector4f::Ones();
  const auto factor =
      pbr == nullptr ? std::vector<double>() : gltf_numbers(*pbr, "baseColorFactor", 4);
  for (std::size_t channel = 0; channel < factor.size(); ++channel)
    colour[static_cast<Eigen::Index>(channel)] =
        static_cast<float>(std::clamp(factor[channel], 0.0, 1.0));
  return colour;
}

/// The opacity that a material has in effect.
float opacity_of_material(const Json& material, float alpha) {
  const std::string mode = gltf_text(material, "alphaMode");
  if (mode == "BLEND") return alpha;
  if (mode != "MASK") return 1.0F;
  const Json* const cutoff = gltf_member(material, "alphaCutoff");
  const double least = cutoff != nullptr && cutoff->is_number() ? cutoff->get<double>() : 0.5;
  return static_cast<double>(alpha) >= least ? 1.0F : 0.0F;
}

} // namespace

std::vector<GltfMaterial> read_gltf_materials(const GltfDocument& document, Appearance& look) {
  std::vector<GltfMaterial> materials;
  GltfTextures textures(document, look);
  for (std::size_t at = 0; at < document.size_of("materials"); ++at) {
    const Json& given = document.item("materials", at);
    const Json* const pbr = gltf_member(given, "pbrMetallicRoughness");
    Material material{gltf_text(given, "name"), base_colour(pbr), no_index, true};
    (*material.colour)[3] = opacity_of_material(given, (*material.colour)[3]);
    material.drawn = (*material.colour)[3] > 0.0F;
    GltfMaterial& more = materials.emplace_back();
    const Json* const info = pbr == nullptr ? nullptr : gltf_member(*pbr, "baseColorTexture");
    if (info != nullptr) {
      material.texture = textures.number_of(*info);
      more.texcoord_set =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(gltf_count(*info, "texCoord", 0), 99));
      more.texture_transform = transform_of(*info);
    }
    look.materials.push_back(std::move(material));
  }
  return materials;
}

} // namespace nendo::deform
