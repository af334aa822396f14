#include "mesh/surface_mesh.hpp"

#include <utility>

#include "mesh/columns.hpp"
#include "mesh/used_entries.hpp"

namespace nendo::deform {
namespace {

/// Returns the twins of edges whose ends are `from` and `to`. Each edge that goes from a lesser to
/// a greater vertex looks for those that come back.
std::vector<std::uint32_t> twins_of(std::span<const std::uint32_t> from,
                                    std::span<const std::uint32_t> to,
                                    const RowsByKey<std::uint32_t>& out) {
  constexpr std::uint32_t several = no_index - 1;
  std::vector<std::uint32_t> twins(from.size(), no_index);
  for (std::uint32_t edge = 0; edge < from.size(); ++edge) {
    if (from[edge] > to[edge]) continue;
    for (const std::uint32_t other : out[to[edge]]) {
      if (to[other] != from[edge]) continue;
      const bool is_only = twins[edge] == no_index && twins[other] == no_index;
      for (const std::uint32_t one : {edge, other}) {
        if (is_only) continue;
        // Neither these nor those that were taken for their twins have only one.
        if (twins[one] < several) twins[twins[one]] = several;
        twins[one] = several;
      }
      if (is_only) {
        twins[edge] = other;
        twins[other] = edge;
      }
    }
  }
  for (std::uint32_t& twin : twins)
    if (twin == several) twin = no_index;
  return twins;
}

} // namespace

SurfaceMesh::SurfaceMesh(std::vector<Corners> faces, std::size_t points)
    : faces_(std::move(faces)), edge_at_(points, no_index) {
  std::vector<std::uint32_t> begins(3 * faces_.size()), ends(begins.size());
  for (std::uint32_t edge = 0; edge < begins.size(); ++edge) {
    begins[edge] = from(edge);
    ends[edge] = to(edge);
    edge_at_[from(edge)] = edge;
  }
  twins_ = twins_of(begins, ends, rows_by_key<std::uint32_t>(points, [&](const auto& visit) {
                      for (std::uint32_t edge = 0; edge < begins.size(); ++edge)
                        visit(begins[edge], edge);
                    }));
  for (std::uint32_t edge = 0; edge < begins.size(); ++edge)
    if (twins_[edge] == no_index) boundary_.emplace(edge_key(begins[edge], ends[edge]), edge);
}

std::uint32_t SurfaceMesh::edge_between(std::uint32_t one, std::uint32_t other) const {
  std::uint32_t found = no_index;
  if (!has_point(one)) return found;
  visit_edges(one, [&](std::uint32_t edge) {
    if (to(edge) == other) found = edge;
  });
  return found;
}

std::uint32_t SurfaceMesh::add_point() {
  edge_at_.push_back(no_index);
  return point_count() - 1;
}

std::uint32_t SurfaceMesh::add_face(const Corners& corners) {
  const std::uint32_t face = face_count();
  faces_.push_back(corners);
  twins_.resize(twins_.size() + 3, no_index);
  for (std::uint32_t edge = 3 * face; edge < 3 * face + 3; ++edge) {
    edge_at_[from(edge)] = edge;
    const auto found = boundary_.find(edge_key(to(edge), from(edge)));
    link(edge, found == boundary_.end() ? no_index : found->second);
    if (found != boundary_.end()) boundary_.erase(found);
  }
  return face;
}

void SurfaceMesh::remove_faces(std::span<const std::uint32_t> faces) {
  for (const std::uint32_t face : faces) {
    for (std::uint32_t edge = 3 * face; edge < 3 * face + 3; ++edge) {
      edge_at_[from(edge)] = no_index;
      if (twins_[edge] == no_index) boundary_.erase(edge_key(from(edge), to(edge)));
    }
    faces_[face].fill(no_index);
  }
  // A point that keeps some of its faces is at the boundary then.
  for (const std::uint32_t face : faces)
    for (std::uint32_t edge = 3 * face; edge < 3 * face + 3; ++edge) {
      const std::uint32_t back = twins_[edge];
      if (back == no_index || !has_face(back / 3)) continue;
      link(back, no_index);
      edge_at_[from(back)] = back;
      edge_at_[to(back)] = next(back);
    }
}

std::uint32_t SurfaceMesh::split(std::uint32_t edge) {
  const std::uint32_t back = twins_[edge];
  const std::uint32_t point = add_point();
  const std::uint32_t to_end = split_face(edge, point);
  link(edge, split_face(back, point));
  link(back, to_end);
  edge_at_[from(edge)] = edge;
  edge_at_[from(back)] = back;
  return point;
}

/// Gives the half at the edge's end to a new face, and returns that half.
std::uint32_t SurfaceMesh::split_face(std::uint32_t edge, std::uint32_t point) {
  const std::uint32_t following = next(edge);
  const std::uint32_t tip = last(edge);
  const std::uint32_t fresh = 3 * face_count();
  faces_.push_back({point, from(following), from(tip)});
  twins_.resize(twins_.size() + 3, no_index);
  link(next(fresh), twins_[following]);
  link(last(fresh), following);
  edge_at_[from(following)] = next(fresh);
  faces_[edge / 3][following % 3] = point;
  edge_at_[point] = following;
  edge_at_[from(tip)] = tip;
  return fresh;
}

/// With no_index, the edge is at the boundary.
void SurfaceMesh::link(std::uint32_t edge, std::uint32_t twin) {
  twins_[edge] = twin;
  if (twin == no_index)
    boundary_[edge_key(from(edge), to(edge))] = edge;
  else
    twins_[twin] = edge;
}

bool SurfaceMesh::can_collapse(std::uint32_t edge) const {
  // The ends share exactly the two tips, and no tip loses its last but two faces.
  const std::uint32_t a = from(edge);
  std::size_t common = 0;
  visit_edges(to(edge), [&](std::uint32_t at) {
    if (to(at) != a && edge_between(a, to(at)) != no_index) ++common;
  });
  if (common != 2) return false;
  for (const std::uint32_t tip : {from(last(edge)), from(last(twins_[edge]))}) {
    std::size_t faces = 0;
    visit_edges(tip, [&](std::uint32_t) { ++faces; });
    if (faces <= 3) return false;
  }
  return true;
}

void SurfaceMesh::collapse(std::uint32_t edge) {
  const std::uint32_t back = twins_[edge];
  const auto [a, b, c, d] = points_at(edge);
  visit_edges_from(back, [&, a = a](std::uint32_t at) { faces_[at / 3][at % 3] = a; });
  const std::uint32_t beyond_c = twins_[next(edge)]; // from c to b before
  const std::uint32_t beside_a = twins_[last(edge)]; // from a to c
  const std::uint32_t beyond_d = twins_[next(back)]; // from d to a
  const std::uint32_t beside_b = twins_[last(back)]; // from b to d before
  link(beyond_c, beside_a);
  link(beyond_d, beside_b);
  faces_[edge / 3].fill(no_index);
  faces_[back / 3].fill(no_index);
  edge_at_[a] = beside_a;
  edge_at_[c] = beyond_c;
  edge_at_[d] = beyond_d;
  edge_at_[b] = no_index;
}

bool SurfaceMesh::can_flip(std::uint32_t edge) const {
  const auto [a, b, c, d] = points_at(edge);
  if (c == d) return false;
  std::size_t at_a = 0;
  std::size_t at_b = 0;
  visit_edges_from(edge, [&](std::uint32_t) { ++at_a; });
  visit_edges_from(twins_[edge], [&](std::uint32_t) { ++at_b; });
  return at_a > 3 && at_b > 3 && edge_between(c, d) == no_index;
}

void SurfaceMesh::flip(std::uint32_t edge) {
  const std::uint32_t back = twins_[edge];
  const auto [a, b, c, d] = points_at(edge);
  const std::array<std::uint32_t, 4> beyond{twins_[next(edge)], twins_[last(edge)],
                                            twins_[next(back)], twins_[last(back)]};
  const auto set = [&](std::uint32_t at, std::uint32_t point) {
    faces_[at / 3][at % 3] = point;
    edge_at_[point] = at;
  };
  set(edge, d);
  set(next(edge), c);
  set(last(edge), a);
  set(back, c);
  set(next(back), d);
  set(last(back), b);
  link(next(edge), beyond[1]); // from c to a
  link(last(edge), beyond[2]); // from a to d
  link(next(back), beyond[3]); // from d to b
  link(last(back), beyond[0]); // from b to c
}

void SurfaceMesh::open(std::span<const std::uint32_t> loop) {
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const std::uint32_t copy = add_point();
    const std::uint32_t before = loop[(k + loop.size() - 1) % loop.size()];
    for (std::uint32_t at = twins_[before]; at != loop[k]; at = twins_[last(at)]) {
      faces_[at / 3][at % 3] = copy;
      edge_at_[copy] = at;
    }
    edge_at_[from(loop[k])] = loop[k];
  }
  for (const std::uint32_t edge : loop) {
    link(twins_[edge], no_index);
    link(edge, no_index);
  }
}

