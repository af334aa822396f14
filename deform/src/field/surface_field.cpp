#include <nendo/deform/surface_field.hpp>

#include <algorithm>
#include <cassert>
#include <limits>

#include "solver/decompositions.hpp"

namespace nendo::deform {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double norm_1(const MatrixXd& matrix) {
  return matrix.cwiseAbs().colwise().sum().maxCoeff();
}

/// Rows are places in the surface, columns the functions: a function's value is interpolated within
/// a face as the place itself is.
Eigen::RowVectorXd at_place(const MatrixXd& values, const SurfacePosition& place) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(values.cols());
  for (std::size_t k = 0; k < place.corners.size(); ++k)
    row += place.weights[k] * values.row(place.corners[k]);
  return row;
}

/// A point's radii, with weights whose sum is 1.
std::vector<Support> radii_of(const SurfacePoint& point) {
  if (point.mix.empty()) return {Support{point.radius, 1.0}};
  std::vector<Support> radii = point.mix;
  double sum = 0.0;
  for (const Support& support : radii)
    sum += support.weight;
  for (Support& support : radii)
    support.weight /= sum;
  return radii;
}

double largest_of(const std::vector<Support>& radii) {
  double largest = 0.0;
  for (const Support& support : radii)
    largest = std::max(largest, support.radius);
  return largest;
}

/// The functions at the mesh's vertices: #vertices by #points.
MatrixXd functions_on(const Mesh& mesh, const SurfaceSetup& setup) {
  const SurfaceGraph graph(mesh);
  MatrixXd values(mesh.vertices.cols(), static_cast<Index>(setup.points.size()));
  for (Index j = 0; j < values.cols(); ++j) {
    const SurfacePoint& point = setup.points[static_cast<std::size_t>(j)];
    const std::vector<Support> radii = radii_of(point);
    const VectorXd distances = graph.distances(point.position, largest_of(radii));
    for (Index v = 0; v < values.rows(); ++v) {
      values(v, j) = 0.0;
      for (const Support& support : radii)
        values(v, j) += support.weight * wendland(setup.kernel, distances[v] / support.radius);
    }
  }
  return values;
}

/// The two points whose rows are the most alike.
std::pair<Index, Index> nearest_pair(const MatrixXd& functions) {
  std::pair<Index, Index> pair{0, 0};
  double least = std::numeric_limits<double>::infinity();
  for (Index a = 0; a < functions.rows(); ++a)
    for (Index b = a + 1; b < functions.rows(); ++b) {
      const double apart = (functions.row(a) - functions.row(b)).norm();
      if (apart < least) {
        least = apart;
        pair = {a, b};
      }
    }
  return pair;
}

std::string name_of(const SurfaceSetup& setup, Index point) {
  const std::string& name = setup.points[static_cast<std::size_t>(point)].name;
  return name.empty() ? std::to_string(point) : name;
}

/// Where each vertex gets what it gets of the points: the nearest vertex that a function reaches.
std::uint32_t nearest_reached(const Mesh& mesh, const std::vector<std::uint32_t>& reached,
                              std::uint32_t vertex) {
  const auto squared = [&](std::uint32_t other) {
    return (mesh.vertices.col(other) - mesh.vertices.col(vertex)).squaredNorm();
  };
  return *std::min_element(
      reached.begin(), reached.end(),
      [&](std::uint32_t one, std::uint32_t other) { return squared(one) < squared(other); });
}

/// The coordinates of the vertex among those points: the least whose sum is 1 and whose weighted
/// mean is its place, so that an affine motion of the points is one of the vertex. They are the
/// same for all, but for X^T (X X^T)^+ y, X being the points and y the vertex about the points'
/// middle.
VectorXd affine_coordinates(const Mesh& mesh, const SurfaceSetup& setup,
                            const std::vector<Index>& points, std::uint32_t vertex) {
  constexpr double min_spread = 1e-6; // of the widest one; the points are flat along less
  const auto count = static_cast<Index>(points.size());
  Points about(3, count);
  for (Index k = 0; k < count; ++k)
    about.col(k) =
        setup.points[static_cast<std::size_t>(points[static_cast<std::size_t>(k)])].position.in(
            mesh.vertices);
  const Eigen::Vector3d middle = about.rowwise().mean();
  about.colwise() -= middle;
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (Index k = 0; k < count; ++k)
    gram += about.col(k) * about.col(k).transpose();
  const EigenPairs<3> spreads = eigen3(gram);
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  for (Index k = 0; k < 3; ++k) {
    const double square = spreads.values[k];
    if (!(square > min_spread * min_spread * spreads.values[2])) continue;
    const Eigen::Vector3d axis = spreads.vectors.col(k);
    way += axis.dot(mesh.vertices.col(vertex) - middle) / square * axis;
  }
  VectorXd coordinates(count);
  for (Index k = 0; k < count; ++k)
    coordinates[k] = 1.0 / static_cast<double>(count) + about.col(k).dot(way);
  return coordinates;
}

