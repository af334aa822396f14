#pragma once
// Finds the point of a model's surface that is nearest to a place, and walks from there. A walk
// never leaves the surface and never jumps, whatever the triangles are.

#include <array>
#include <optional>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::motions {

struct SurfaceTriangle {
  std::array<Eigen::Vector3d, 3> corners;
  std::array<Eigen::Vector3d, 3> normals;
};

/// Returns the triangle's point that is nearest to `place`, as weights of its corners. They sum to
/// 1, and none is negative.
std::array<double, 3> nearest_weights(const SurfaceTriangle& triangle,
                                      const Eigen::Vector3d& place) noexcept;

struct SurfacePoint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< outwards, unit; interpolated
};

/// The part of a model's surface, on the stage, that lies about a place.
class SurfacePatch {
public:
  /// Takes all triangles that are at most `margin_m` farther from `centre_m` than the nearest one.
  /// `normals` are the model's, by vertex. Allocates; makes one pass over the model.
  SurfacePatch(const deform::Mesh& model, const deform::Points& normals, double units_per_metre,
               const Eigen::Vector3d& centre_m, double margin_m);

  /// Returns the nearest point, or nullopt if the model has no triangles. The normal is zero if the
  /// triangle has no area.
  std::optional<SurfacePoint> nearest(const Eigen::Vector3d& to_m) const;

private:
  struct Ball {
    Eigen::Vector3d centre_m;
    double radius_m;
  };
  std::vector<SurfaceTriangle> triangles_;
  std::vector<Ball> balls_; ///< round each of them
};

/// Returns the way of a point that starts at the surface's nearest point to `start_m` and goes
/// `length_m` towards `direction`, as far as the surface leads there. Each step of at most `step_m`
/// goes along the tangent plane and then to the surface's nearest point, so that two neighbours are
/// never more than two steps apart. The first point is the start's. The way is empty if the patch
/// is.
std::vector<SurfacePoint> walk(const SurfacePatch& patch, const Eigen::Vector3d& start_m,
                               const Eigen::Vector3d& direction, double length_m, double step_m);

} // namespace nendo::motions
