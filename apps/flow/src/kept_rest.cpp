#include <nendo/flow/model_version.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace nendo::flow {
namespace {

using deform::Points;
using Eigen::Index;

constexpr int max_sweeps = 500;
constexpr double enough =
    1e-7; ///< relative to the longest path: a sweep that changes less is the last

/// For each vertex that was made, the shape's vertex that it was, or -1. Vertices keep their
/// numbers as long as none is taken away; then they are known by their places.
std::vector<Index> vertices_before(const Points& made, const Points& shape) {
  const auto is_as_before = [&](Index vertex) {
    return vertex < made.cols() && vertex < shape.cols() && made.col(vertex) == shape.col(vertex);
  };
  std::map<std::array<double, 3>, Index> at_place;
  for (Index vertex = shape.cols(); vertex-- > 0;) // of several at one place the first counts
    if (!is_as_before(vertex))
      at_place[{shape(0, vertex), shape(1, vertex), shape(2, vertex)}] = vertex;
  std::vector<Index> before;
  before.reserve(static_cast<std::size_t>(made.cols()));
  for (Index vertex = 0; vertex < made.cols(); ++vertex) {
    if (is_as_before(vertex)) {
      before.push_back(vertex);
      continue;
    }
    const auto same = at_place.find({made(0, vertex), made(1, vertex), made(2, vertex)});
    before.push_back(same == at_place.end() ? -1 : same->second);
  }
  return before;
}

/// The ends of edges that begin at new vertices, in this order.
std::vector<std::pair<Index, Index>> edges_of_new(const deform::Mesh& made,
                                                  const std::vector<Index>& before) {
  std::vector<std::pair<Index, Index>> edges;
  for (std::size_t face = 0; face + 1 < made.face_starts.size(); ++face) {
    const std::size_t begin = made.face_starts[face], end = made.face_starts[face + 1];
    for (std::size_t corner = begin; corner < end; ++corner) {
      const Index from = made.face_corners[corner];
      const Index to = made.face_corners[corner + 1 < end ? corner + 1 : begin];
      for (const auto& [one, other] : {std::pair{from, to}, std::pair{to, from}})
        if (before[static_cast<std::size_t>(one)] < 0) edges.emplace_back(one, other);
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// By Gauss and Seidel's method.
void spread(const std::vector<std::pair<Index, Index>>& edges, Points& ways) {
  const double longest = ways.size() > 0 ? ways.cwiseAbs().maxCoeff() : 0.0;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    double change = 0.0;
    for (std::size_t at = 0; at < edges.size();) {
      const Index vertex = edges[at].first;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double count = 0.0;
      for (; at < edges.size() && edges[at].first == vertex; ++at, ++count)
        sum += ways.col(edges[at].second);
      const Eigen::Vector3d mean = sum / count;
      change = std::max(change, (mean - ways.col(vertex)).cwiseAbs().maxCoeff());
      ways.col(vertex) = mean;
    }
    if (change <= enough * longest) return;
  }
}

} // namespace

Points kept_rest(const deform::Mesh& made, const Points& shape, const Points& rest) {
  const std::vector<Index> before = vertices_before(made.vertices, shape);
  Points ways = Points::Zero(3, made.vertices.cols());
  for (Index vertex = 0; vertex < ways.cols(); ++vertex)
    if (const Index old = before[static_cast<std::size_t>(vertex)]; old >= 0)
      ways.col(vertex) = rest.col(old) - shape.col(old);
  spread(edges_of_new(made, before), ways);
  Points kept = made.vertices + ways;
  for (Index vertex = 0; vertex < kept.cols(); ++vertex) // without rounding
    if (const Index old = before[static_cast<std::size_t>(vertex)]; old >= 0)
      kept.col(vertex) = rest.col(old);
  return kept;
}

} // namespace nendo::flow