std::vector<Corners> SurfaceMesh::take(Renumbering& numbers) {
  std::uint32_t count = 0;
  numbers.points.assign(edge_at_.size(), no_index);
  for (std::size_t point = 0; point < edge_at_.size(); ++point)
    if (edge_at_[point] != no_index) numbers.points[point] = count++;
  count = 0;
  numbers.faces.assign(faces_.size(), no_index);
  for (std::uint32_t face = 0; face < faces_.size(); ++face) {
    if (!has_face(face)) continue;
    numbers.faces[face] = count++;
    for (std::uint32_t& corner : faces_[face])
      corner = numbers.points[corner];
  }
  std::vector<Corners> faces = std::move(faces_);
  keep_values(faces, numbers.faces, no_index);
  *this = {};
  return faces;
}

HalfEdges half_edges_of(std::span<const std::uint32_t> face_starts,
                        std::span<const std::uint32_t> face_corners, std::size_t vertices) {
  HalfEdges edges;
  const std::size_t count = face_corners.size();
  edges.next.resize(count);
  edges.last.resize(count);
  std::vector<std::uint32_t> to(count);
  for_each_face_edge(face_starts, [&](auto, std::uint32_t edge, std::uint32_t next) {
    edges.next[edge] = next;
    edges.last[next] = edge;
    to[edge] = face_corners[next];
  });
  edges.out = rows_by_key<std::uint32_t>(vertices, [&](const auto& visit) {
    for (std::uint32_t edge = 0; edge < count; ++edge)
      visit(face_corners[edge], edge);
  });
  edges.twin = twins_of(face_corners, to, edges.out);
  return edges;
}

} // namespace nendo::deform
