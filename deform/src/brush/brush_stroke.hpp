#pragma once
// The brushes of a stroke: which start points have one, and their dabs along a piece of the way. A
// dab is what a brush does to the vertices within its radius while the fingertip goes a short way.
// Each vertex x is weighted by w(x) = psi(|x - c| / r), the paper's radial function about the dab's
// centre c, so that a dab ends as smoothly as a field.

#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/deform/brush.hpp>
#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/deform/vertex_mask.hpp>
#include <nendo/deform/wendland.hpp>

#include "field/block_evaluator.hpp"

namespace nendo::deform {

/// Lengths and places are in the units of the shape in blocks.
struct Dab {
  Brush brush = Brush::push;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 1.0; ///< > 0
  double way = 0.0;    ///< the fingertip's way, times the strength; the sign is the direction
};

/// Belongs to one thread. After the constructor nothing allocates or waits. A dab looks at the
/// bounds of all blocks, and at the triangles around each vertex within the radius.
class BrushDabs {
public:
  /// Allocates 32 bytes per vertex.
  BrushDabs(std::shared_ptr<const VertexRings> rings, Wendland kernel, double keep_volume,
            std::shared_ptr<const VertexMask> mask);

  /// Finds the moves of a dab. Returns false if no vertex is within reach, or the result might not
  /// be finite.
  bool find(const Dab& dab, const BoundedShape& shape) noexcept;
  /// Adds the moves to the shape, which may have changed meanwhile, with its bounds and stamps.
  /// Returns false, and changes nothing, if a move is not finite.
  bool write(BoundedShape& shape) const noexcept;

private:
  /// A vertex within the radius.
  struct Reached {
    std::uint32_t place = 0;
    float weight = 0.0F;                              ///< w, times the mask's
    Eigen::Vector3f normal = Eigen::Vector3f::Zero(); ///< area_normal()
    Eigen::Vector3f move = Eigen::Vector3f::Zero();
  };

  bool gather(const Dab& dab, const BoundedShape& shape) noexcept;
  bool find_plane(const BlockShape& shape) noexcept;
  void move_along_normals(double way) noexcept;
  void smooth(const Dab& dab, const BlockShape& shape) noexcept;
  void keep_volume() noexcept;
  Eigen::Vector3d pushed(const Eigen::Vector3d& u, double weight) const noexcept;
  template <class MoveOf>
  void move_each(const BlockShape& shape, const MoveOf& move_of) noexcept;

  std::shared_ptr<const VertexRings> rings_;
  Wendland kernel_;
  double keep_volume_;                               ///< CsrbfOptions::keep_volume, for Brush::push
  std::shared_ptr<const VertexMask> mask_;           ///< null: all are free
  std::vector<Reached> reached_;                     ///< in block order
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero(); ///< the middle of the reached surface
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero(); ///< its mean, of unit length
};

/// Belongs to one thread. After the constructor nothing allocates.
class BrushStroke {
public:
  static constexpr int max_dabs = 16; ///< limit for one start point on a piece
  /// Longer ways than this part of a radius are made in several dabs. None of push, twist, scale
  /// and flatten then folds space: the slope of a dab is below 1.
  static constexpr double longest_dab = 0.125;

  /// The layout must outlive it. options.brushes.rings must be of the layout.
  BrushStroke(const BlockLayout& layout, Eigen::Index points, const DeformerOptions& options);

  /// Lets all brushes continue their way (3 by points, model units). Returns whether that changed
  /// the shape.
  bool go(const Points& from, const Points& to, BoundedShape& shape) noexcept;

private:
  struct OfPoint {
    Eigen::Index point = 0;
    Eigen::Index image = -1; ///< the point that mirrors it; below 0: none
    Brush brush = Brush::push;
    double radius = 1.0; ///< in the layout's units
  };
  struct Way {
    Eigen::Vector3d from, to;
  };
  Way way_of(Eigen::Index point, const Points& from, const Points& to) const;
  bool go(const OfPoint& one, const Way& way, const Way& image, BoundedShape& shape) noexcept;

  const BlockLayout& layout_;
  std::vector<OfPoint> points_;
  double strength_;
  BrushDabs dabs_;
  std::optional<BrushDabs> images_; ///< those of mirrored points
};

/// Returns the start points that pull, of so many.
std::vector<Eigen::Index> pulling_points(const BrushOptions& brushes, Eigen::Index points);
/// Returns the supports of these start points alone, in their order.
Supports supports_of(const std::vector<Eigen::Index>& points, const Supports& supports);

} // namespace nendo::deform
