#include <nendo/deform/subdivision.hpp>

#include <algorithm>
#include <cassert>
#include <compare>
#include <utility>

#include <Eigen/Geometry>

#include <nendo/deform/refinement.hpp>
#include <nendo/deform/triangles.hpp>

#include "mesh/columns.hpp"
#include "mesh/surface_mesh.hpp"

namespace nendo::deform {
namespace {

/// An edge of a face: its ends, the lesser one first, and the corner after which it is.
struct Edge {
  std::uint64_t ends;
  std::uint32_t corner;
  auto operator<=>(const Edge&) const = default;
};

/// The edges of all faces by their ends, with the values of `corner_values` as ends.
std::vector<Edge> sorted_edges(const Mesh& mesh, const std::vector<std::uint32_t>& corner_values) {
  std::vector<Edge> edges;
  edges.reserve(corner_values.size());
  for_each_face_edge(mesh.face_starts, [&](auto face, std::uint32_t at, std::uint32_t next) {
    const auto [low, high] = std::minmax(corner_values[at], corner_values[next]);
    if (mesh.corners_of(face).size() >= 3) edges.push_back({edge_key(low, high), at});
  });
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Numbers the middles of edges and of faces from `first` on: of each corner the middle of the edge
/// after it, and of each face its own.
struct Middles {
  std::vector<std::uint32_t> of_corner;
  std::vector<std::uint32_t> of_face; ///< only for faces with more than three corners
  std::vector<std::uint32_t> parent_starts{0};
  std::vector<std::uint32_t> parents;

  Middles(const Mesh& mesh, const std::vector<std::uint32_t>& corner_values, std::uint32_t first)
      : of_corner(corner_values.size()), of_face(mesh.face_count()) {
    const std::vector<Edge> edges = sorted_edges(mesh, corner_values);
    for (std::size_t at = 0; at < edges.size(); ++at) {
      if (at == 0 || edges[at].ends != edges[at - 1].ends)
        add(std::array{static_cast<std::uint32_t>(edges[at].ends >> 32),
                       static_cast<std::uint32_t>(edges[at].ends)});
      of_corner[edges[at].corner] = first + count() - 1;
    }
    for (std::size_t face = 0; face < mesh.face_count(); ++face) {
      const std::size_t corners = mesh.corners_of(face).size();
      if (corners < 4) continue;
      add(std::span(corner_values).subspan(mesh.face_starts[face], corners));
      of_face[face] = first + count() - 1;
    }
  }
  std::uint32_t count() const noexcept { return to_index(parent_starts.size() - 1); }
  void add(std::span<const std::uint32_t> of) {
    parents.insert(parents.end(), of.begin(), of.end());
    parent_starts.push_back(to_index(parents.size()));
  }
};

/// Appends the means of parents to the columns of `points`.
template <class Columns>
void append_means(const Middles& middles, Columns& points) {
  using Number = typename Columns::Scalar;
  const Eigen::Index before = points.cols();
  points.conservativeResize(Eigen::NoChange, before + middles.count());
  for (std::uint32_t at = 0; at < middles.count(); ++at) {
    const std::uint32_t begin = middles.parent_starts[at];
    const std::uint32_t end = middles.parent_starts[at + 1];
    auto mean = points.col(before + at);
    const auto parent = [&](std::uint32_t of) {
      return points.col(static_cast<Eigen::Index>(middles.parents[of]));
    };
    mean = parent(begin) / static_cast<Number>(end - begin);
    auto lowest = parent(begin).eval();
    auto highest = lowest;
    for (std::uint32_t of = begin + 1; of < end; ++of) {
      mean += parent(of) / static_cast<Number>(end - begin);
      lowest = lowest.cwiseMin(parent(of)).eval();
      highest = highest.cwiseMax(parent(of)).eval();
    }
    // Rounding must not lead out of the box of the parents. What is not finite stays so.
    if (mean.allFinite()) mean = mean.cwiseMax(lowest).cwiseMin(highest).eval();
  }
}

/// Appends the corners of the faces that a face becomes. `ends_face(face)` is called after each.
template <class EndsFace>
void append_faces(const Mesh& mesh, const std::vector<std::uint32_t>& corner_values,
                  const Middles& middles, std::vector<std::uint32_t>& corners,
                  const EndsFace& ends_face) {
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t begin = mesh.face_starts[face];
    const auto count = static_cast<std::uint32_t>(mesh.corners_of(face).size());
    const auto after = [&](std::uint32_t at) { return middles.of_corner[begin + at]; };
    const auto before = [&](std::uint32_t at) { return after((at + count - 1) % count); };
    if (count < 3) {
      corners.insert(corners.end(), corner_values.begin() + begin,
                     corner_values.begin() + begin + count);
      ends_face(face);
      continue;
    }
    for (std::uint32_t at = 0; at < count; ++at) {
      corners.insert(corners.end(), {corner_values[begin + at], after(at)});
      if (count > 3) corners.push_back(middles.of_face[face]);
      corners.push_back(before(at));
      ends_face(face);
    }
    if (count > 3) continue;
    corners.insert(corners.end(), {after(0), after(1), after(2)});
    ends_face(face);
  }
}

/// Of each face whether the new faces around its middle would fold, as in that of a letter L.
std::vector<bool> faces_that_fold(const Mesh& mesh) {
  std::vector<bool> folds(mesh.face_count(), false);
  FaceTriangles triangles(mesh);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    if (triangles.is_convex(face)) continue;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero(), area = Eigen::Vector3d::Zero();
    const auto corners = mesh.corners_of(face);
    for (const std::uint32_t vertex : corners)
      middle += mesh.vertices.col(vertex) / static_cast<double>(corners.size());
    const auto area_at = [&](std::size_t at) -> Eigen::Vector3d {
      const Eigen::Vector3d from = mesh.vertices.col(corners[at]);
      return (from - middle).cross(mesh.vertices.col(corners[(at + 1) % corners.size()]) - middle);
    };
    for (std::size_t at = 0; at < corners.size(); ++at)
      area += area_at(at);
    for (std::size_t at = 0; at < corners.size() && !folds[face]; ++at)
      folds[face] = !(area_at(at).dot(area) > 0.0);
  }
  return folds;
}

Subdivision subdivided_faces(const Mesh& mesh) {
  Subdivision result;
  Mesh& finer = result.mesh;
  finer.vertices = mesh.vertices;
  finer.offset = mesh.offset;
  Middles middles(mesh, mesh.face_corners, to_index(mesh.vertex_count()));
  append_means(middles, finer.vertices);
  finer.look = mesh.look;
  for (auto* column : face_columns(finer.look))
    column->clear();
  append_faces(mesh, mesh.face_corners, middles, finer.face_corners,
               [&](std::size_t face) { end_face(mesh, face, finer); });
  if (finer.look.vertex_colours.cols() > 0) append_means(middles, finer.look.vertex_colours);
  result.parent_starts = std::move(middles.parent_starts);
  result.parents = std::move(middles.parents);
  if (mesh.corner_texcoords.empty()) return result;
  finer.texcoords = mesh.texcoords;
  const Middles of_texture(mesh, mesh.corner_texcoords,
                           static_cast<std::uint32_t>(mesh.texcoords.cols()));
  append_means(of_texture, finer.texcoords);
  if (finer.look.texcoord_colours.cols() > 0) append_means(of_texture, finer.look.texcoord_colours);
  append_faces(mesh, mesh.corner_texcoords, of_texture, finer.corner_texcoords, [](std::size_t) {});
  return result;
}

} // namespace

