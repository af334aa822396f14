#pragma once
// The brushes of a stroke: which start points have one, and their dabs along a piece of the way.

#include <cstddef>
#include <optional>
#include <vector>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/vertex_blocks.hpp>

#include "brush/brush_dab.hpp"

namespace nendo::deform {

/// Belongs to one thread. After the constructor nothing allocates.
class BrushStroke {
public:
  static constexpr int max_dabs = 16; ///< of one start point on a piece
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
  /// A way from one place to another, and that of its image.
  struct Way {
    Eigen::Vector3d from, to;
  };
  Way way_of(Eigen::Index point, const Points& from, const Points& to) const;
  bool go(const OfPoint& one, const Way& way, const Way* image, BoundedShape& shape) noexcept;

  const BlockLayout& layout_;
  std::vector<OfPoint> points_;
  double strength_;
  BrushDabs dabs_;
  std::optional<BrushDabs> images_; ///< of mirrored points
};

/// Returns the start points that pull, of so many.
std::vector<Eigen::Index> pulling_points(const BrushOptions& brushes, Eigen::Index points);
/// Returns the supports of these start points alone, in their order.
Supports supports_of(const std::vector<Eigen::Index>& points, const Supports& supports);

} // namespace nendo::deform
