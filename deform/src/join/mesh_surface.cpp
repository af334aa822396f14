#include "join/mesh_surface.hpp"

#include <algorithm>

#include <nendo/deform/corner_colours.hpp>
#include <nendo/deform/triangles.hpp>

#include "mesh/columns.hpp"
#include "mesh/used_entries.hpp"

namespace nendo::deform {
namespace {

bool same_texture(const Texture& a, const Texture& b) {
  if (a.file != b.file) return false;
  return a.contents == b.contents || (a.contents && b.contents && *a.contents == *b.contents);
}

void add_faces(const Mesh& mesh, const LookCollector& looks, TriangleSurface& surface) {
  for_each_face_triangle(mesh, [&](std::size_t face, const Triangle& corners) {
    const auto through = [&](const std::vector<std::uint32_t>& list) {
      return Corners{list[corners[0]], list[corners[1]], list[corners[2]]};
    };
    surface.faces.push_back(through(mesh.face_corners));
    surface.looks.push_back(looks.look_of(mesh.look, face));
    if (!mesh.corner_texcoords.empty())
      surface.face_texture.push_back(through(mesh.corner_texcoords));
  });
}

TriangleSurface surface_of(const Mesh& mesh, const LookCollector& looks, bool has_colours,
                           bool has_texture) {
  TriangleSurface surface;
  surface.points = space_points(mesh.vertices);
  for (Eigen::Index i = 0; i < mesh.look.vertex_colours.cols(); ++i) {
    const Eigen::Vector4f colour = mesh.look.vertex_colours.col(i);
    surface.colours.push_back({colour[0], colour[1], colour[2], colour[3]});
  }
  for (std::size_t at = 0; at < static_cast<std::size_t>(mesh.texcoords.cols()); ++at)
    surface.texture_points.push_back(texture_point_of(mesh, at));
  add_faces(mesh, looks, surface);
  if (has_colours && surface.colours.empty())
    surface.colours.assign(surface.points.size(), {1.0f, 1.0f, 1.0f, 1.0f});
  if (has_texture && surface.face_texture.empty()) {
    surface.texture_points.assign(1, white_texture_point);
    surface.face_texture.assign(surface.faces.size(), {0, 0, 0});
  }
  return surface;
}

void set_materials(const TriangleSurface& surface, const Appearance& look, Appearance& to) {
  UsedEntries materials(look.materials.size());
  UsedEntries textures(look.textures.size());
  for (const FaceLook& face : surface.looks)
    materials.use(face.material);
  materials.number([&](std::uint32_t entry) {
    to.materials.push_back(look.materials[entry]);
    textures.use(look.materials[entry].texture);
  });
  textures.number([&](std::uint32_t entry) { to.textures.push_back(look.textures[entry]); });
  for (Material& material : to.materials)
    material.texture = textures[material.texture];
  if (to.materials.empty()) return;
  for (const FaceLook& face : surface.looks)
    to.face_materials.push_back(materials[face.material]);
}

void set_names(const TriangleSurface& surface, const FaceNames& from,
               std::uint32_t FaceLook::* entry, FaceNames& to) {
  UsedEntries used(from.names.size());
  for (const FaceLook& face : surface.looks)
    used.use(face.*entry);
  used.number([&](std::uint32_t at) { to.names.push_back(from.names[at]); });
  if (to.names.empty()) return;
  for (const FaceLook& face : surface.looks)
    to.of_face.push_back(used[face.*entry]);
}

void set_texture(const TriangleSurface& surface, Mesh& mesh) {
  UsedEntries used(surface.texture_points.size());
  for (const Corners& corners : surface.face_texture)
    for (const std::uint32_t at : corners)
      used.use(at);
  std::vector<TexturePoint> kept;
  used.number([&](std::uint32_t at) { kept.push_back(surface.texture_points[at]); });
  set_texture_points(kept, mesh);
  for (const Corners& corners : surface.face_texture)
    for (const std::uint32_t at : corners)
      mesh.corner_texcoords.push_back(used[at]);
}

} // namespace

SharedSurfaces surfaces_of(std::span<const Mesh* const> meshes) {
  SharedSurfaces shared;
  LookCollector looks(shared.look);
  const auto any = [&](auto has) {
    return std::any_of(meshes.begin(), meshes.end(), [&](const Mesh* mesh) { return has(*mesh); });
  };
  const bool has_colours =
      any([](const Mesh& mesh) { return mesh.look.vertex_colours.cols() > 0; });
  const bool has_corner_colours =
      any([](const Mesh& mesh) { return mesh.look.texcoord_colours.cols() > 0; });
  const bool has_texture = any([](const Mesh& mesh) { return !mesh.corner_texcoords.empty(); });
  for (const Mesh* mesh : meshes) {
    looks.take(mesh->look);
    if (has_corner_colours && mesh->look.vertex_colours.cols() > 0) {
      Mesh alike = *mesh;
      move_colours_to_corners(alike);
      shared.surfaces.push_back(surface_of(alike, looks, false, true));
    } else {
      shared.surfaces.push_back(
          surface_of(*mesh, looks, has_colours && !has_corner_colours, has_texture));
    }
  }
  return shared;
}

std::pair<TriangleSurface, Appearance> single_surface_of(const Mesh& mesh) {
  const Mesh* const one = &mesh;
  SharedSurfaces shared = surfaces_of({&one, 1});
  shared.surfaces[0].detail = mesh.detail;
  return {std::move(shared.surfaces[0]), std::move(shared.look)};
}

Mesh mesh_of(const TriangleSurface& surface, const Appearance& look) {
  Mesh mesh;
  mesh.vertices = points_of(surface.points);
  mesh.face_corners.reserve(3 * surface.faces.size());
  mesh.face_starts.reserve(surface.faces.size() + 1);
  for (const Corners& corners : surface.faces) {
    mesh.face_corners.insert(mesh.face_corners.end(), corners.begin(), corners.end());
    mesh.face_starts.push_back(to_index(mesh.face_corners.size()));
  }
  set_materials(surface, look, mesh.look);
  set_names(surface, look.groups, &FaceLook::group, mesh.look.groups);
  set_names(surface, look.objects, &FaceLook::object, mesh.look.objects);
  if (!surface.face_texture.empty()) set_texture(surface, mesh);
  mesh.detail = surface.detail;
  mesh.look.vertex_colours.resize(4, static_cast<Eigen::Index>(surface.colours.size()));
  for (std::size_t i = 0; i < surface.colours.size(); ++i)
    mesh.look.vertex_colours.col(static_cast<Eigen::Index>(i)) << surface.colours[i][0],
        surface.colours[i][1], surface.colours[i][2], surface.colours[i][3];
  return mesh;
}

void LookCollector::take(const Appearance& from) {
  textures_.clear();
  materials_.clear();
  for (const Texture& texture : from.textures)
    textures_.push_back(number_of(texture));
  for (const Material& material : from.materials)
    materials_.push_back(number_of(material));
  groups_ = numbers_of(from.groups, look_.groups);
  objects_ = numbers_of(from.objects, look_.objects);
}

FaceLook LookCollector::look_of(const Appearance& from, std::size_t face) const {
  const auto entry = [&](const std::vector<std::uint32_t>& of_face,
                         const std::vector<std::uint32_t>& numbers) {
    return of_face.empty() || of_face[face] == no_index ? no_index : numbers[of_face[face]];
  };
  return {entry(from.face_materials, materials_), entry(from.groups.of_face, groups_),
          entry(from.objects.of_face, objects_)};
}

std::uint32_t LookCollector::number_of(const Texture& texture) {
  const auto found =
      std::find_if(look_.textures.begin(), look_.textures.end(),
                   [&](const Texture& other) { return same_texture(texture, other); });
  const auto number = static_cast<std::uint32_t>(found - look_.textures.begin());
  if (found == look_.textures.end()) look_.textures.push_back(texture);
  return number;
}

std::uint32_t LookCollector::number_of(Material material) {
  if (material.texture != no_index) material.texture = textures_[material.texture];
  const std::string name = material.name;
  for (int copy = 2;; ++copy) {
    const auto found =
        std::find_if(look_.materials.begin(), look_.materials.end(),
                     [&](const Material& other) { return other.name == material.name; });
    const auto number = static_cast<std::uint32_t>(found - look_.materials.begin());
    if (found == look_.materials.end()) {
      look_.materials.push_back(std::move(material));
      return number;
    }
    if (found->colour == material.colour && found->texture == material.texture &&
        found->drawn == material.drawn)
      return number;
    material.name = name + "-" + std::to_string(copy);
  }
}

std::vector<std::uint32_t> LookCollector::numbers_of(const FaceNames& from, FaceNames& to) {
  std::vector<std::uint32_t> numbers;
  for (const std::string& name : from.names) {
    const auto found = std::find(to.names.begin(), to.names.end(), name);
    numbers.push_back(static_cast<std::uint32_t>(found - to.names.begin()));
    if (found == to.names.end()) to.names.push_back(name);
  }
  return numbers;
}

} // namespace nendo::deform
