#include <nendo/deform/drawn_faces.hpp>

#include <algorithm>

namespace nendo::deform {
namespace {

constexpr float min_opacity = 0.5F;

std::vector<std::vector<std::uint32_t>> faces_by_material(const Mesh& mesh, bool all) {
  const Appearance& look = mesh.look;
  std::vector<std::vector<std::uint32_t>> faces(look.materials.size() + 1);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const Material* const material = look.material_of(face);
    if (!all && material != nullptr && !is_drawn(*material)) continue;
    const std::size_t at = material == nullptr ? 0 : look.face_materials[face] + std::size_t{1};
    faces[at].push_back(static_cast<std::uint32_t>(face));
  }
  return faces;
}

} // namespace

bool is_drawn(const Material& material) noexcept {
  return material.drawn && (!material.colour || (*material.colour)[3] >= min_opacity);
}

std::vector<std::vector<std::uint32_t>> drawn_faces(const Mesh& mesh) {
  auto faces = faces_by_material(mesh, false);
  const auto is_empty = [](const auto& some) { return some.empty(); };
  if (std::all_of(faces.begin(), faces.end(), is_empty)) return faces_by_material(mesh, true);
  return faces;
}

} // namespace nendo::deform