/// Shepard's weights (1968): the inverse squares of the distances, whose sum is made 1.
VectorXd weights_by_nearness(const Mesh& mesh, const SurfaceSetup& setup,
                             const std::vector<Index>& points, std::uint32_t vertex) {
  constexpr double least = 1e-12; // of the squared radius; a vertex may be where a point is
  VectorXd weights(static_cast<Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SurfacePoint& point = setup.points[static_cast<std::size_t>(points[k])];
    const double radius = largest_of(radii_of(point));
    const double squared =
        (point.position.in(mesh.vertices) - mesh.vertices.col(vertex)).squaredNorm();
    weights[static_cast<Index>(k)] = 1.0 / (squared + least * radius * radius);
  }
  return weights / weights.sum();
}

} // namespace

SurfaceField::Coefficients::Coefficients(Index points)
    : of_functions(Eigen::Matrix3Xd::Zero(3, points)), all(Eigen::Matrix3Xf::Zero(3, 2 * points)) {}

/// Builds the blocks of a field.
class SurfaceFieldBuilder {
public:
  SurfaceFieldBuilder(const Mesh& mesh, const BlockLayout& layout, const SurfaceSetup& setup)
      : mesh_(mesh), setup_(setup), places_(layout.places()), functions_(functions_on(mesh, setup)),
        blocks_(layout.block_count()) {}

  MatrixXd at_points() const {
    MatrixXd rows(functions_.cols(), functions_.cols());
    for (Index i = 0; i < rows.rows(); ++i)
      rows.row(i) = at_place(functions_, setup_.points[static_cast<std::size_t>(i)].position);
    return rows;
  }

  void fill() {
    for (Index v = 0; v < functions_.rows(); ++v) {
      if (!functions_.row(v).isZero(0.0)) reached_.push_back(static_cast<std::uint32_t>(v));
      add_functions(static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(v));
    }
    for (const FollowingPart& part : setup_.parts)
      for (const std::uint32_t vertex : part.vertices)
        if (functions_.row(vertex).isZero(0.0)) add_following(part, vertex);
  }

  void write(SurfaceField& field) const {
    field.starts_.assign(1, 0);
    for (const auto& block : blocks_) {
      field.entries_.insert(field.entries_.end(), block.begin(), block.end());
      field.starts_.push_back(field.entries_.size());
    }
  }

private:
  using Entry = SurfaceField::Entry;

  double mask(std::uint32_t vertex) const {
    return setup_.mask.size() == 0 ? 1.0 : setup_.mask[vertex];
  }
  void add(std::uint32_t vertex, Index column, double value) {
    const auto part = static_cast<float>(value * mask(vertex));
    if (part == 0.0F) return;
    const std::size_t place = places_[vertex];
    auto& block = blocks_[place / block_size];
    const auto number = static_cast<std::uint32_t>(column);
    auto found = std::find_if(block.begin(), block.end(),
                              [&](const Entry& entry) { return entry.column == number; });
    if (found == block.end()) found = block.insert(block.end(), Entry{{}, number});
    found->values[place % block_size] = part;
  }
  void add_functions(std::uint32_t vertex, std::uint32_t as) {
    for (Index j = 0; j < functions_.cols(); ++j)
      add(vertex, j, functions_(as, j));
  }
  void add_following(const FollowingPart& part, std::uint32_t vertex) {
    if (part.points.empty()) {
      if (!reached_.empty()) add_functions(vertex, nearest_reached(mesh_, reached_, vertex));
      return;
    }
    const VectorXd coordinates = part.is_affine
                                     ? affine_coordinates(mesh_, setup_, part.points, vertex)
                                     : weights_by_nearness(mesh_, setup_, part.points, vertex);
    for (std::size_t k = 0; k < part.points.size(); ++k)
      add(vertex, functions_.cols() + part.points[k], coordinates[static_cast<Index>(k)]);
  }

  const Mesh& mesh_;
  const SurfaceSetup& setup_;
  std::vector<std::uint32_t> places_;
  MatrixXd functions_;
  std::vector<std::uint32_t> reached_; ///< along the surface
  std::vector<std::vector<Entry>> blocks_;
};

