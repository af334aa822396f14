#include "export/gltf_model.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <nendo/deform/triangles.hpp>

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
  primitive_["attributes"]["POSITION"] =
      file.add_vectors(mesh.vertices.cast<float>(), Use::vertices, true);
  const auto triangles = deform::corners_of_triangles(mesh);
  if (triangles.empty()) {
    primitive_["mode"] = points_mode;
  } else {
    primitive_["attributes"]["NORMAL"] = file.add_vectors(unit_normals(mesh), Use::vertices, false);
    primitive_["indices"] = file.add_indices(triangles, Use::indices);
  }
  node_ = file.add("nodes", Json::object()); // its place; add_to() fills it
}

void GltfModel::add_target(const Eigen::Matrix3Xf& way, std::string name, GlbFile& file) {
  targets_.push_back({{"POSITION", file.add_sparse_vectors(way)}});
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

GlbFile::Index GltfModel::add_material(GlbFile& file) {
  return file.add("materials", {{"name", "clay"},
                                {"doubleSided", true},
                                {"pbrMetallicRoughness",
                                 {{"baseColorFactor", {0.72, 0.56, 0.44, 1.0}},
                                  {"metallicFactor", 0.0},
                                  {"roughnessFactor", 0.8}}}});
}

void GltfModel::add_to(GlbFile& file, GlbFile::Index material, double units_per_metre,
                       const MorphReport& report) const {
  Json primitive = primitive_;
  primitive["material"] = material;
  Json mesh{{"name", "model"}};
  if (target_count() > 0) {
    primitive["targets"] = targets_;
    mesh["weights"] = std::vector<float>(target_count(), 0.0F);
  }
  mesh["extras"] = {{"targetNames", names_},
                    {"morphs", name_of(report.basis)},
                    {"greatestError", report.greatest_error}};
  if (!target_values_.empty()) mesh["extras"]["targetValues"] = target_values_;
  mesh["primitives"] = Json::array({std::move(primitive)});
  const double scale = 1.0 / units_per_metre;
  file["nodes"][node_] = {{"name", "model"},
                          {"mesh", file.add("meshes", std::move(mesh))},
                          {"scale", {scale, scale, scale}}};
}

} // namespace nendo::exporting
