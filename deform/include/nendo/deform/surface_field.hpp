#pragma once
// A CSRBF field whose distances are measured along the surface. Its radial functions are computed
// once, vertex by vertex, where the surface is at rest: s(x) = sum_j psi(d_j(x) / r_j) c_j, with
// d_j the distance along the surface from start point j. The coefficients solve A c = v, with A the
// functions at the start points and v the control vectors, so that s is linear in them.
//
// Wendland's functions are positive definite in space, and no theorem says so of distances along a
// surface, nor of a radius for each column. So A is factored with pivoting, and its condition,
// which never changes, is looked at when the field is made.

#include <memory>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/supports.hpp>
#include <nendo/deform/surface_graph.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/deform/wendland.hpp>

namespace nendo::deform {

struct SurfacePoint {
  SurfacePlace place;
  double radius = 1.0; ///< along the surface, model units, > 0
  std::string name{};  ///< its name in errors; empty: its number
  /// In place of `radius`, unless it is empty. The point's function is then the weighted mean of
  /// those of these radii, so that it is narrow at the top and wide at the foot.
  std::vector<Support> mix{};
};

/// Vertices that no function reaches along the surface, because they belong to another part of it.
struct FollowingPart {
  std::vector<std::uint32_t> vertices;
  /// The start points that they follow. Empty: each vertex moves as the nearest one of the surface
  /// that the functions reach.
  std::vector<Eigen::Index> points;
  /// By an affine map: where the points turn, the part turns. Otherwise each vertex moves as the
  /// mean of the points, weighted by nearness.
  bool is_affine = true;
};

/// What a SurfaceField did to a shape, for code that makes that shape elsewhere: each vertex moved
/// by the sum of its terms, each of them a value times a vector.
struct SurfaceMove {
  std::uint64_t field = 0;    ///< SurfaceField::number(); 0: nothing was moved along the surface
  std::uint32_t count = 0;    ///< SurfaceField::vector_count()
  Eigen::Matrix3Xf vectors{}; ///< in blocks' units; may be larger than `count`

  void clear() noexcept { field = count = 0; }
};

struct SurfaceSetup {
  std::vector<SurfacePoint> points;
  Wendland kernel = Wendland::c2;
  std::vector<FollowingPart> parts{};
  /// How far each vertex follows, 0 to 1; empty: all follow. 0 leaves a vertex alone, bit for bit.
  Eigen::VectorXd mask{};
};

class NENDO_API SurfaceField {
public:
  /// Above it, control vectors of a millimetre would need coefficients of metres.
  static constexpr double max_condition = 1e4;

  /// Computes all functions: a shortest way for each point. The layout must be the mesh's. Error:
  /// bad_input (two points are so near to each other, for their radii, that the condition is above
  /// max_condition; it names them). Allocates.
  static Result<std::shared_ptr<const SurfaceField>>
  make(const Mesh& mesh, const BlockLayout& layout, const SurfaceSetup& setup);

  Eigen::Index point_count() const noexcept { return inverse_.rows(); }
  double condition() const noexcept { return condition_; } ///< that of A, in the 1-norm
  /// Returns what each vertex gets of each control vector: #points by #vertices. Allocates.
  Eigen::MatrixXf weights() const;

  /// Tells this field from every other one of the process. Never 0.
  std::uint64_t number() const noexcept { return number_; }
  /// How many vectors a SurfaceMove has: the columns of Coefficients::all that any vertex takes.
  std::size_t vector_count() const noexcept { return columns_.size(); }
  /// What displace() adds up at the vertices in block order. Those of vertex k are the terms
  /// starts[k] to starts[k + 1] - 1: values[t] times vector of_vector[t] of a SurfaceMove.
  struct Terms {
    std::vector<std::uint32_t> starts; ///< #vertices + 1
    std::vector<std::uint32_t> of_vector;
    std::vector<float> values;
  };
  /// Returns the terms. Allocates.
  Terms terms() const;

  /// What a tick needs.
  struct Coefficients {
    explicit Coefficients(Eigen::Index points);
    Eigen::Matrix3Xd of_functions; ///< c
    Eigen::Matrix3Xf all; ///< c, and behind it v, which the affine maps take; in blocks' units
  };
  /// Computes the coefficients of control vectors (3 by point_count(), model units). Does not
  /// allocate.
  void solve(const Points& vectors, Coefficients& coefficients) const noexcept;
  /// Writes to = from + s, block by block, where s is not 0, and copies the other blocks where they
  /// differ. Does not allocate.
  void displace(const Coefficients& by, const BlockShape& from, BlockShape& to) const noexcept;
  /// Writes what displace() does with these coefficients. Allocates only if `move` is too small.
  void write_move(const Coefficients& by, SurfaceMove& move) const;
  bool reaches(std::size_t block) const noexcept { return starts_[block] < starts_[block + 1]; }

private:
  /// A function in a block.
  struct alignas(64) Entry {
    std::array<float, block_size> values{};
    std::uint32_t column = 0; ///< in Coefficients::all
  };

  friend class SurfaceFieldBuilder;
  SurfaceField() = default;

  Eigen::MatrixXd inverse_; ///< the inverse of A
  double condition_ = 1.0;
  double unit_ = 1.0;
  std::uint64_t number_ = 0;
  std::vector<std::uint32_t> columns_; ///< those of Coefficients::all that any vertex takes
  std::vector<std::uint32_t> order_;   ///< BlockLayout::order()
  std::vector<std::size_t> starts_;    ///< the first entry of each block
  std::vector<Entry> entries_;
};

} // namespace nendo::deform
