#include <nendo/deform/surface_graph.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include <Eigen/Geometry>

#include <nendo/deform/triangles.hpp>

#include "geometry/union_find.hpp"

namespace nendo::deform {

using Eigen::Vector3d;

namespace {

struct NearPlace {
  SurfacePosition place;
  double squared = std::numeric_limits<double>::infinity();
};

/// Of a triangle (Ericson, Real-Time Collision Detection, 5.1.5): the corner, the edge or the
/// inside in whose region the point lies.
Vector3d nearest_weights(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                         const Vector3d& p) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {1.0 - d1 / (d1 - d3), d1 / (d1 - d3), 0.0};
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {1.0 - d2 / (d2 - d6), 0.0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    const double part = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0.0, 1.0 - part, part};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

/// Returns whether straight ways between corners of a face stay on it. Around the notch of a quad
/// that is hardly concave, as modellers make them, the way is next to no longer.
bool is_open(const Mesh& mesh, FaceTriangles& triangles, std::size_t face) {
  constexpr double max_detour = 1.02;
  if (triangles.is_convex(face)) return true;
  const auto at = mesh.corners_of(face);
  if (at.size() != 4) return false;
  const auto edge = [&](std::size_t from, std::size_t to) -> Vector3d {
    return mesh.vertices.col(at[to % 4]) - mesh.vertices.col(at[from % 4]);
  };
  const Vector3d area = edge(0, 2).cross(edge(1, 3));
  for (std::size_t k = 0; k < 4; ++k)
    if (edge(k, k + 1).cross(edge(k + 1, k + 2)).dot(area) < 0.0 &&
        edge(k, k + 1).norm() + edge(k + 1, k + 2).norm() > max_detour * edge(k, k + 2).norm())
      return false;
  return true;
}

/// Calls visit() with the triangles of every face, and with those of both ways to cut a convex
/// quad: a mirrored quad's first corner may be another one, and the sides of a model are to be
/// alike.
template <class Visit>
void for_each_cut(const Mesh& mesh, Visit visit) {
  for_each_triangle(mesh, visit);
  FaceTriangles triangles(mesh);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto at = mesh.corners_of(face);
    if (at.size() != 4 || !is_open(mesh, triangles, face)) continue;
    visit(std::array{at[1], at[2], at[3]});
    visit(std::array{at[1], at[3], at[0]});
  }
}

/// An edge of a triangle, about which the next one folds, with the corner opposite to it.
struct Hinge {
  std::uint32_t low, high, opposite;
  auto operator<=>(const Hinge&) const = default;
};

/// The length of the straight line between the corners opposite to an edge, when both triangles are
/// laid into one plane; infinity if that line leaves them.
double across(const Vector3d& low, const Vector3d& high, const Vector3d& one,
              const Vector3d& other) {
  const double length = (high - low).norm();
  if (!(length > 0.0)) return std::numeric_limits<double>::infinity();
  const Vector3d along = (high - low) / length;
  const double x1 = along.dot(one - low), x2 = along.dot(other - low);
  const double y1 = (one - low - x1 * along).norm(), y2 = (other - low - x2 * along).norm();
  const double meets = y1 + y2 > 0.0 ? x1 + (x2 - x1) * y1 / (y1 + y2) : -1.0;
  if (!(meets >= 0.0 && meets <= length)) return std::numeric_limits<double>::infinity();
  return std::hypot(x2 - x1, y1 + y2);
}

} // namespace

Vector3d SurfacePosition::in(const Points& vertices) const {
  Vector3d place = Vector3d::Zero();
  for (std::size_t k = 0; k < corners.size(); ++k)
    place += weights[k] * vertices.col(corners[k]);
  return place;
}

SurfacePosition nearest_position(const Mesh& mesh, const Vector3d& to,
                                 std::span<const std::uint32_t> parts, std::uint32_t part) {
  NearPlace best;
  for_each_cut(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    if (!parts.empty() && parts[corners[0]] != part) return;
    const Points& at = mesh.vertices;
    const Vector3d weights =
        nearest_weights(at.col(corners[0]), at.col(corners[1]), at.col(corners[2]), to);
    const SurfacePosition place{corners, {weights.x(), weights.y(), weights.z()}};
    const double squared = (place.in(at)-to).squaredNorm();
    if (squared < best.squared) best = {place, squared};
  });
  return best.place;
}

