#include "parts/append_mesh.hpp"

#include <limits>
#include <span>

#include "mesh/columns.hpp"

namespace nendo::deform {
namespace {

void append_indices(std::span<const std::uint32_t> more, std::uint32_t first,
                    std::vector<std::uint32_t>& to) {
  for (const std::uint32_t number : more)
    to.push_back(number == no_index ? no_index : number + first);
}

} // namespace

void append_mesh(const Mesh& more, Mesh& mesh) {
  const auto vertices = to_index(mesh.vertex_count());
  const auto texcoords = static_cast<std::uint32_t>(mesh.texcoords.cols());
  const auto corners = to_index(mesh.face_corners.size());
  append_columns(more.vertices, mesh.vertices);
  append_columns(more.texcoords, mesh.texcoords);
  append_columns(more.look.texcoord_colours, mesh.look.texcoord_colours);
  append_columns(more.look.vertex_colours, mesh.look.vertex_colours);
  append_indices(more.face_corners, vertices, mesh.face_corners);
  append_indices(more.corner_texcoords, texcoords, mesh.corner_texcoords);
  append_indices(std::span(more.face_starts).subspan(1), corners, mesh.face_starts);
  for (std::size_t k = 0; k < 3; ++k)
    append_indices(*face_columns(more.look)[k], 0, *face_columns(mesh.look)[k]);
  mesh.detail.clear(); // what is new has none
}

bool fit_together(const Mesh& a, const Mesh& b) noexcept {
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max() / 2;
  return a.face_corners.size() + b.face_corners.size() <= most &&
         static_cast<std::size_t>(a.vertices.cols() + b.vertices.cols()) <= most &&
         static_cast<std::size_t>(a.texcoords.cols() + b.texcoords.cols()) <= most;
}

} // namespace nendo::deform
