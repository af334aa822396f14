#include "join/thin_plate.hpp"

#include <algorithm>

#include <Eigen/SparseCholesky>

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
      : numbers_(surface.point_count(), no_index) {
    for (const std::uint32_t point : free)
      number(point);
    const std::size_t free_count = points_.size();
    for (std::size_t at = 0; at < free_count; ++at)
      surface.visit_edges(points_[at], [&](std::uint32_t edge) { number(surface.to(edge)); });
    const std::size_t row_count = points_.size();
    for (std::size_t row = 0; row < row_count; ++row)
      add_row(surface, row);
    rows_.resize(static_cast<Eigen::Index>(row_count), static_cast<Eigen::Index>(points_.size()));
    rows_.setFromTriplets(entries_.begin(), entries_.end());
  }

  const Sparse& rows() const { return rows_; }
  Places places(const LiveSurface& surface) const {
    Places places(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t at = 0; at < points_.size(); ++at) {
      const SpacePoint& place = surface.point(points_[at]);
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
    surface.visit_edges(points_[row], [&](std::uint32_t edge) { sum += weight_of(edge); });
    entries_.emplace_back(static_cast<int>(row), static_cast<int>(row), 1.0);
    surface.visit_edges(points_[row], [&](std::uint32_t edge) {
      entries_.emplace_back(static_cast<int>(row), static_cast<int>(number(surface.to(edge))),
                            -weight_of(edge) / sum);
    });
  }
  std::uint32_t number(std::uint32_t point) {
    if (numbers_[point] == no_index) {
      numbers_[point] = static_cast<std::uint32_t>(points_.size());
      points_.push_back(point);
    }
    return numbers_[point];
  }
  std::vector<std::uint32_t> numbers_;
  std::vector<std::uint32_t> points_; ///< the free ones, rows that stay, and their neighbours
  std::vector<Eigen::Triplet<double>> entries_;
  Sparse rows_;
};

} // namespace

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

} // namespace nendo::deform