SurfaceGraph::SurfaceGraph(const Mesh& mesh) : vertices_(mesh.vertices) {
  std::vector<std::pair<std::uint32_t, Way>> all;
  const auto add = [&](std::uint32_t a, std::uint32_t b, double length) {
    if (a == b || !(length < std::numeric_limits<double>::infinity())) return;
    all.push_back({a, {b, length}});
    all.push_back({b, {a, length}});
  };
  const auto straight = [&](std::uint32_t a, std::uint32_t b) {
    return (vertices_.col(a) - vertices_.col(b)).norm();
  };
  FaceTriangles triangles(mesh);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    if (!is_open(mesh, triangles, face)) { // a straight way may lead outside
      for (const Triangle& corners : triangles.of(face))
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = mesh.face_corners[corners[k]];
          const std::uint32_t b = mesh.face_corners[corners[(k + 1) % 3]];
          add(a, b, straight(a, b));
        }
      continue;
    }
    const auto corners = mesh.corners_of(face);
    for (std::size_t one = 0; one < corners.size(); ++one)
      for (std::size_t other = one + 1; other < corners.size(); ++other) {
        if (other > one + 2 && one > 0) break; // of large faces, few diagonals
        add(corners[one], corners[other], straight(corners[one], corners[other]));
      }
  }
  std::vector<Hinge> edges;
  for_each_cut(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), corners[(k + 2) % 3]});
    }
  });
  std::sort(edges.begin(), edges.end());
  // Two quads meet with two triangles each. Those of one face give a way longer than its diagonal.
  constexpr std::size_t max_at_edge = 4;
  for (std::size_t at = 0; at < edges.size(); ++at)
    for (std::size_t to = at + 1; to < std::min(at + max_at_edge, edges.size()); ++to) {
      const Hinge &one = edges[at], &other = edges[to];
      if (one.low != other.low || one.high != other.high) break;
      add(one.opposite, other.opposite,
          across(vertices_.col(one.low), vertices_.col(one.high), vertices_.col(one.opposite),
                 vertices_.col(other.opposite)));
    }
  // A way from two faces is listed twice, which only costs its memory.
  std::sort(all.begin(), all.end());
  starts_.assign(static_cast<std::size_t>(vertices_.cols()) + 1, 0);
  for (const auto& [from, way] : all) {
    ++starts_[from + 1];
    ways_.push_back(way);
  }
  for (std::size_t at = 1; at < starts_.size(); ++at)
    starts_[at] += starts_[at - 1];
}

Eigen::VectorXd SurfaceGraph::distances(const SurfacePosition& from, double limit) const {
  using Entry = std::pair<double, std::uint32_t>;
  constexpr double far = std::numeric_limits<double>::infinity();
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(vertices_.cols(), far);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
  const auto reach = [&](std::uint32_t vertex, double length) {
    if (!(length <= limit) || !(length < distance[vertex])) return;
    distance[vertex] = length;
    next.push({length, vertex});
  };
  const Vector3d place = from.in(vertices_);
  for (const std::uint32_t vertex : about(from))
    reach(vertex, (vertices_.col(vertex) - place).norm());
  while (!next.empty()) {
    const auto [length, vertex] = next.top();
    next.pop();
    if (length > distance[vertex]) continue;
    for (std::size_t at = starts_[vertex]; at < starts_[vertex + 1]; ++at)
      reach(ways_[at].to, length + ways_[at].length);
  }
  return distance;
}

std::vector<std::uint32_t> SurfaceGraph::about(const SurfacePosition& place) const {
  constexpr double min_weight = 1e-9;
  std::vector<std::uint32_t> vertices;
  for (std::size_t k = 0; k < place.corners.size(); ++k)
    if (place.weights[k] > min_weight &&
        std::find(vertices.begin(), vertices.end(), place.corners[k]) == vertices.end())
      vertices.push_back(place.corners[k]);
  const std::size_t corners = vertices.size();
  if (corners < 2) return vertices;
  const auto leads_to = [&](std::uint32_t from, std::uint32_t to) {
    return std::any_of(ways_.data() + starts_[from], ways_.data() + starts_[from + 1],
                       [&](const Way& way) { return way.to == to; });
  };
  for (std::size_t at = starts_[vertices[0]]; at < starts_[vertices[0] + 1]; ++at) {
    const std::uint32_t to = ways_[at].to;
    bool is_common = true;
    for (std::size_t k = 1; k < corners && is_common; ++k)
      is_common = to != vertices[k] && leads_to(vertices[k], to);
    if (is_common) vertices.push_back(to);
  }
  return vertices;
}

std::vector<std::uint32_t> SurfaceGraph::parts() const {
  UnionFind sets(vertex_count());
  for (std::uint32_t vertex = 0; vertex < vertex_count(); ++vertex)
    for (std::size_t at = starts_[vertex]; at < starts_[vertex + 1]; ++at)
      sets.join(vertex, ways_[at].to);
  return sets.numbers();
}

} // namespace nendo::deform
