#include "export/gltf_model.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/deform/corner_colours.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/triangles.hpp>

#include "render/texture_image.hpp"

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
  return **std::ranges::max_element(looks, {}, [](auto* look) { return look->materials.size(); });
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
  if (!of_face.empty() && std::ranges::find(of_face, deform::no_index) == of_face.end()) return;
  plain_ = file.add("materials", look.has_colours() // they multiply it
                                     ? material_named("white", Eigen::Vector4f::Ones())
                                     : material_named("clay", clay));
}

using Eigen::Index;
using Use = GlbFile::Use;

namespace {

constexpr int points_mode = 0; // glTF's: no triangles

/// At least as large as the vectors' coordinates, and a power of two, so that a target, a weight
/// and their product lose nothing that the influence and the vector have not lost.
float scale_for(float greatest_vector) {
  int exponent = 0;
  std::frexp(greatest_vector, &exponent);
  return std::ldexp(1.0F, std::min(exponent, std::numeric_limits<float>::max_exponent - 1));
}

/// The texture coordinates of a part's vertices, two numbers each.
std::vector<float> texcoords_of(const deform::Mesh& mesh, const GltfPart& part) {
  std::vector<float> numbers;
  for (const std::uint32_t texcoord : part.texcoords) {
    const bool is_known = texcoord != deform::no_index;
    const Eigen::Vector2d uv = is_known ? Eigen::Vector2d(mesh.texcoords.col(texcoord))
                                        : Eigen::Vector2d(Eigen::Vector2d::Zero());
    // glTF counts from the top of the picture.
    for (const double number : {uv.x(), 1.0 - uv.y()})
      numbers.push_back(std::isfinite(static_cast<float>(number)) ? static_cast<float>(number)
                                                                  : 0.0F);
  }
  return numbers;
}

/// The colours of a part's vertices, four numbers each; empty if the mesh has none.
std::vector<float> colours_of(const deform::Mesh& mesh, const GltfPart& part) {
  std::vector<float> rgba;
  const auto put = [&](const Eigen::Vector4f& colour) {
    rgba.insert(rgba.end(), colour.begin(), colour.end());
  };
  if (mesh.look.vertex_colours.cols() > 0)
    for (const std::uint32_t vertex : part.vertices)
      put(mesh.look.vertex_colours.col(vertex));
  else if (mesh.look.texcoord_colours.cols() > 0)
    for (const std::uint32_t texcoord : part.texcoords)
      put(texcoord == deform::no_index ? Eigen::Vector4f(Eigen::Vector4f::Ones())
                                       : Eigen::Vector4f(mesh.look.texcoord_colours.col(texcoord)));
  return rgba;
}

Eigen::Matrix3Xf columns_of(const Eigen::Matrix3Xf& of_vertices, const GltfPart& part) {
  Eigen::Matrix3Xf columns(3, static_cast<Index>(part.vertices.size()));
  for (Index at = 0; at < columns.cols(); ++at)
    columns.col(at) = of_vertices.col(part.vertices[static_cast<std::size_t>(at)]);
  return columns;
}

// A vertex whose faces have next to no area has no direction that one could turn.
constexpr double min_area_fraction = 1e-12; ///< as a part of the diagonal's square

using deform::no_index;

/// The corners of all triangles of a material.
using CornersByMaterial = std::map<std::uint32_t, std::vector<std::uint32_t>>;

CornersByMaterial corners_by_material(const deform::Mesh& mesh) {
  CornersByMaterial corners; // no_index is the greatest key
  const auto& of_face = mesh.look.face_materials;
  deform::for_each_face_triangle(mesh, [&](std::size_t face, const deform::Triangle& triangle) {
    auto& of_material = corners[of_face.empty() ? no_index : of_face[face]];
    of_material.insert(of_material.end(), triangle.begin(), triangle.end());
  });
  return corners;
}

/// Makes parts one after another. The lists of its members have an entry for each vertex.
class PartMaker {
public:
  explicit PartMaker(const deform::Mesh& mesh)
      : mesh_(mesh), wanted_(static_cast<std::size_t>(mesh.vertices.cols()), false),
        place_of_(wanted_.size(), no_index) {}

  /// Wants the vertices that no face names, in the next part.
  void add_lone_vertices() {
    wanted_.assign(wanted_.size(), true);
    for (const std::uint32_t vertex : mesh_.face_corners)
      wanted_[vertex] = false;
  }

