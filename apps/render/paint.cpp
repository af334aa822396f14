#include "render/paint.hpp"

#include <algorithm>

namespace nendo::render {

using Eigen::Vector3f;

namespace {

// Warm, while the hands are cool, so that one is told from the other at a glance, also without
// seeing red from green.
const Vector3f clay(0.50F, 0.235F, 0.135F);

constexpr float least_opacity = 0.5F;

bool is_drawn(const deform::Material& material) {
  return material.drawn && (!material.colour || (*material.colour)[3] >= least_opacity);
}

Vector3f colour_of(const deform::Material* material, bool has_more) {
  if (material != nullptr && material->colour) return material->colour->head<3>();
  return has_more ? Vector3f(Vector3f::Ones()) : clay; // white is coloured by what is on it
}

/// Faces by their material's number plus one, and 0 without one, in order.
std::vector<std::vector<std::uint32_t>> faces_by_material(const deform::Mesh& mesh, bool all) {
  const deform::Appearance& look = mesh.look;
  std::vector<std::vector<std::uint32_t>> faces(look.materials.size() + 1);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const deform::Material* const material = look.material_of(face);
    if (!all && material != nullptr && !is_drawn(*material)) continue;
    const std::size_t at = material == nullptr ? 0 : look.face_materials[face] + std::size_t{1};
    faces[at].push_back(static_cast<std::uint32_t>(face));
  }
  return faces;
}

} // namespace

Paint::Paint(const deform::Mesh& mesh, std::vector<std::uint32_t>& corners) {
  const deform::Appearance& look = mesh.look;
  const auto& colours = look.vertex_colours;
  if (colours.cols() == mesh.vertices.cols())
    for (Eigen::Index vertex = 0; vertex < colours.cols(); ++vertex)
      vertex_colours_.emplace_back(colours.col(vertex).head<3>());
  auto faces = faces_by_material(mesh, false);
  const auto is_empty = [](const auto& some) { return some.empty(); };
  if (std::all_of(faces.begin(), faces.end(), is_empty)) faces = faces_by_material(mesh, true);
  corners.clear();
  for (std::size_t at = 0; at < faces.size(); ++at) {
    Coat coat{corners.size() / 3, 0,
              colour_of(at == 0 ? nullptr : &look.materials[at - 1], !vertex_colours_.empty())};
    for (const std::uint32_t face : faces[at]) {
      const std::uint32_t begin = mesh.face_starts[face];
      for (std::uint32_t corner = begin + 2; corner < mesh.face_starts[face + 1]; ++corner)
        for (const std::uint32_t of : {begin, corner - 1, corner})
          corners.push_back(mesh.face_corners[of]);
    }
    coat.count = corners.size() / 3 - coat.first;
    if (coat.count == 0) continue;
    coat_of_.insert(coat_of_.end(), coat.count, static_cast<std::uint32_t>(coats_.size()));
    coats_.push_back(coat);
  }
}

Vector3f Paint::colour_at(std::size_t triangle, const std::array<std::uint32_t, 3>& vertices,
                          const std::array<float, 3>& shares) const noexcept {
  const Vector3f& base = coats_[coat_of_[triangle]].colour;
  if (vertex_colours_.empty()) return base;
  Vector3f mixed = Vector3f::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    mixed += shares[k] * vertex_colours_[vertices[k]];
  return base.cwiseProduct(mixed);
}

} // namespace nendo::render
