// Makes the parts of a model meshes of their own.

#include <nendo/deform/cut.hpp>

#include "cut/cut_assembly.hpp"
#include "geometry/rows_by_key.hpp"
#include "mesh/columns.hpp"
#include "mesh/used_entries.hpp"

namespace nendo::deform {
namespace {

/// Vertices or faces of all parts, part after part.
template <class PartOf>
RowsByKey<std::uint32_t> by_part(std::size_t count, std::uint32_t parts, const PartOf& part_of) {
  return rows_by_key<std::uint32_t>(parts, [&](const auto& visit) {
    for (std::uint32_t at = 0; at < count; ++at)
      if (part_of(at) != no_index) visit(part_of(at), at);
  });
}

void copy_face(const Mesh& from, std::uint32_t face, FirstUses& vertices, FirstUses& texcoords,
               Mesh& to) {
  for (std::uint32_t at = from.face_starts[face]; at < from.face_starts[face + 1]; ++at) {
    to.face_corners.push_back(vertices(from.face_corners[at]));
    if (!from.corner_texcoords.empty())
      to.corner_texcoords.push_back(texcoords(from.corner_texcoords[at]));
  }
  end_face(from, face, to);
}

} // namespace

std::vector<Mesh> separated(const Mesh& mesh, const std::vector<std::uint32_t>& part_of_vertex,
                            std::uint32_t count) {
  const auto part_of = [&](std::uint32_t vertex) { return part_of_vertex[vertex]; };
  const auto vertices = by_part(mesh.vertex_count(), count, part_of);
  const auto faces = by_part(mesh.face_count(), count,
                             [&](std::uint32_t face) { return part_of(mesh.corners_of(face)[0]); });
  FirstUses vertex(mesh.vertex_count());
  FirstUses texcoord(static_cast<std::size_t>(mesh.texcoords.cols()));
  std::vector<Mesh> parts(count);
  for (std::uint32_t part = 0; part < count; ++part) {
    Mesh& own = parts[part];
    vertex.clear();
    texcoord.clear();
    for (const std::uint32_t old : vertices[part])
      vertex(old);
    for (const std::uint32_t face : faces[part])
      copy_face(mesh, face, vertex, texcoord, own);
    own.vertices = columns_at(mesh.vertices, vertex.entries());
    own.offset = mesh.offset;
    own.texcoords = columns_at(mesh.texcoords, texcoord.entries());
    own.look.texcoord_colours = columns_at(mesh.look.texcoord_colours, texcoord.entries());
    own.look.vertex_colours = columns_at(mesh.look.vertex_colours, vertex.entries());
    own.look.materials = mesh.look.materials;
    own.look.textures = mesh.look.textures;
    own.look.groups.names = mesh.look.groups.names;
    own.look.objects.names = mesh.look.objects.names;
  }
  return parts;
}

std::vector<Mesh> separate(const CutModel& model) {
  return separated(model.mesh, model.part_of_vertex, model.parts);
}

std::vector<Mesh> separate(const Mesh& mesh) {
  std::vector<std::uint32_t> part_of_vertex;
  const std::uint32_t count = number_parts(mesh, part_of_vertex);
  return separated(mesh, part_of_vertex, count);
}

} // namespace nendo::deform