  GltfPart make(std::uint32_t material, const std::vector<std::uint32_t>& corners) {
    GltfPart part;
    part.material = material;
    for (const std::uint32_t corner : corners)
      wanted_[mesh_.face_corners[corner]] = true;
    for (std::uint32_t vertex = 0; vertex < wanted_.size(); ++vertex) {
      if (!wanted_[vertex]) continue;
      wanted_[vertex] = false;
      place_of_[vertex] = static_cast<std::uint32_t>(part.vertices.size());
      part.vertices.push_back(vertex);
    }
    part.texcoords.resize(part.vertices.size(), no_index);
    add_triangles(corners, part);
    return part;
  }

private:
  void add_triangles(const std::vector<std::uint32_t>& corners, GltfPart& part) const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> copies;
    for (const std::uint32_t corner : corners) {
      const std::uint32_t vertex = mesh_.face_corners[corner];
      std::uint32_t place = place_of_[vertex];
      const std::uint32_t texcoord =
          mesh_.corner_texcoords.empty() ? no_index : mesh_.corner_texcoords[corner];
      if (part.texcoords[place] == no_index) part.texcoords[place] = texcoord;
      if (part.texcoords[place] != texcoord) {
        const auto next = static_cast<std::uint32_t>(part.vertices.size());
        const auto [copy, is_new] = copies.emplace(std::pair(vertex, texcoord), next);
        place = copy->second;
        if (is_new) {
          part.vertices.push_back(vertex);
          part.texcoords.push_back(texcoord);
        }
      }
      part.triangles.push_back(place);
    }
  }

  const deform::Mesh& mesh_;
  std::vector<bool> wanted_;
  std::vector<std::uint32_t> place_of_; ///< in the part, of its vertices
};

} // namespace

std::vector<GltfPart> parts_of(const deform::Mesh& mesh) {
  CornersByMaterial corners = corners_by_material(mesh);
  if (corners.empty()) corners[no_index];
  PartMaker maker(mesh);
  maker.add_lone_vertices();
  std::vector<GltfPart> parts;
  for (const auto& [material, of_material] : corners)
    parts.push_back(maker.make(material, of_material));
  return parts;
}

MorphNormals::MorphNormals(const deform::Mesh& mesh) {
  const double diagonal = deform::diagonal_of(mesh.vertices);
  if (diagonal > 0.0) unit_ = diagonal;
  shape_.vertices = mesh.vertices;
  shape_.face_starts = mesh.face_starts;
  shape_.face_corners = mesh.face_corners;
  rest_areas_ = deform::vertex_areas(shape_, shape_.vertices, unit_);
  lengths_ = rest_areas_.colwise().norm();
  for (double& length : lengths_)
    if (length < min_area_fraction) length = 0.0;
}

/// The areas at rest plus so many times the displacement.
deform::Points MorphNormals::areas(double way_factor, const Eigen::Matrix3Xf& way) const {
  return deform::vertex_areas(shape_, shape_.vertices + way_factor * way.cast<double>(), unit_);
}

Eigen::Matrix3Xf MorphNormals::rest() const {
  Eigen::Matrix3Xf normals(3, rest_areas_.cols());
  for (Index vertex = 0; vertex < normals.cols(); ++vertex)
    normals.col(vertex) =
        lengths_[vertex] > 0.0
            ? Eigen::Vector3f((rest_areas_.col(vertex) / lengths_[vertex]).cast<float>())
            : Eigen::Vector3f(Eigen::Vector3f::UnitY()); // any will do
  return normals;
}

Eigen::Matrix3Xf MorphNormals::divided(const deform::Points& turn) const {
  Eigen::Matrix3Xf turns = Eigen::Matrix3Xf::Zero(3, turn.cols());
  for (Index vertex = 0; vertex < turns.cols(); ++vertex)
    if (lengths_[vertex] > 0.0)
      turns.col(vertex) = (turn.col(vertex) / lengths_[vertex]).cast<float>();
  return turns;
}

Eigen::Matrix3Xf MorphNormals::turn_to(const Eigen::Matrix3Xf& way) const {
  return divided(areas(1.0, way) - rest_areas_);
}

Eigen::Matrix3Xf MorphNormals::turn_along(const Eigen::Matrix3Xf& way) const {
  // A polynomial of degree two has its derivative as the central difference, whatever the step.
  return divided((areas(1.0, way) - areas(-1.0, way)) / 2.0);
}

GltfModel::GltfModel(const deform::Mesh& mesh, GlbFile& file)
    : parts_(parts_of(mesh)), normals_(mesh) {
  const Eigen::Matrix3Xf vertices = mesh.vertices.cast<float>();
  const Eigen::Matrix3Xf normals = normals_.rest();
  for (const GltfPart& part : parts_) {
    Json attributes;
    attributes["POSITION"] = file.add_vectors(columns_of(vertices, part), Use::vertices, true);
    if (deform::has_texture_places(mesh))
      attributes["TEXCOORD_0"] = file.add_numbers(texcoords_of(mesh, part), 2, Use::vertices);
    if (const std::vector<float> colours = colours_of(mesh, part); !colours.empty())
      attributes["COLOR_0"] = file.add_numbers(colours, 4, Use::vertices);
    if (part.triangles.empty()) {
      primitives_.push_back({{"attributes", attributes}, {"mode", points_mode}});
      continue;
    }
    attributes["NORMAL"] = file.add_vectors(columns_of(normals, part), Use::vertices, false);
    primitives_.push_back(
        {{"attributes", attributes}, {"indices", file.add_indices(part.triangles, Use::indices)}});
  }
  targets_.resize(parts_.size(), Json::array());
  node_ = file.add("nodes", Json::object()); // its place; add_to() fills it
}

