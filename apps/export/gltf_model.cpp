#include "export/gltf_model.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

namespace nendo::exporting {

using Eigen::Index;
using Json = GlbFile::Json;
using Use = GlbFile::Use;

namespace {

constexpr int points_mode = 0; // glTF's: no triangles

Eigen::Matrix3Xf unit_normals(const deform::Mesh& mesh) {
  Eigen::Matrix3Xf normals = deform::vertex_normals(mesh).cast<float>();
  for (Index v = 0; v < normals.cols(); ++v) {
    const float length = normals.col(v).norm();
    if (length > 0.0F)
      normals.col(v) /= length;
    else
      normals.col(v) = Eigen::Vector3f::UnitY(); // no face: any will do
  }
  return normals;
}

/// At least as large as the vectors' coordinates, and a power of two, so that a target, a weight
/// and their product lose nothing that the influence and the vector have not lost.
float scale_for(float greatest_vector) {
  int exponent = 0;
  std::frexp(greatest_vector, &exponent);
  return std::ldexp(1.0F, std::min(exponent, std::numeric_limits<float>::max_exponent - 1));
}

} // namespace

GltfModel::GltfModel(const deform::Mesh& mesh, GlbFile& file) {
  std::vector<float> texcoords;
  const std::vector<std::uint32_t> corner_vertices = split_at_seams(mesh, texcoords);
  Json attributes;
  attributes["POSITION"] =
      file.add_vectors(with_copies(mesh.vertices.cast<float>()), Use::vertices, true);
  if (!texcoords.empty()) attributes["TEXCOORD_0"] = file.add_texcoords(texcoords);
  const Eigen::Matrix4Xf& colours = mesh.look.vertex_colours;
  if (colours.cols() > 0) {
    std::vector<float> rgba(colours.data(), colours.data() + colours.size());
    for (const std::uint32_t vertex : copies_)
      for (const float channel : colours.col(vertex))
        rgba.push_back(channel);
    attributes["COLOR_0"] = file.add_colours(rgba);
  }
  add_primitives(mesh, corner_vertices, attributes, file);
  node_ = file.add("nodes", Json::object()); // its place; add_to() fills it
}

/// Of each corner the vertex, among the mesh's and their copies. `texcoords` gets two numbers for
/// each vertex, or stays empty if there are none.
std::vector<std::uint32_t> GltfModel::split_at_seams(const deform::Mesh& mesh,
                                                     std::vector<float>& texcoords) {
  if (mesh.corner_texcoords.empty()) return mesh.face_corners;
  const auto count = static_cast<std::size_t>(mesh.vertices.cols());
  std::vector<std::uint32_t> texcoord_of(count, deform::no_index);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> copies;
  std::vector<std::uint32_t> corner_vertices = mesh.face_corners;
  for (std::size_t at = 0; at < corner_vertices.size(); ++at) {
    std::uint32_t& vertex = corner_vertices[at];
    const std::uint32_t texcoord = mesh.corner_texcoords[at];
    if (texcoord_of[vertex] == deform::no_index) texcoord_of[vertex] = texcoord;
    if (texcoord_of[vertex] == texcoord) continue;
    const auto next = static_cast<std::uint32_t>(count + copies_.size());
    const auto [copy, is_new] = copies.emplace(std::pair(vertex, texcoord), next);
    if (is_new) {
      copies_.push_back(vertex);
      texcoord_of.push_back(texcoord);
    }
    vertex = copy->second;
  }
  for (const std::uint32_t texcoord : texcoord_of) {
    const bool is_known = texcoord != deform::no_index;
    const Eigen::Vector2d uv = is_known ? Eigen::Vector2d(mesh.texcoords.col(texcoord))
                                        : Eigen::Vector2d(Eigen::Vector2d::Zero());
    // glTF counts from the top of the picture.
    for (const double number : {uv.x(), 1.0 - uv.y()})
      texcoords.push_back(std::isfinite(static_cast<float>(number)) ? static_cast<float>(number)
                                                                    : 0.0F);
  }
  return corner_vertices;
}

Eigen::Matrix3Xf GltfModel::with_copies(const Eigen::Matrix3Xf& of_vertices) const {
  if (copies_.empty()) return of_vertices;
  Eigen::Matrix3Xf all(3, of_vertices.cols() + static_cast<Index>(copies_.size()));
  all.leftCols(of_vertices.cols()) = of_vertices;
  for (std::size_t at = 0; at < copies_.size(); ++at)
    all.col(of_vertices.cols() + static_cast<Index>(at)) = of_vertices.col(copies_[at]);
  return all;
}

/// One for each material, in the order of the look; faces without a material come last.
void GltfModel::add_primitives(const deform::Mesh& mesh,
                               const std::vector<std::uint32_t>& corner_vertices,
                               const Json& attributes, GlbFile& file) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> triangles; // no_index is the greatest
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t begin = mesh.face_starts[face];
    const auto& of_face = mesh.look.face_materials;
    std::vector<std::uint32_t>& corners =
        triangles[of_face.empty() ? deform::no_index : of_face[face]];
    for (std::uint32_t at = begin + 2; at < mesh.face_starts[face + 1]; ++at)
      for (const std::uint32_t corner : {begin, at - 1, at})
        corners.push_back(corner_vertices[corner]);
  }
  std::erase_if(triangles, [](const auto& some) { return some.second.empty(); });
  if (triangles.empty()) {
    primitives_.push_back({deform::no_index, {{"attributes", attributes}, {"mode", points_mode}}});
    return;
  }
  Json with_normals = attributes;
  with_normals["NORMAL"] = file.add_vectors(with_copies(unit_normals(mesh)), Use::vertices, false);
  for (const auto& [material, corners] : triangles)
    primitives_.push_back(
        {material,
         {{"attributes", with_normals}, {"indices", file.add_indices(corners, Use::indices)}}});
}

void GltfModel::add_target(const Eigen::Matrix3Xf& way, std::string name, GlbFile& file) {
  targets_.push_back({{"POSITION", file.add_sparse_vectors(with_copies(way))}});
  names_.push_back(std::move(name));
}

std::vector<float> GltfModel::add_control_targets(const ControlMorphs& morphs, GlbFile& file) {
  const Eigen::MatrixXf& influences = morphs.influences();
  const std::vector<float> vectors = morphs.vectors();
  const auto width = static_cast<std::size_t>(3 * influences.rows());
  const float scale = scale_for(morphs.greatest_vector());
  struct Used {
    std::size_t coordinate; ///< of a moment's vectors
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
      add_target(way,
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
    add_target(target.way, target.name, file);
    target_values_.push_back(target.value);
  }
}

void GltfModel::add_key_target(const Eigen::Matrix3Xf& way, GlbFile& file) {
  if (way.isZero(0.0F)) {
    key_targets_.emplace_back(std::nullopt);
    return;
  }
  if (target_count() == 0 || way != latest_) {
    add_target(way, "key " + std::to_string(target_count() + 1), file);
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
  for (const Primitive& part : primitives_) {
    Json primitive = part.json;
    primitive["material"] = materials.index_of(part.material);
    if (target_count() > 0) primitive["targets"] = targets_;
    mesh["primitives"].push_back(std::move(primitive));
  }
  const double scale = 1.0 / units_per_metre;
  file["nodes"][node_] = {{"name", "model"},
                          {"mesh", file.add("meshes", std::move(mesh))},
                          {"scale", {scale, scale, scale}}};
}

} // namespace nendo::exporting
