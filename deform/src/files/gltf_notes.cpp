#include "files/gltf_notes.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "files/gltf_extensions.hpp"

namespace nendo::deform {

namespace {

using Json = GltfDocument::Json;

/// Calls `visit` with each item of a list that an object may have.
template <class Visit>
void visit_list(const Json& object, const char* name, const Visit& visit) {
  const Json* const list = gltf_member(object, name);
  if (list == nullptr || !list->is_array()) return;
  for (const Json& item : *list)
    visit(item);
}

std::size_t list_length(const Json& object, const char* name) {
  const Json* const list = gltf_member(object, name);
  return list != nullptr && list->is_array() ? list->size() : 0;
}

std::string count_of_things(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string in_one_list(const std::vector<std::string>& parts) {
  std::string text;
  for (std::size_t at = 0; at < parts.size(); ++at)
    text += (at == 0 ? "" : at + 1 == parts.size() ? " and " : ", ") + parts[at];
  return text;
}

/// What the primitives have, counted once for each mesh or primitive.
struct PrimitiveCounts {
  std::size_t targets = 0, points = 0, lines = 0;
  std::set<std::string> further; ///< names of attributes
};

PrimitiveCounts primitives_of(const Json& root) {
  PrimitiveCounts sum;
  visit_list(root, "meshes", [&](const Json& mesh) {
    std::size_t targets = 0; // all primitives of a mesh have the same
    visit_list(mesh, "primitives", [&](const Json& primitive) {
      targets = std::max(targets, list_length(primitive, "targets"));
      const Json* const mode = gltf_member(primitive, "mode");
      if (mode != nullptr && *mode == 0) ++sum.points;
      if (mode != nullptr && (*mode == 1 || *mode == 2 || *mode == 3)) ++sum.lines;
      const Json* const attributes = gltf_member(primitive, "attributes");
      if (attributes == nullptr || !attributes->is_object()) return;
      for (const auto& [name, accessor] : attributes->items())
        if (name.starts_with("COLOR_") && name != "COLOR_0") sum.further.insert(name);
    });
    sum.targets += targets;
  });
  return sum;
}

void note_motion(const Json& root, std::size_t targets, NoteSum& notes) {
  std::vector<std::string> parts;
  if (targets > 0) parts.push_back(count_of_things(targets, "morph target", "morph targets"));
  if (const std::size_t count = list_length(root, "animations"); count > 0)
    parts.push_back(count_of_things(count, "animation", "animations"));
  if (const std::size_t count = list_length(root, "skins"); count > 0)
    parts.push_back(count_of_things(count, "skeleton", "skeletons"));
  if (!parts.empty())
    notes.add(in_one_list(parts) + " left out; the model is read in its default shape and pose");
}

void note_further_textures(const Json& root, NoteSum& notes) {
  std::set<std::string> kinds;
  visit_list(root, "materials", [&](const Json& material) {
    for (const auto& [member, kind] : {std::pair{"normalTexture", "normal"},
                                       {"emissiveTexture", "emissive"},
                                       {"occlusionTexture", "occlusion"}})
      if (gltf_member(material, member) != nullptr) kinds.insert(kind);
    const Json* const pbr = gltf_member(material, "pbrMetallicRoughness");
    if (pbr != nullptr && gltf_member(*pbr, "metallicRoughnessTexture") != nullptr)
      kinds.insert("metallic-roughness");
  });
  if (!kinds.empty())
    notes.add("of materials, base colours and their textures are read; left out: " +
              in_one_list({kinds.begin(), kinds.end()}) + " textures");
}

void note_variants(const Json& root, NoteSum& notes) {
  const Json* const variants = gltf_extension(root, "KHR_materials_variants");
  if (variants == nullptr) return;
  visit_list(*variants, "variants", [&](const Json& variant) {
    notes.add("variant of materials", gltf_text(variant, "name"),
              ": is left out; the default materials are read");
  });
}

} // namespace

void note_left_out(const GltfDocument& document, NoteSum& notes) {
  const Json& root = document.root();
  const PrimitiveCounts primitives = primitives_of(root);
  note_motion(root, primitives.targets, notes);
  std::vector<std::string> loose;
  if (primitives.points > 0)
    loose.push_back(count_of_things(primitives.points, "set of points", "sets of points"));
  if (primitives.lines > 0)
    loose.push_back(count_of_things(primitives.lines, "set of lines", "sets of lines"));
  if (!loose.empty()) notes.add(in_one_list(loose) + " left out; only faces are read");
  for (const std::string& name : primitives.further)
    notes.add("colours of vertices", name, ": are left out; those of COLOR_0 are read");
  note_further_textures(root, notes);
  note_variants(root, notes);
  if (const std::size_t scenes = document.size_of("scenes"); scenes > 1)
    notes.add(count_of_things(scenes - 1, "scene", "scenes") +
              " left out; the default scene is read, so export each by itself if it is wanted");
  visit_list(root, "extensionsUsed", [&](const Json& extension) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : std::string();
    if (!name.empty() && !is_harmless_extension(name))
      notes.add("glTF's extension", name, ": is not known here, so what it adds is left out");
  });
}

} // namespace nendo::deform
