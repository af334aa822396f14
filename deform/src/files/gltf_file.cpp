// The reader of glTF: all meshes of a scene, in their places, as one model.

#include <algorithm>
#include <limits>
#include <set>

#include <Eigen/Geometry>

#include <nendo/base/text.hpp>
#include <nendo/deform/read_notes.hpp>

#include "files/colour_range.hpp"
#include "files/gltf_document.hpp"
#include "files/gltf_scene.hpp"
#include "files/mesh_formats.hpp"
#include "files/mtl_file.hpp"
#include "files/number_text.hpp"
#include "geometry/usable.hpp"
#include "repair/weld.hpp"

namespace nendo::deform {
namespace {

using Json = GltfDocument::Json;

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
  for (const Json& mesh : gltf_list(root, "meshes")) {
    std::size_t targets = 0; // all primitives of a mesh have the same
    for (const Json& primitive : gltf_list(mesh, "primitives")) {
      targets = std::max(targets, gltf_list(primitive, "targets").size());
      const Json* const mode = gltf_member(primitive, "mode");
      if (mode != nullptr && *mode == 0) ++sum.points;
      if (mode != nullptr && (*mode == 1 || *mode == 2 || *mode == 3)) ++sum.lines;
      const Json* const attributes = gltf_member(primitive, "attributes");
      if (attributes == nullptr || !attributes->is_object()) continue;
      for (const auto& [name, accessor] : attributes->items())
        if (name.starts_with("COLOR_") && name != "COLOR_0") sum.further.insert(name);
    }
    sum.targets += targets;
  }
  return sum;
}

void note_motion(const Json& root, std::size_t targets, NoteSum& notes) {
  std::vector<std::string> parts;
  if (targets > 0) parts.push_back(count_words(targets, "morph target", "morph targets"));
  if (const std::size_t count = gltf_list(root, "animations").size(); count > 0)
    parts.push_back(count_words(count, "animation", "animations"));
  if (const std::size_t count = gltf_list(root, "skins").size(); count > 0)
    parts.push_back(count_words(count, "skeleton", "skeletons"));
  if (!parts.empty())
    notes.add(in_one_list(parts) + " left out; the model is read in its default shape and pose");
}

void note_further_textures(const Json& root, NoteSum& notes) {
  std::set<std::string> kinds;
  for (const Json& material : gltf_list(root, "materials")) {
    for (const auto& [member, kind] : {std::pair{"normalTexture", "normal"},
                                       {"emissiveTexture", "emissive"},
                                       {"occlusionTexture", "occlusion"}})
      if (gltf_member(material, member) != nullptr) kinds.insert(kind);
    const Json* const pbr = gltf_member(material, "pbrMetallicRoughness");
    if (pbr != nullptr && gltf_member(*pbr, "metallicRoughnessTexture") != nullptr)
      kinds.insert("metallic-roughness");
  }
  if (!kinds.empty())
    notes.add("of materials, base colours and their textures are read; left out: " +
              in_one_list({kinds.begin(), kinds.end()}) + " textures");
}

void note_variants(const Json& root, NoteSum& notes) {
  const Json* const variants = gltf_extension(root, "KHR_materials_variants");
  if (variants == nullptr) return;
  for (const Json& variant : gltf_list(*variants, "variants")) {
    notes.add("variant of materials", gltf_text(variant, "name"),
              ": is left out; the default materials are read");
  }
}

/// Notes what is not read of the document: what moves it, further scenes, variants, textures that
/// are not of the base colour, further colours of vertices, points and lines, unknown
/// extensions. It looks at all meshes, also at those that no scene has.
void note_left_out(const GltfDocument& document, NoteSum& notes) {
  const Json& root = document.root();
  const PrimitiveCounts primitives = primitives_of(root);
  note_motion(root, primitives.targets, notes);
  std::vector<std::string> loose;
  if (primitives.points > 0)
    loose.push_back(count_words(primitives.points, "set of points", "sets of points"));
  if (primitives.lines > 0)
    loose.push_back(count_words(primitives.lines, "set of lines", "sets of lines"));
  if (!loose.empty()) notes.add(in_one_list(loose) + " left out; only faces are read");
  for (const std::string& name : primitives.further)
    notes.add("colours of vertices", name, ": are left out; those of COLOR_0 are read");
  note_further_textures(root, notes);
  note_variants(root, notes);
  if (const std::size_t scenes = document.size_of("scenes"); scenes > 1)
    notes.add(count_words(scenes - 1, "scene", "scenes") +
              " left out; the default scene is read, so export each by itself if it is wanted");
  for (const Json& extension : gltf_list(root, "extensionsUsed")) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : std::string();
    if (!name.empty() && !is_harmless_extension(name))
      notes.add("glTF's extension", name, ": is not known here, so what it adds is left out");
  }
}

