#include "files/gltf_extensions.hpp"

#include <algorithm>
#include <array>

namespace nendo::deform {

namespace {

constexpr std::string_view draco = "KHR_draco_mesh_compression";

bool is_meshopt(std::string_view name) noexcept {
  return name == "EXT_meshopt_compression" || name == "KHR_meshopt_compression" ||
         name == "MESHOPT_compression";
}

/// What is read here, or is a picture or a light that a model can do without.
bool is_known(std::string_view name) noexcept {
  constexpr std::array<std::string_view, 8> known{
      "KHR_mesh_quantization", "KHR_texture_transform", "EXT_mesh_gpu_instancing",
      "KHR_texture_basisu",    "EXT_texture_webp",      "EXT_texture_avif",
      "MSFT_texture_dds",      "KHR_xmp_json_ld"};
  return std::find(known.begin(), known.end(), name) != known.end() ||
         name.starts_with("KHR_materials_") || name.starts_with("KHR_lights_") ||
         name.starts_with("EXT_lights_");
}

} // namespace

void refuse_meshopt(const std::string& extension) {
  throw GltfRefusal{"is compressed by meshopt (" + extension.substr(0, 60) +
                    "), which is not read; export it without compression (gltfpack without -c and "
                    "-cc), or run: gltf-transform copy IN.glb OUT.glb"};
}

void refuse_draco() {
  throw GltfRefusal{
      "is compressed by Draco (KHR_draco_mesh_compression), which is not read; export "
      "it without compression, or run: gltf-transform copy IN.glb OUT.glb"};
}

void require_readable(const GltfDocument::Json& root) {
  const GltfDocument::Json* const required = gltf_member(root, "extensionsRequired");
  if (required == nullptr || !required->is_array()) return;
  for (const GltfDocument::Json& extension : *required) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : std::string();
    if (is_known(name)) continue;
    if (is_meshopt(name)) refuse_meshopt(name);
    if (name == draco) refuse_draco();
    throw GltfRefusal{"needs glTF's extension '" + name.substr(0, 60) +
                      "', which is not known here; export the model without it"};
  }
}

const GltfDocument::Json* gltf_extension(const GltfDocument::Json& item, const char* name) {
  const GltfDocument::Json* const extensions = gltf_member(item, "extensions");
  return extensions == nullptr ? nullptr : gltf_member(*extensions, name);
}

bool is_harmless_extension(std::string_view name) noexcept {
  constexpr std::array<std::string_view, 3> harmless{"KHR_xmp", "KHR_animation_pointer",
                                                     "KHR_accessor_float64"};
  return is_known(name) || is_meshopt(name) || name == draco ||
         std::find(harmless.begin(), harmless.end(), name) != harmless.end();
}

} // namespace nendo::deform
