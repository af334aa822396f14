#pragma once
// A CSRBF field whose distances are measured along the surface. Its radial functions are computed
// once per vertex, on the surface at rest: s(x) = sum_j psi(d_j(x) / r_j) c_j, with d_j the
// distance along the surface from start point j. The coefficients solve A c = v, with A the
// functions at the start points and v the control vectors, so that s is linear in them.
//
// Wendland's functions are positive definite in space, but no theorem states this for distances
// along a surface, or for one radius per column. So A is factorised with pivoting, and its
// condition number, which never changes, is checked when the field is made.

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
  SurfacePosition position;
  double radius = 1.0; ///< along the surface, model units, > 0
  std::string name{};  ///< its name in errors; empty: its number
  /// Replaces `radius` unless empty. The point's function is then the weighted mean of the
  /// functions with these radii, so that it has a narrow peak and a wide base.
  std::vector<Support> mix{};
};

/// Vertices that no function reaches along the surface, because they belong to another part of it.
struct FollowingPart {
  std::vector<std::uint32_t> vertices;
  /// The start points that the vertices follow. Empty: each vertex moves like the nearest vertex
  /// that the functions reach.
  std::vector<Eigen::Index> points;
  /// True: the part follows the points by an affine map, which includes rotations. False: each
  /// vertex moves by the mean displacement of the points, weighted by nearness.
  bool is_affine = true;
};

/// The displacement of a shape by a SurfaceField, for code that computes this shape elsewhere: each
/// vertex moves by the sum of its terms, each a value times a vector.
struct SurfaceMove {
  std::uint64_t field = 0;    ///< SurfaceField::number(); 0: no displacement along the surface
  std::uint32_t count = 0;    ///< SurfaceField::vector_count()
  Eigen::Matrix3Xf vectors{}; ///< in block units; may have more than `count` columns

  void clear() noexcept { field = count = 0; }
};

struct SurfaceSetup {
  std::vector<SurfacePoint> points;
  Wendland kernel = Wendland::c2;
  std::vector<FollowingPart> parts{};
  /// Weight of each vertex, 0 to 1; empty: all 1. A vertex of weight 0 does not move, bit for bit.
  Eigen::VectorXd mask{};
};

class NENDO_API SurfaceField {
public:
  /// Above this condition number, control vectors of a millimetre would need coefficients of
  /// metres.
  static constexpr double max_condition = 1e4;

  /// Computes all functions, by shortest paths from each point. The layout must be the mesh's.
  /// Error: bad_input (two points are too close for their radii, so that the condition number
  /// exceeds max_condition; the error names them). Allocates.
  static Result<std::shared_ptr<const SurfaceField>>
  make(const Mesh& mesh, const BlockLayout& layout, const SurfaceSetup& setup);

  Eigen::Index point_count() const noexcept { return inverse_.rows(); }
  double condition() const noexcept { return condition_; } ///< condition number of A in the 1-norm
  /// Returns the weight of each control vector at each vertex: #points by #vertices. Allocates.
  Eigen::MatrixXf weights() const;

  /// An id that is unique in the process. Never 0.
  std::uint64_t number() const noexcept { return number_; }
  /// Number of vectors of a SurfaceMove: the columns of Coefficients::all that any vertex uses.
  std::size_t vector_count() const noexcept { return columns_.size(); }
  /// The terms that displace() sums at the vertices, in block order. Vertex k has the terms t from
  /// starts[k] to starts[k + 1] - 1: values[t] times vector of_vector[t] of a SurfaceMove.
  struct Terms {
    std::vector<std::uint32_t> starts; ///< #vertices + 1
    std::vector<std::uint32_t> of_vector;
    std::vector<float> values;
  };
  /// Allocates.
  Terms terms() const;

  /// The coefficients of one tick.
  struct Coefficients {
    explicit Coefficients(Eigen::Index points);
    Eigen::Matrix3Xd of_functions; ///< c
    Eigen::Matrix3Xf all;          ///< c, then v, which the affine maps use; in block units
  };
  /// Computes the coefficients of control vectors (3 by point_count(), model units). Does not
  /// allocate.
  void solve(const Points& vectors, Coefficients& coefficients) const noexcept;
  /// Writes to = from + s, block by block, where s is not 0, and copies the other blocks where they
  /// differ. Does not allocate.
  void displace(const Coefficients& by, const BlockShape& from, BlockShape& to) const noexcept;
  /// Writes the displacement by displace() with these coefficients. Allocates only if `move` is too
  /// small.
  void write_move(const Coefficients& by, SurfaceMove& move) const;
  bool reaches(std::size_t block) const noexcept { return starts_[block] < starts_[block + 1]; }

private:
  /// The values of a function in a block.
  struct alignas(64) Entry {
    std::array<float, block_size> values{};
    std::uint32_t column = 0; ///< column of Coefficients::all
  };

  friend class SurfaceFieldBuilder;
  SurfaceField() = default;

  Eigen::MatrixXd inverse_; ///< the inverse of A
  double condition_ = 1.0;
  double unit_ = 1.0;
  std::uint64_t number_ = 0;
  std::vector<std::uint32_t> columns_; ///< columns of Coefficients::all that any vertex uses
  std::vector<std::uint32_t> order_;   ///< BlockLayout::order()
  std::vector<std::size_t> starts_;    ///< the first entry of each block
  std::vector<Entry> entries_;
};

} // namespace nendo::deform