Result<std::shared_ptr<const SurfaceField>>
SurfaceField::make(const Mesh& mesh, const BlockLayout& layout, const SurfaceSetup& setup) {
  SurfaceFieldBuilder builder(mesh, layout, setup);
  std::shared_ptr<SurfaceField> field(new SurfaceField);
  const MatrixXd functions = builder.at_points();
  field->inverse_ = inverse_of(functions);
  field->condition_ = norm_1(functions) * norm_1(field->inverse_);
  if (!(field->condition_ <= max_condition)) { // also where it is not a number
    const auto [one, other] = nearest_pair(functions);
    return Error{Errc::bad_input,
                 "points " + name_of(setup, one) + " and " + name_of(setup, other) +
                     " are too near to each other for their radii; move one away or make both "
                     "radii smaller"};
  }
  builder.fill();
  builder.write(*field);
  for (const Entry& entry : field->entries_)
    field->columns_.push_back(entry.column);
  std::sort(field->columns_.begin(), field->columns_.end());
  field->columns_.erase(std::unique(field->columns_.begin(), field->columns_.end()),
                        field->columns_.end());
  field->number_ = BlockShape::new_stamp();
  field->unit_ = layout.unit();
  field->order_ = layout.order();
  return std::shared_ptr<const SurfaceField>(std::move(field));
}

Eigen::MatrixXf SurfaceField::weights() const {
  const Index points = point_count();
  Eigen::MatrixXf all = Eigen::MatrixXf::Zero(points, static_cast<Index>(order_.size()));
  for (std::size_t block = 0; block + 1 < starts_.size(); ++block) {
    for (std::size_t at = starts_[block]; at < starts_[block + 1]; ++at) {
      const Entry& entry = entries_[at];
      const Index column = entry.column;
      for (std::size_t lane = 0; lane < block_size; ++lane) {
        const std::size_t place = block * block_size + lane;
        if (entry.values[lane] == 0.0F || place >= order_.size()) continue;
        const auto vertex = static_cast<Index>(order_[place]);
        if (column < points)
          all.col(vertex) += entry.values[lane] * inverse_.row(column).transpose().cast<float>();
        else
          all(column - points, vertex) += entry.values[lane];
      }
    }
  }
  return all;
}

SurfaceField::Terms SurfaceField::terms() const {
  std::vector<std::uint32_t> vector_of(static_cast<std::size_t>(2 * point_count()));
  for (std::uint32_t at = 0; at < columns_.size(); ++at)
    vector_of[columns_[at]] = at;
  Terms terms;
  terms.starts.push_back(0);
  for (std::size_t place = 0; place < order_.size(); ++place) {
    const std::size_t block = place / block_size;
    for (std::size_t at = starts_[block]; at < starts_[block + 1]; ++at) {
      const float value = entries_[at].values[place % block_size];
      if (value == 0.0F) continue;
      terms.of_vector.push_back(vector_of[entries_[at].column]);
      terms.values.push_back(value);
    }
    terms.starts.push_back(static_cast<std::uint32_t>(terms.values.size()));
  }
  return terms;
}

void SurfaceField::write_move(const Coefficients& by, SurfaceMove& move) const {
  move.field = number_;
  move.count = static_cast<std::uint32_t>(columns_.size());
  if (move.vectors.cols() < static_cast<Index>(columns_.size()))
    move.vectors.resize(3, static_cast<Index>(columns_.size()));
  for (std::size_t at = 0; at < columns_.size(); ++at)
    move.vectors.col(static_cast<Index>(at)) = by.all.col(columns_[at]);
}

void SurfaceField::solve(const Points& vectors, Coefficients& coefficients) const noexcept {
  assert(vectors.cols() == point_count() && coefficients.of_functions.cols() == point_count());
  coefficients.of_functions.noalias() = vectors.lazyProduct(inverse_.transpose());
  const double scale = 1.0 / unit_;
  for (Index j = 0; j < vectors.cols(); ++j) {
    coefficients.all.col(j) = (scale * coefficients.of_functions.col(j)).cast<float>();
    coefficients.all.col(vectors.cols() + j) = (scale * vectors.col(j)).cast<float>();
  }
}

void SurfaceField::displace(const Coefficients& by, const BlockShape& from,
                            BlockShape& to) const noexcept {
  for (std::size_t block = 0; block + 1 < starts_.size(); ++block) {
    bool moves = false;
    for (std::size_t at = starts_[block]; at < starts_[block + 1] && !moves; ++at)
      moves = !by.all.col(entries_[at].column).isZero(0.0F);
    if (!moves) {
      to.follow(from, block);
      continue;
    }
    VertexBlock moved = from[block];
    for (std::size_t at = starts_[block]; at < starts_[block + 1]; ++at) {
      const Entry& entry = entries_[at];
      const Eigen::Vector3f vector = by.all.col(entry.column);
      for (std::size_t lane = 0; lane < block_size; ++lane) {
        moved.x[lane] += vector.x() * entry.values[lane];
        moved.y[lane] += vector.y() * entry.values[lane];
        moved.z[lane] += vector.z() * entry.values[lane];
      }
    }
    to.data()[block] = moved;
    to.set_stamp(block, BlockShape::new_stamp());
  }
}

} // namespace nendo::deform
