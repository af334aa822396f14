#include "export/gltf_parts.hpp"

#include <map>
#include <utility>

#include <nendo/deform/triangles.hpp>

namespace nendo::exporting {
namespace {

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

} // namespace nendo::exporting
