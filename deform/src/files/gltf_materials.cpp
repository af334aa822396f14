#include "files/gltf_scene.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "files/gltf_document.hpp"

namespace nendo::deform {

namespace {

using Json = GltfDocument::Json;

/// Keeps the textures of a document, each image once.
class GltfTextures {
public:
  GltfTextures(const GltfDocument& document, Appearance& look, NoteSum& notes)
      : document_(document), look_(look), notes_(notes) {}

  /// The number, in the look, of the texture that a textureInfo names.
  std::uint32_t number_of(const Json& info) {
    const Json& texture = document_.item("textures", gltf_count(info, "index", 0));
    const auto source = source_of(texture);
    if (!source) return no_index;
    const Json& image = document_.item("images", *source);
    const auto next = to_index(look_.textures.size());
    const auto [place, is_new] = numbers_.emplace(*source, next);
    if (is_new) add(image, *source);
    return place->second;
  }

private:
  /// The number of the image. Where a picture of another format has a PNG or JPEG beside it, that.
  static std::optional<std::uint64_t> source_of(const Json& texture) {
    if (gltf_member(texture, "source") != nullptr) return gltf_count(texture, "source", 0);
    for (const char* const name :
         {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"})
      if (const Json* const other = gltf_extension(texture, name);
          other != nullptr && gltf_member(*other, "source") != nullptr)
        return gltf_count(*other, "source", 0);
    return std::nullopt;
  }

  void add(const Json& image, std::uint64_t source) {
    FolderFile file = document_.image(image);
    Texture texture{name_of(image, source, file), nullptr};
    if (file.contents && file.contents->size() > left_) {
      file.contents.reset();
      file.lack = too_large_lack;
    }
    if (file.contents) {
      left_ -= file.contents->size();
      texture.contents = std::make_shared<const std::string>(*std::move(file.contents));
    } else {
      const std::string uri = gltf_text(image, "uri");
      notes_.add("texture", uri.empty() || is_data_uri(uri) ? texture.file : percent_decoded(uri),
                 file.lack);
    }
    look_.textures.push_back(std::move(texture));
  }

  static std::string name_of(const Json& image, std::uint64_t source, const FolderFile& file) {
    if (!file.name.empty()) return file.name;
    const std::string uri = gltf_text(image, "uri");
    if (!uri.empty() && !is_data_uri(uri))
      if (auto name = name_in_folder(percent_decoded(uri))) return *std::move(name);
    const std::string_view contents = file.contents ? std::string_view(*file.contents) : "";
    const std::string ending = contents.starts_with("\xFF\xD8") ? ".jpg" : ".png";
    auto name = name_in_folder(gltf_text(image, "name"));
    if (!name) name = "texture-" + std::to_string(source + 1);
    return name->ends_with(ending) ? *name : *name + ending;
  }

  const GltfDocument& document_;
  Appearance& look_;
  NoteSum& notes_;
  std::map<std::uint64_t, std::uint32_t> numbers_;
  std::uint64_t left_ = ModelFolder::max_texture_bytes; // many images could be one view
};

Eigen::Affine2d transform_of(const Json& info) {
  Eigen::Affine2d transform = Eigen::Affine2d::Identity();
  const Json* const given = gltf_extension(info, "KHR_texture_transform");
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

/// Where a material has its base colour: both names are of members of `in`, which may be null.
struct BaseColour {
  const Json* in = nullptr;
  const char* factor = "baseColorFactor";
  const char* texture = "baseColorTexture";
};

BaseColour base_of(const Json& material) {
  const char* const older = "KHR_materials_pbrSpecularGlossiness";
  if (const Json* const diffuse = gltf_extension(material, older);
      diffuse != nullptr && gltf_member(material, "pbrMetallicRoughness") == nullptr)
    return {diffuse, "diffuseFactor", "diffuseTexture"};
  return {gltf_member(material, "pbrMetallicRoughness")};
}

Eigen::Vector4f base_colour(const BaseColour& base) {
  Eigen::Vector4f colour = Eigen::Vector4f::Ones();
  const auto factor =
      base.in == nullptr ? std::vector<double>() : gltf_numbers(*base.in, base.factor, 4);
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

std::vector<GltfMaterial> read_gltf_materials(const GltfDocument& document, Appearance& look,
                                              NoteSum& notes) {
  std::vector<GltfMaterial> materials;
  GltfTextures textures(document, look, notes);
  for (std::size_t at = 0; at < document.size_of("materials"); ++at) {
    const Json& given = document.item("materials", at);
    const BaseColour base = base_of(given);
    Material material{gltf_text(given, "name"), base_colour(base), no_index, true};
    (*material.colour)[3] = opacity_of_material(given, (*material.colour)[3]);
    material.drawn = (*material.colour)[3] > 0.0F;
    GltfMaterial& more = materials.emplace_back();
    const Json* const info = base.in == nullptr ? nullptr : gltf_member(*base.in, base.texture);
    if (info != nullptr) {
      material.texture = textures.number_of(*info);
      more.texcoord_set =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(gltf_count(*info, "texCoord", 0), 99));
      more.texture_transform = transform_of(*info);
      if (gltf_text(given, "alphaMode") == "MASK" || gltf_text(given, "alphaMode") == "BLEND")
        notes.add("material", material.name,
                  ": the transparency of its texture is left out, so what it hides is seen");
    }
    look.materials.push_back(std::move(material));
  }
  return materials;
}

} // namespace nendo::deform
