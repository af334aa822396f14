#pragma once
// Writes a puppet file for a face without a description. It is a beginning: a person looks
// at it (`nendo puppet show --picture`) and corrects it in an editor.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::puppet {

// The places of a face are found by the model's shape alone: the extremes of its profile, and the
// openings of mouth and eyes. The face must look along +z, with y up, and be symmetric about x = 0.

/// Of a mouth that can open: between its lips, the way along the surface is much longer than that
/// through the air.
struct MouthPlaces {
  Eigen::Vector3d upper;  ///< the upper lip's most forward place in the middle
  Eigen::Vector3d slit;   ///< between the lips
  Eigen::Vector3d lower;  ///< the lower lip's most forward place
  Eigen::Vector3d corner; ///< at x > 0
};

/// Of an eye that is open, at x > 0.
struct EyePlaces {
  /// The edges of the lids at a quarter, a half and three quarters of the eye's width, from the
  /// nose.
  std::array<Eigen::Vector3d, 3> upper;
  std::array<Eigen::Vector3d, 3> lower;
  double inner_x = 0.0;
  double outer_x = 0.0;
};

/// Places on the surface in model units; those of one side are at x > 0.
struct FaceLandmarks {
  std::vector<bool> is_skin; ///< whether a vertex belongs to the part with the most vertices
  /// A length to scale by: from the line of the eyes to that of the lips on a face as people have.
  double unit = 1.0;
  Eigen::Vector3d nose;       ///< tip
  Eigen::Vector3d under_nose; ///< where the nose meets the upper lip
  Eigen::Vector3d chin;       ///< its most forward place
  Eigen::Vector3d jaw;        ///< its lower edge
  Eigen::Vector3d jaw_side;
  Eigen::Vector3d cheek;
  Eigen::Vector3d brow_inner;
  Eigen::Vector3d brow_outer;
  std::optional<MouthPlaces> mouth;
  std::optional<EyePlaces> eye;
  std::optional<double> eyeball_front; ///< the greatest z of a ball behind the lids

  std::size_t lone_vertices =
      0;                  ///< without one at their mirror image, within 0.5 % of the diagonal
  double asymmetry = 1.0; ///< the median difference in depth of the sides, in units
  bool is_symmetric() const noexcept { return asymmetry < 0.05; }
};

/// Error: bad_input (no faces; or no profile with a nose and a chin; it says which). Allocates.
NENDO_API Result<FaceLandmarks> find_face(const deform::Mesh& model);

struct MadePuppet {
  std::string text;               ///< the file's text, with comments that say what was found
  std::vector<std::string> found; ///< the same, a line each
};

/// Places points on the face and gives it the functions that these allow. Functions whose triangles
/// turn over (RigCheck) are made to move less. `model_name` is the file's name, beside which the
/// puppet's file will be. Error: bad_input (find_face() finds no face, or the points are too
/// near to each other). Takes about a second.
NENDO_API Result<MadePuppet> make_face_puppet(const deform::Mesh& model,
                                              std::string_view model_name);

} // namespace nendo::puppet
