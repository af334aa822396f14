#pragma once
// A mesh as joining and refining work on it: triangles, plain numbers, and all that the mesh's file
// says of points, corners and faces.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <nendo/deform/mesh.hpp>

#include "geometry/space.hpp"
#include "mesh/surface_mesh.hpp"
#include "mesh/texture_point.hpp"

namespace nendo::deform {

/// Indices into the lists of an Appearance, or no_index.
struct FaceLook {
  std::uint32_t material = no_index;
  std::uint32_t group = no_index;
  std::uint32_t object = no_index;
  bool operator==(const FaceLook&) const = default;
};

using Colour = std::array<float, 4>;

struct TriangleSurface {
  std::vector<SpacePoint> points;
  std::vector<Corners> faces;
  std::vector<FaceLook> looks;              ///< one for each face
  std::vector<Colour> colours;              ///< one for each point, or none at all
  std::vector<TexturePoint> texture_points; ///< none, if corners have none
  std::vector<Corners> face_texture;        ///< one per face, or none at all
  std::vector<SpacePoint> rest;     ///< where each point is before the hands, or none at all
  std::vector<VertexDetail> detail; ///< one for each point, or none at all

  /// Appends what these points have.
  void copy_points(std::span<const std::uint32_t> which);
  /// Leaves out what points and faces have that are gone, but for the faces' corners.
  void renumber_columns(const Renumbering& numbers);
};

/// Returns the volume that closed surfaces enclose: positive if they face outwards.
double volume_of(std::span<const SpacePoint> points, std::span<const Corners> faces);

/// Rounds points to the nearest floats, and returns these.
Eigen::Matrix3Xf round_points(std::span<SpacePoint> points);

} // namespace nendo::deform