// Nodes may show a mesh again and again, so a small file can be a model without end.
constexpr std::size_t max_model_vertices = 20'000'000;
constexpr std::size_t max_model_corners = 120'000'000;
constexpr std::size_t max_read_vertices = 200'000'000;
constexpr std::uint64_t no_accessor = std::numeric_limits<std::uint64_t>::max();
// glTF's modes of primitives.
constexpr std::uint64_t triangles_mode = 4, strip_mode = 5, fan_mode = 6;

ColourNumbers gltf_colour_numbers(std::uint64_t component_type) noexcept {
  constexpr std::uint64_t int8 = 5120, uint8 = 5121, float32 = 5126;
  if (component_type == float32) return ColourNumbers::floats;
  return component_type == int8 || component_type == uint8 ? ColourNumbers::int8
                                                           : ColourNumbers::int16;
}

/// The numbers of one vertex that make it another vertex: place, normal and colour.
using VertexKey = std::array<float, 10>;

class GltfReader {
public:
  GltfReader(std::string_view text, const ModelFolder* folder) : document_(text, folder) {}

  /// `weld`: vertices of one place that normals or colours part become one as well.
  Mesh read(bool weld, ReadNotes& notes) {
    materials_ = read_gltf_materials(document_, mesh_.look, notes_);
    note_left_out(document_, notes_);
    for (const GltfPlacedMesh& placed : placed_meshes(document_))
      add_mesh(placed);
    finish();
    settle_hidden(mesh_.look, notes_);
    notes_.append_to(notes);
    if (weld) weld_places(mesh_, group_of_vertex_);
    return std::move(mesh_);
  }

private:
  struct Part { ///< a primitive's numbers
    GltfNumbers places;
    std::optional<GltfNumbers> normals, colours, texcoords;
  };

  void add_mesh(const GltfPlacedMesh& placed) {
    const Json& mesh = document_.item("meshes", placed.mesh);
    known_.clear();
    vertices_of_.clear();
    const auto object = to_index(mesh_.look.objects.names.size());
    const std::size_t faces_before = mesh_.face_count();
    for (const Json& primitive : gltf_list(mesh, "primitives"))
      add_primitive(primitive, placed);
    group_of_vertex_.resize(vertices_.size() / 3, object);
    if (mesh_.face_count() == faces_before) return;
    const std::string name = gltf_text(mesh, "name");
    mesh_.look.objects.names.push_back(placed.name.empty() ? name : placed.name);
    mesh_.look.objects.of_face.resize(mesh_.face_count(), object);
  }

  Part part_of(const Json& primitive, const Json& attributes, std::uint32_t material) {
    const auto numbers = [&](const std::string& name, std::size_t min_width,
                             std::size_t count) -> std::optional<GltfNumbers> {
      if (gltf_member(attributes, name.c_str()) == nullptr) return std::nullopt;
      auto found = document_.numbers(gltf_count(attributes, name.c_str(), 0));
      if (found.width < min_width || (count > 0 && found.count != count))
        throw GltfRefusal{"a primitive's " + name + " is of another size than its vertices"};
      return found;
    };
    if (gltf_extension(primitive, "KHR_draco_mesh_compression") != nullptr &&
        gltf_member(document_.item("accessors", gltf_count(attributes, "POSITION", 0)),
                    "bufferView") == nullptr)
      refuse_draco();
    auto places = numbers("POSITION", 3, 0);
    if (!places || places->width != 3) throw GltfRefusal{"a primitive has no POSITION of VEC3"};
    const std::size_t count = places->count;
    numbers_read_ += count;
    if (numbers_read_ > max_read_vertices)
      throw GltfRefusal{"reads more than 200 million vertices, some of them again and again"};
    Part part{*std::move(places), numbers("NORMAL", 3, count), numbers("COLOR_0", 3, count), {}};
    if (part.colours) settle_colours(gltf_count(attributes, "COLOR_0", 0), *part.colours);
    const std::uint32_t set = material == no_index ? 0 : materials_[material].texcoord_set;
    part.texcoords = numbers("TEXCOORD_" + std::to_string(set), 2, count);
    if (gltf_count(primitive, "mode", triangles_mode) > fan_mode)
      throw GltfRefusal{"a primitive has a mode that glTF does not know"};
    return part;
  }

  /// Brings colours that are no parts of 1 to these: of integers that the file forgot to call
  /// normalized, or of floats up to 255.
  void settle_colours(std::uint64_t accessor, GltfNumbers& colours) {
    const Json& given = document_.item("accessors", accessor);
    if (gltf_flag(given, "normalized")) return;
    ColourRange range(gltf_colour_numbers(gltf_count(given, "componentType", 0)));
    for (const double part : colours.values)
      range.see(part);
    for (double& part : colours.values)
      part = static_cast<double>(range.part_of(part));
    if (const std::string note = range.note(); !note.empty()) notes_.add("COLOR_0: " + note);
  }