void GltfModel::add_target(const Eigen::Matrix3Xf& way, const Eigen::Matrix3Xf& turn,
                           std::string name, GlbFile& file) {
  for (std::size_t at = 0; at < parts_.size(); ++at) {
    Json target{{"POSITION", file.add_sparse_vectors(columns_of(way, parts_[at]))}};
    if (!parts_[at].triangles.empty())
      target["NORMAL"] = file.add_sparse_vectors(columns_of(turn, parts_[at]));
    targets_[at].push_back(std::move(target));
  }
  names_.push_back(std::move(name));
}

std::vector<float> GltfModel::add_control_targets(const ControlMorphs& morphs, GlbFile& file) {
  const Eigen::MatrixXf& influences = morphs.influences();
  const std::vector<float> vectors = morphs.vectors();
  const auto width = static_cast<std::size_t>(3 * influences.rows());
  const float scale = scale_for(morphs.greatest_vector());
  struct Used {
    std::size_t coordinate; ///< index in a moment's vectors
    float sign;
  };
  std::vector<Used> used;
  for (std::size_t coordinate = 0; coordinate < width; ++coordinate)
    for (const float sign : {1.0F, -1.0F}) {
      const auto influence = influences.row(static_cast<Index>(coordinate / 3));
      bool is_used = false;
      for (std::size_t at = coordinate; at < vectors.size() && !is_used; at += width)
        is_used = sign * vectors[at] > 0.0F;
      if (!is_used || influence.isZero(0.0F)) continue;
      used.push_back({coordinate, sign});
      Eigen::Matrix3Xf way = Eigen::Matrix3Xf::Zero(3, influences.cols());
      way.row(static_cast<Index>(coordinate % 3)) = sign * scale * influence;
      add_target(way, normals_.turn_along(way),
                 "control " + std::to_string(coordinate / 3 + 1) + (sign > 0.0F ? " +" : " -") +
                     "xyz"[coordinate % 3],
                 file);
    }
  std::vector<float> weights;
  for (std::size_t moment = 0; !used.empty() && moment < vectors.size(); moment += width)
    for (const auto& [coordinate, sign] : used)
      weights.push_back(std::max(0.0F, sign * vectors[moment + coordinate] / scale));
  return weights;
}

void GltfModel::add_function_targets(const FunctionMorphs& morphs, GlbFile& file) {
  for (const FunctionMorphs::Target& target : morphs.targets()) {
    add_target(target.way, normals_.turn_to(target.way), target.name, file);
    target_values_.push_back(target.value);
  }
}

void GltfModel::add_key_target(const Eigen::Matrix3Xf& way, GlbFile& file) {
  if (way.isZero(0.0F)) {
    key_targets_.emplace_back(std::nullopt);
    return;
  }
  if (target_count() == 0 || way != latest_) {
    add_target(way, normals_.turn_to(way), "key " + std::to_string(target_count() + 1), file);
    latest_ = way;
  }
  key_targets_.emplace_back(static_cast<std::uint32_t>(target_count() - 1));
}

GlbFile::Index GltfModel::add_key_weights(GlbFile& file) const {
  assert(key_weight_count() <= std::numeric_limits<std::uint32_t>::max());
  std::vector<std::uint32_t> ones;
  for (std::size_t key = 0; key < key_targets_.size(); ++key)
    if (key_targets_[key])
      ones.push_back(static_cast<std::uint32_t>(key * target_count()) + *key_targets_[key]);
  return file.add_ones(key_weight_count(), ones);
}

void GltfModel::add_to(GlbFile& file, const GltfMaterials& materials, double units_per_metre,
                       const MorphReport& report) const {
  Json mesh{{"name", "model"}};
  if (target_count() > 0) mesh["weights"] = std::vector<float>(target_count(), 0.0F);
  mesh["extras"] = {{"targetNames", names_},
                    {"morphs", name_of(report.basis)},
                    {"greatestError", report.greatest_error}};
  if (!target_values_.empty()) mesh["extras"]["targetValues"] = target_values_;
  mesh["primitives"] = Json::array();
  for (std::size_t at = 0; at < parts_.size(); ++at) {
    Json primitive = primitives_[at];
    primitive["material"] = materials.index_of(parts_[at].material);
    if (target_count() > 0) primitive["targets"] = targets_[at];
    mesh["primitives"].push_back(std::move(primitive));
  }
  const double scale = 1.0 / units_per_metre;
  file["nodes"][node_] = {{"name", "model"},
                          {"mesh", file.add("meshes", std::move(mesh))},
                          {"scale", {scale, scale, scale}}};
}

} // namespace nendo::exporting
