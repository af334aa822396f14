#include "join/thin_plate.hpp"

#include <algorithm>

namespace nendo::deform {
namespace {

constexpr int most_steps = 600;
constexpr double least_residue = 1e-5;
constexpr double shortest_edge = 1e-60; ///< keeps weights finite

/// Rows of the umbrella operator: at the free points and their neighbours.
class Umbrellas {
public:
  Umbrellas(const LiveSurface& surface, std::span<const std::uint32_t> free)
      : numbers_(surface.point_count(), no_entry) {
    for (const std::uint32_t point : free)
      number(point);
    free_count_ = points_.size();
    for (std::size_t at = 0; at < free_count_; ++at)
      surface.visit_edges(points_[at], [&](std::uint32_t edge) { number(surface.to(edge)); });
    row_count_ = points_.size();
    for (std::size_t at = 0; at < row_count_; ++at)
      add_row(surface, points_[at]);
    starts_.push_back(static_cast<std::uint32_t>(columns_.size()));
  }
  std::size_t free_count() const { return free_count_; }
  const std::vector<std::uint32_t>& points() const { return points_; }

  /// What each row's point is away from the mean of its neighbours.
  void apply(const std::vector<SpacePoint>& places, std::vector<SpacePoint>& rows) const {
    rows.resize(row_count_);
    for (std::size_t at = 0; at < row_count_; ++at) {
      SpacePoint sum{};
      for (std::uint32_t k = starts_[at]; k < starts_[at + 1]; ++k)
        sum = sum + weights_[k] * places[columns_[k]];
      rows[at] = places[at] - sum;
    }
  }
  /// The transposed operator; only the free points' entries are right.
  void apply_transposed(const std::vector<SpacePoint>& rows,
                        std::vector<SpacePoint>& places) const {
    places.assign(points_.size(), SpacePoint{});
    for (std::size_t at = 0; at < row_count_; ++at) {
      places[at] = places[at] + rows[at];
      for (std::uint32_t k = starts_[at]; k < starts_[at + 1]; ++k)
        places[columns_[k]] = places[columns_[k]] - weights_[k] * rows[at];
    }
    for (std::size_t at = free_count_; at < places.size(); ++at)
      places[at] = {};
  }

private:
  /// A neighbour counts the less the longer its edge is, so that uneven triangles pull nowhere.
  void add_row(const LiveSurface& surface, std::uint32_t point) {
    starts_.push_back(static_cast<std::uint32_t>(columns_.size()));
    double sum = 0.0;
    surface.visit_edges(point, [&](std::uint32_t edge) {
      columns_.push_back(number(surface.to(edge)));
      weights_.push_back(1.0 / std::max(surface.edge_length(edge), shortest_edge));
      sum += weights_.back();
    });
    for (std::size_t k = starts_.back(); k < weights_.size(); ++k)
      weights_[k] /= sum;
  }
  std::uint32_t number(std::uint32_t point) {
    if (numbers_[point] == no_entry) {
      numbers_[point] = static_cast<std::uint32_t>(points_.size());
      points_.push_back(point);
    }
    return numbers_[point];
  }
  std::vector<std::uint32_t> numbers_;
  std::vector<std::uint32_t> points_; ///< the free ones, rows that stay, and their neighbours
  std::vector<std::uint32_t> starts_, columns_;
  std::vector<double> weights_; ///< of columns_; those of a row have the sum 1
  std::size_t free_count_ = 0, row_count_ = 0;
};

double dot_of(const std::vector<SpacePoint>& a, const std::vector<SpacePoint>& b,
              std::size_t count) {
  double sum = 0.0;
  for (std::size_t at = 0; at < count; ++at)
    sum += dot(a[at], b[at]);
  return sum;
}

} // namespace

std::vector<SpacePoint> thin_plate(const LiveSurface& surface,
                                   std::span<const std::uint32_t> free) {
  const Umbrellas umbrellas(surface, free);
  std::vector<SpacePoint> places;
  places.reserve(umbrellas.points().size());
  for (const std::uint32_t point : umbrellas.points())
    places.push_back(surface.point(point));
  const std::size_t count = umbrellas.free_count();
  std::vector<SpacePoint> rows, residue, way(places.size()), image;
  umbrellas.apply(places, rows);
  umbrellas.apply_transposed(rows, residue);
  for (std::size_t at = 0; at < count; ++at)
    way[at] = residue[at] = -1.0 * residue[at];
  double square = dot_of(residue, residue, count);
  const double enough = least_residue * least_residue * square;
  for (int step = 0; step < most_steps && square > enough; ++step) {
    umbrellas.apply(way, rows);
    umbrellas.apply_transposed(rows, image);
    const double curvature = dot_of(way, image, count);
    if (!(curvature > 0.0)) break;
    const double reach = square / curvature;
    for (std::size_t at = 0; at < count; ++at) {
      places[at] = places[at] + reach * way[at];
      residue[at] = residue[at] - reach * image[at];
    }
    const double next = dot_of(residue, residue, count);
    for (std::size_t at = 0; at < count; ++at)
      way[at] = residue[at] + (next / square) * way[at];
    square = next;
  }
  places.resize(count);
  return places;
}

} // namespace nendo::deform
