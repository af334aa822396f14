#include "join/seam.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

#include <Eigen/SparseCholesky>

#include "join/live_surface.hpp"
#include "join/refine.hpp"
#include "mesh/used_entries.hpp"

namespace nendo::deform {
namespace {

constexpr double shortest_edge = 1e-60; ///< keeps weights finite
/// Draws points to where they are: so little that it shows only where nothing else holds a surface
/// that is free as a whole.
constexpr double hold = 1e-10;

using Places = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Sparse = Eigen::SparseMatrix<double>;

/// Rows of the umbrella operator, at the free points and their neighbours: what each row's point is
/// away from the mean of its neighbours.
class Umbrellas {
public:
  Umbrellas(const LiveSurface& surface, std::span<const std::uint32_t> free)
      : number_(surface.point_count()) {
    for (const std::uint32_t point : free)
      number_(point);
    for (const std::uint32_t point : free)
      surface.visit_edges(point, [&](std::uint32_t edge) { number_(surface.to(edge)); });
    const std::size_t row_count = number_.entries().size();
    for (std::size_t row = 0; row < row_count; ++row)
      add_row(surface, row);
    rows_.resize(static_cast<Eigen::Index>(row_count),
                 static_cast<Eigen::Index>(number_.entries().size()));
    rows_.setFromTriplets(entries_.begin(), entries_.end());
  }

  const Sparse& rows() const { return rows_; }
  Places places(const LiveSurface& surface) const {
    Places places(static_cast<Eigen::Index>(number_.entries().size()), 3);
    for (std::size_t at = 0; at < number_.entries().size(); ++at) {
      const SpacePoint& place = surface.point(number_.entries()[at]);
      places.row(static_cast<Eigen::Index>(at)) << place[0], place[1], place[2];
    }
    return places;
  }

private:
  /// A neighbour counts the less the longer its edge is, so that uneven triangles pull nowhere.
  void add_row(const LiveSurface& surface, std::size_t row) {
    const auto weight_of = [&](std::uint32_t edge) {
      return 1.0 / std::max(surface.edge_length(edge), shortest_edge);
    };
    double sum = 0.0;
    surface.visit_edges(number_.entries()[row],
                        [&](std::uint32_t edge) { sum += weight_of(edge); });
    entries_.emplace_back(static_cast<int>(row), static_cast<int>(row), 1.0);
    surface.visit_edges(number_.entries()[row], [&](std::uint32_t edge) {
      entries_.emplace_back(static_cast<int>(row), static_cast<int>(number_(surface.to(edge))),
                            -weight_of(edge) / sum);
    });
  }

