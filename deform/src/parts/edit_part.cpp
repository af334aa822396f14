#include <nendo/deform/edit_part.hpp>

#include <algorithm>
#include <limits>
#include <span>

#include "cut/cut_assembly.hpp"
#include "mesh/columns.hpp"
#include "parts/append_mesh.hpp"

namespace nendo::deform {
namespace {

constexpr double widths_aside = 1.05;

Result<std::vector<std::uint32_t>> parts_with(const Mesh& mesh, std::uint32_t part,
                                              std::uint32_t& count) {
  std::vector<std::uint32_t> part_of_vertex;
  count = number_parts(mesh, part_of_vertex);
  if (part >= count) return Error{Errc::bad_input, "has no such part"};
  return part_of_vertex;
}

template <class Columns>
void append_columns(const Columns& more, Columns& to) {
  const Eigen::Index before = to.cols();
  to.conservativeResize(to.rows(), before + more.cols());
  to.rightCols(more.cols()) = more;
}

void append_numbers(std::span<const std::uint32_t> more, std::uint32_t first,
                    std::vector<std::uint32_t>& to) {
  for (const std::uint32_t number : more)
    to.push_back(number == no_index ? no_index : number + first);
}

} // namespace

Result<Mesh> copied_part(const Mesh& mesh, std::uint32_t part) {
  std::uint32_t count = 0;
  auto labels = parts_with(mesh, part, count);
  if (!labels) return labels.error();
  for (std::uint32_t& label : *labels)
    label = label == part ? 0 : no_index;
  Mesh copy = std::move(separated(mesh, *labels, 1).front());
  if (!fit_together(mesh, copy)) return Error{Errc::bad_input, "is too large for one more part"};
  const Box box = finite_box_of(copy.vertices);
  const double aside = widths_aside * std::max(0.0, box.highest.x() - box.lowest.x());
  copy.vertices.row(0).array() += aside;
  Mesh both = mesh;
  append_mesh(copy, both);
  return both;
}

Result<Mesh> removed_part(const Mesh& mesh, std::uint32_t part) {
  std::uint32_t count = 0;
  auto labels = parts_with(mesh, part, count);
  if (!labels) return labels.error();
  if (count < 2) return Error{Errc::bad_input, "is one part, and nothing would be left of it"};
  for (std::uint32_t& label : *labels)
    label = label == part ? no_index : 0;
  return std::move(separated(mesh, *labels, 1).front());
}

void append_mesh(const Mesh& more, Mesh& mesh) {
  const auto vertices = to_index(mesh.vertex_count());
  const auto texcoords = static_cast<std::uint32_t>(mesh.texcoords.cols());
  const auto corners = to_index(mesh.face_corners.size());
  append_columns(more.vertices, mesh.vertices);
  append_columns(more.texcoords, mesh.texcoords);
  append_columns(more.look.texcoord_colours, mesh.look.texcoord_colours);
  append_columns(more.look.vertex_colours, mesh.look.vertex_colours);
  append_numbers(more.face_corners, vertices, mesh.face_corners);
  append_numbers(more.corner_texcoords, texcoords, mesh.corner_texcoords);
  append_numbers(std::span(more.face_starts).subspan(1), corners, mesh.face_starts);
  for (std::size_t k = 0; k < 3; ++k)
    append_numbers(*face_columns(more.look)[k], 0, *face_columns(mesh.look)[k]);
  mesh.detail.clear(); // what is new has none
}

bool fit_together(const Mesh& a, const Mesh& b) noexcept {
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max() / 2;
  return a.face_corners.size() + b.face_corners.size() <= most &&
         static_cast<std::size_t>(a.vertices.cols() + b.vertices.cols()) <= most &&
         static_cast<std::size_t>(a.texcoords.cols() + b.texcoords.cols()) <= most;
}

} // namespace nendo::deform