Subdivision subdivide(const Mesh& mesh) {
  const std::vector<bool> folds = faces_that_fold(mesh);
  if (std::find(folds.begin(), folds.end(), true) == folds.end()) return subdivided_faces(mesh);
  return subdivided_faces(with_split_faces(mesh, mesh.vertices, folds));
}

BlockShape subdivided(const BlockShape& shape, const BlockLayout& before,
                      const Subdivision& subdivision, const BlockLayout& after) {
  assert(before.origin() == after.origin() && before.unit() == after.unit());
  const std::vector<std::uint32_t> places = before.places();
  const BlockShape unmoved = before.pack();
  const BlockShape finer = after.pack();
  Eigen::Matrix3Xf moved(3, static_cast<Eigen::Index>(after.vertex_count()));
  for (std::size_t at = 0; at < after.vertex_count(); ++at) {
    const std::uint32_t vertex = after.order()[at];
    if (vertex < places.size()) {
      moved.col(vertex) = vertex_at(shape, places[vertex]);
      continue;
    }
    const std::size_t middle = vertex - places.size();
    const std::uint32_t begin = subdivision.parent_starts[middle];
    const std::uint32_t end = subdivision.parent_starts[middle + 1];
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (std::uint32_t of = begin; of < end; ++of) {
      const std::uint32_t place = places[subdivision.parents[of]];
      sum += vertex_at(shape, place) - vertex_at(unmoved, place);
    }
    moved.col(vertex) = vertex_at(finer, at) + sum / static_cast<float>(end - begin);
  }
  return shape_in_blocks(moved, after);
}

} // namespace nendo::deform
