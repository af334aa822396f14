#include <nendo/deform/edit_part.hpp>

#include <algorithm>

#include "cut/cut_assembly.hpp"
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

} // namespace nendo::deform