  /// Notes a texture that has no place on the primitive, and coordinates that are not used.
  void note_placing(const Part& part, const Json& attributes, std::uint32_t material) {
    const std::uint32_t set = material == no_index ? 0 : materials_[material].texcoord_set;
    for (const char* const name : {"TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2", "TEXCOORD_3"})
      if (gltf_member(attributes, name) != nullptr && name != "TEXCOORD_" + std::to_string(set))
        notes_.add("texture coordinates", name,
                   ": are left out; those of the base colour are read");
    if (part.texcoords || material == no_index) return;
    const Material& of = mesh_.look.materials[material];
    if (of.texture != no_index && mesh_.look.textures[of.texture].contents)
      notes_.add("texture", mesh_.look.textures[of.texture].file,
                 ": a part of the model has no texture coordinates for it, so it is not shown "
                 "there");
  }

  void add_primitive(const Json& primitive, const GltfPlacedMesh& placed) {
    const Json* const attributes = gltf_member(primitive, "attributes");
    if (attributes == nullptr) throw GltfRefusal{"a primitive has no attributes"};
    std::uint32_t material = no_index;
    if (gltf_member(primitive, "material") != nullptr) {
      const std::uint64_t number = gltf_count(primitive, "material", 0);
      document_.item("materials", number);
      material = static_cast<std::uint32_t>(number);
    }
    Part part = part_of(primitive, *attributes, material);
    if (!placed.weights.empty())
      numbers_read_ += apply_targets(document_, primitive, placed.weights, part.places);
    note_placing(part, *attributes, material);
    const auto accessor = [&](const char* name) {
      return gltf_count(*attributes, name, no_accessor);
    };
    auto& vertices = vertices_of_[{accessor("POSITION"), accessor("NORMAL"), accessor("COLOR_0")}];
    // Targets move vertices of one accessor differently in two primitives.
    if (vertices.empty() || !placed.weights.empty())
      vertices = add_vertices(part, *attributes, placed);
    const std::uint32_t first_texcoord = texcoords_of(part, *attributes, material);
    const auto corners = corners_of(primitive, part.places.count);
    const bool mirrored = placed.mirrors();
    for (const std::array<std::uint32_t, 3>& triangle : corners) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = triangle[mirrored ? 2 - k : k];
        mesh_.face_corners.push_back(vertices[corner]);
        mesh_.corner_texcoords.push_back(part.texcoords ? first_texcoord + corner : no_index);
      }
      mesh_.face_starts.push_back(to_index(mesh_.face_corners.size()));
      mesh_.look.face_materials.push_back(material);
    }
    if (mesh_.face_corners.size() > max_model_corners)
      throw GltfRefusal{"has more than 120 million corners"};
  }

  /// Of each of the part's vertices, the model's. Exporters split a vertex where texture
  /// coordinates or materials meet; it becomes one again. Where normals differ, it stays
  /// split.
  std::vector<std::uint32_t> add_vertices(const Part& part, const Json& attributes,
                                          const GltfPlacedMesh& placed) {
    const std::vector<Eigen::Vector3d> moved = placed.moved(document_, attributes, part.places);
    std::vector<std::uint32_t> vertices;
    for (std::size_t at = 0; at < part.places.count; ++at) {
      VertexKey key{};
      const auto put = [&](const std::optional<GltfNumbers>& numbers, std::size_t first) {
        if (!numbers) return;
        for (std::size_t k = 0; k < std::min<std::size_t>(numbers->width, 4); ++k)
          key[first + k] = static_cast<float>(numbers->row(at)[k]) + 0.0F; // no -0
      };
      for (std::size_t k = 0; k < 3; ++k)
        key[k] = static_cast<float>(moved[at][static_cast<Eigen::Index>(k)]) + 0.0F;
      put(part.normals, 3);
      put(part.colours, 6);
      const auto next = static_cast<std::uint32_t>(vertices_.size() / 3);
      const auto [place, is_new] = known_.emplace(key, next);
      vertices.push_back(place->second);
      if (!is_new) continue;
      if (!all_usable(moved[at])) throw GltfRefusal{"a vertex is not finite or beyond 1e100"};
      vertices_.insert(vertices_.end(), moved[at].begin(), moved[at].end());
      if (part.colours) add_colour(part.colours->row(at), part.colours->width);
    }
    if (vertices_.size() / 3 > max_model_vertices)
      throw GltfRefusal{"has more than 20 million vertices"};
    return vertices;
  }

  void add_colour(const double* channels, std::size_t width) {
    colours_.resize(4 * (vertices_.size() / 3 - 1), 1.0F);
    for (std::size_t k = 0; k < 4; ++k)
      colours_.push_back(k < width ? static_cast<float>(std::clamp(channels[k], 0.0, 1.0)) : 1.0F);
  }

  /// The number of the part's first texture coordinate. Primitives that share them do so here.
  std::uint32_t texcoords_of(const Part& part, const Json& attributes, std::uint32_t material) {
    if (!part.texcoords) return no_index;
    Eigen::Affine2d turned = Eigen::Affine2d::Identity();
    std::uint32_t set = 0;
    bool is_turned = false;
    if (material != no_index) {
      turned = materials_[material].texture_transform;
      set = materials_[material].texcoord_set;
      is_turned = turned.matrix() != Eigen::Affine2d::Identity().matrix();
    }
    const std::string name = "TEXCOORD_" + std::to_string(set);
    const auto next = static_cast<std::uint32_t>(texcoords_.size() / 2);
    const auto [place, is_new] = first_texcoords_.emplace(
        std::pair(gltf_count(attributes, name.c_str(), 0), is_turned ? material : no_index), next);
    if (!is_new) return place->second;
    for (std::size_t at = 0; at < part.texcoords->count; ++at) {
      const double* const uv = part.texcoords->row(at);
      const Eigen::Vector2d moved = turned * Eigen::Vector2d(uv[0], uv[1]);
      // glTF counts from the top of the picture, and everyone else from the bottom.
      if (!all_usable(moved)) throw GltfRefusal{"a texture coordinate is beyond 1e100"};
      texcoords_.insert(texcoords_.end(), {moved.x(), 1.0 - moved.y()});
    }
    return next;
  }

  std::vector<std::array<std::uint32_t, 3>> corners_of(const Json& primitive,
                                                       std::size_t count) const {
    std::vector<std::uint32_t> order = all_indices(count);
    if (gltf_member(primitive, "indices") != nullptr) {
      const GltfNumbers indices = document_.numbers(gltf_count(primitive, "indices", 0));
      order.clear();
      for (const double index : indices.values) {
        if (!(index >= 0.0 && index < static_cast<double>(count)) || indices.width != 1)
          throw GltfRefusal{"a face names a vertex that is not there"};
        order.push_back(static_cast<std::uint32_t>(index));
      }
    }
    const std::uint64_t mode = gltf_count(primitive, "mode", triangles_mode);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    if (mode < triangles_mode || order.size() < 3) return triangles; // points and lines
    for (std::size_t at = 0; at + 2 < order.size(); at += mode == triangles_mode ? 3 : 1) {
      const bool turned = mode == strip_mode && at % 2 == 1;
      triangles.push_back({order[mode == fan_mode ? 0 : at], order[at + (turned ? 2 : 1)],
                           order[at + (turned ? 1 : 2)]});
    }
    return triangles;
  }

  void finish() {
    mesh_.vertices = columns_of<3>(vertices_);
    Appearance& look = mesh_.look;
    const bool has_materials = std::any_of(look.face_materials.begin(), look.face_materials.end(),
                                           [](std::uint32_t of) { return of != no_index; });
    if (!has_materials) {
      look.face_materials.clear();
      look.materials.clear();
      look.textures.clear();
    }
    if (!colours_.empty()) {
      colours_.resize(4 * mesh_.vertex_count(), 1.0F);
      look.vertex_colours = columns_of<4>(colours_);
    }
    if (texcoords_.empty()) {
      mesh_.corner_texcoords.clear();
      return;
    }
    set_texcoords(texcoords_, mesh_);
  }

  GltfDocument document_;
  std::vector<std::uint32_t> group_of_vertex_; ///< the placed mesh whose it is
  std::vector<GltfMaterial> materials_;
  std::vector<double> vertices_;             ///< three numbers each
  std::vector<double> texcoords_;            ///< two numbers each
  std::vector<float> colours_;               ///< the first vertices', four numbers each
  std::map<VertexKey, std::uint32_t> known_; ///< vertices of this mesh
  /// Of this mesh, by the accessors of POSITION, NORMAL and COLOR_0.
  std::map<std::array<std::uint64_t, 3>, std::vector<std::uint32_t>> vertices_of_;
  /// By the accessor, and the material if that turns them.
  std::map<std::pair<std::uint64_t, std::uint32_t>, std::uint32_t> first_texcoords_;
  std::size_t numbers_read_ = 0;
  NoteSum notes_;
  Mesh mesh_;
};

} // namespace

Result<Mesh> parse_gltf(std::string_view text, std::string_view name, const ModelFolder* folder,
                        const ReadOptions& options, ReadNotes& notes) {
  try {
    return GltfReader(text, folder).read(options.weld, notes);
  } catch (const GltfRefusal& refusal) {
    return bad_file(name, printable(refusal.what));
  }
}

} // namespace nendo::deform
