#pragma once
// A point that moves on a model's surface: the nearest one to a place, and a walk from there that
// never leaves the surface and never jumps, whatever the triangles.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::flow {

/// A corner's normal is its vertex's. Polygons are fans from their first corner.
struct SurfaceTriangle {
  std::array<Eigen::Vector3d, 3> corners;
  std::array<Eigen::Vector3d, 3> normals;
};

/// Of a triangle, by the weights of its corners; they sum to 1, none is negative.
std::array<double, 3> nearest_weights(const SurfaceTriangle& triangle,
                                      const Eigen::Vector3d& place) noexcept;

struct SurfacePoint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< outwards, unit; interpolated
};

/// The part of a model's surface, on the stage, that lies about a place.
class SurfacePatch {
public:
  /// All triangles nearer to `centre_m` than `margin_m` beyond the nearest one. `normals` are the
  /// model's, by vertex. Allocates; one pass over the model.
  SurfacePatch(const deform::Mesh& model, const deform::Points& normals, double units_per_metre,
               const Eigen::Vector3d& centre_m, double margin_m);

  /// Nullopt if the model has no triangles. The normal is zero if the triangle has no area.
  std::optional<SurfacePoint> nearest(const Eigen::Vector3d& to_m) const;

private:
  struct Ball {
    Eigen::Vector3d centre_m;
    double radius_m;
  };
  std::vector<SurfaceTriangle> triangles_;
  std::vector<Ball> balls_; ///< round each of them
};

/// The way of a point that was nearest to `start_m` and goes `length_m` towards `direction`, as far
/// as the surface leads there, in steps of at most `step_m`: each goes along the tangent plane and
/// back to the surface's nearest point, so that two neighbours are never more than two steps apart.
/// The first is the start's; empty if the patch is.
std::vector<SurfacePoint> walk(const SurfacePatch& patch, const Eigen::Vector3d& start_m,
                               const Eigen::Vector3d& direction, double length_m, double step_m);

} // namespace nendo::flow