  FirstUses number_; ///< the free points, rows that stay, and their neighbours
  std::vector<Eigen::Triplet<double>> entries_;
  Sparse rows_;
};

/// Returns places for the free points, such that the sum over them and their neighbours of the
/// squared distances to the mean of each one's neighbours, weighted by 1 / distance, is least.
/// Solved by a sparse Cholesky factorisation: the same bits for the same calls. Allocates.
std::vector<SpacePoint> thin_plate(const LiveSurface& surface,
                                   std::span<const std::uint32_t> free) {
  const Umbrellas umbrellas(surface, free);
  const auto count = static_cast<Eigen::Index>(free.size());
  const Places places = umbrellas.places(surface);
  const Sparse columns = umbrellas.rows().leftCols(count);
  Sparse square = columns.transpose() * columns;
  square.diagonal().array() += hold;
  const Eigen::SimplicialLLT<Sparse> solver(square);
  Places smooth = places.topRows(count);
  if (solver.info() == Eigen::Success)
    smooth -= solver.solve(columns.transpose() * (umbrellas.rows() * places));
  std::vector<SpacePoint> found;
  found.reserve(free.size());
  for (Eigen::Index at = 0; at < count; ++at)
    found.push_back({smooth(at, 0), smooth(at, 1), smooth(at, 2)});
  return found;
}

/// So many edges lie side by side in the seam's width, at least; more where the surface is finer.
constexpr double edges_in_width = 4.0;
constexpr double long_edge = 1.4;  ///< relative to the mean edge: longer edges are split
constexpr double short_edge = 0.4; ///< relative to the longest: shorter edges are collapsed
constexpr double thin_face =
    1e-3; ///< relative to the longest: steps where a part was only displaced are lower
constexpr double zone_widths = 4.0;     ///< so far away is the surface refined
constexpr double coarser = 2.0;         ///< beyond the width: so much longer edges a width further
constexpr double farthest_motion = 1.0; ///< relative to the width
constexpr int max_rounds = 12;
constexpr std::size_t max_operations = 100000;
/// A long and narrow seam gets longer edges instead of more triangles. Its band of twice the width,
/// and what becomes coarser beyond it, has 14 triangles for each square of the longest edge.
constexpr double max_triangles = 1e5;
constexpr double triangles_in_square = 14.0;
constexpr double infinitely_far = 1e300;

/// How far points are from the seam, along edges; infinitely_far beyond the width.
std::vector<double> distances_from(const LiveSurface& surface,
                                   std::span<const std::uint32_t> on_seam, double width) {
  using Entry = std::pair<double, std::uint32_t>;
  std::vector<double> distances(surface.point_count(), infinitely_far);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
  for (const std::uint32_t point : on_seam) {
    if (!surface.has_point(point)) continue;
    distances[point] = 0.0;
    next.emplace(0.0, point);
  }
  while (!next.empty()) {
    const auto [reached, point] = next.top();
    next.pop();
    if (reached > distances[point]) continue;
    const double so_far = reached;
    surface.visit_edges(point, [&](std::uint32_t edge) {
      const double there = so_far + surface.edge_length(edge);
      if (there >= width || there >= distances[surface.to(edge)]) return;
      distances[surface.to(edge)] = there;
      next.emplace(there, surface.to(edge));
    });
  }
  return distances;
}

/// The mean edge near the seam, of edges that no crossing made; of all edges there, if there are
/// none.
double mean_edge(const LiveSurface& surface, const std::vector<double>& distances) {
  double sums[2] = {0.0, 0.0};
  double counts[2] = {0.0, 0.0};
  for (std::uint32_t point = 0; point < distances.size(); ++point) {
    if (distances[point] >= infinitely_far || !surface.has_point(point)) continue;
    surface.visit_edges(point, [&](std::uint32_t edge) {
      const bool is_old = distances[point] > 0.0 && distances[surface.to(edge)] > 0.0;
      sums[is_old ? 0 : 1] += surface.edge_length(edge);
      counts[is_old ? 0 : 1] += 1.0;
    });
  }
  const std::size_t which = counts[0] > 0.0 ? 0 : 1;
  return sums[which] / std::max(counts[which], 1.0);
}

double smoothed(double part) noexcept {
  const double t = std::clamp(part, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Splits the seam's own edges, and returns all points on it.
std::vector<std::uint32_t> split_seam(LiveSurface& surface, std::span<const SeamEdge> edges,
                                      double longest) {
  std::vector<std::uint32_t> on_seam;
  std::vector<SeamEdge> left(edges.begin(), edges.end());
  for (const SeamEdge& edge : edges) {
    on_seam.push_back(edge.first);
    on_seam.push_back(edge.second);
  }
  for (std::size_t at = 0; at < left.size() && left.size() < max_operations; ++at) {
    const auto [from, to] = left[at];
    if (distance_between(surface.point(from), surface.point(to)) <= longest) continue;
    const std::uint32_t middle = surface.split(surface.edge_between(from, to));
    on_seam.push_back(middle);
    left.emplace_back(from, middle);
    left.emplace_back(middle, to);
  }
  std::sort(on_seam.begin(), on_seam.end());
  on_seam.erase(std::unique(on_seam.begin(), on_seam.end()), on_seam.end());
  return on_seam;
}

/// The longest edge near the seam.
double longest_edge(const LiveSurface& surface, std::span<const SeamEdge> edges, double mean,
                    double width) {
  double seam = 0.0;
  for (const auto& [from, to] : edges)
    seam += distance_between(surface.point(from), surface.point(to));
  const double bounded = std::sqrt(triangles_in_square * seam * width / max_triangles);
  return std::min(long_edge * mean, std::max(width / edges_in_width, bounded));
}

/// Makes the triangles near the seam even, and returns the points that are on the seam then. What
/// is far enough away to keep its detail also keeps its points. Distances are found once: new
/// points are as coarse as their edge's ends are on average.
std::vector<std::uint32_t> even_out(LiveSurface& surface, std::span<const SeamEdge> edges,
                                    double width, RefineZone& zone) {
  std::vector<std::uint32_t> on_seam = split_seam(surface, edges, infinitely_far);
  RefineLimits limits;
  limits.longest = longest_edge(surface, edges,
                                mean_edge(surface, distances_from(surface, on_seam, width)), width);
  limits.shortest = short_edge * limits.longest;
  limits.thin = thin_face * limits.longest;
  limits.budget = max_operations;
  on_seam = split_seam(surface, edges, limits.longest);
  zone.hold.assign(surface.point_count(), 2);
  zone.coarseness.assign(surface.point_count(), 0.0f);
  const std::vector<double> distances = distances_from(surface, on_seam, zone_widths * width);
  for (std::uint32_t point = 0; point < distances.size(); ++point) {
    const double beyond = std::max(distances[point] / width - 1.0, 0.0);
    const bool is_far = distances[point] >= infinitely_far;
    zone.coarseness[point] = is_far ? 0.0f : static_cast<float>(1.0 + coarser * beyond);
    if (distances[point] < 0.5 * width) zone.hold[point] = 0;
  }
  for (const std::uint32_t point : on_seam)
    zone.hold[point] = 1;
  for (int round = 0; round < max_rounds; ++round) {
    const RefineCounts done = refine(surface, zone, limits);
    limits.budget -= done.splits + done.collapses;
    if (done.splits + done.collapses + done.flips == 0) break;
  }
  return on_seam;
}

double area_at(const LiveSurface& surface, const std::vector<char>& moves) {
  double twice = 0.0;
  for (std::uint32_t face = 0; face < surface.face_count(); ++face) {
    if (!surface.has_face(face)) continue;
    const std::uint32_t a = surface.from(3 * face);
    const std::uint32_t b = surface.from(3 * face + 1);
    const std::uint32_t c = surface.from(3 * face + 2);
    if (moves[a] || moves[b] || moves[c])
      twice += length_of(area_vector(surface.point(a), surface.point(b), surface.point(c)));
  }
  return 0.5 * twice;
}

/// Moves the points within the width towards the thin plate: wholly near the seam, less and less
/// towards the rim.
void move_points(LiveSurface& surface, std::span<const std::uint32_t> on_seam, double width,
                 std::vector<char>& moves, Seam& seam) {
  const std::vector<double> distances = distances_from(surface, on_seam, width);
  std::vector<std::uint32_t> free;
  for (std::uint32_t point = 0; point < distances.size(); ++point)
    if (distances[point] < infinitely_far) {
      free.push_back(point);
      moves[point] = 1;
    }
  const std::vector<SpacePoint> smooth = thin_plate(surface, free);
  const double before = area_at(surface, moves);
  const double farthest = farthest_motion * width;
  for (std::size_t at = 0; at < free.size(); ++at) {
    const double full = smoothed(2.0 * (1.0 - distances[free[at]] / width));
    SpacePoint way = full * (smooth[at] - surface.point(free[at]));
    if (length_of(way) > farthest) way = (farthest / length_of(way)) * way;
    seam.moved = std::max(seam.moved, length_of(way));
    surface.move(free[at], surface.point(free[at]) + way);
  }
  seam.volume_bound = std::max(before, area_at(surface, moves)) * seam.moved;
}

} // namespace

Seam smear_seam(TriangleSurface surface, std::span<const SeamEdge> seam_edges, double width) {
  Seam seam;
  const std::size_t old_points = surface.points.size();
  LiveSurface live(std::move(surface));
  RefineZone zone;
  const std::vector<std::uint32_t> on_seam = even_out(live, seam_edges, width, zone);
  std::vector<char> moves(live.point_count(), 0);
  move_points(live, on_seam, width, moves, seam);
  std::vector<std::uint32_t> numbers;
  seam.surface = live.take(&numbers);
  // Where points were near, edges may have been flipped.
  std::vector<char> is_changed(seam.surface.points.size(), 0);
  for (std::size_t point = 0; point < numbers.size(); ++point)
    if (numbers[point] != no_index)
      is_changed[numbers[point]] =
          point >= old_points || moves[point] || zone.coarseness[point] > 0.0f ? 1 : 0;
  for (std::uint32_t face = 0; face < seam.surface.faces.size(); ++face) {
    const Corners& corner = seam.surface.faces[face];
    if (is_changed[corner[0]] || is_changed[corner[1]] || is_changed[corner[2]])
      seam.changed.push_back(face);
  }
  return seam;
}

} // namespace nendo::deform
