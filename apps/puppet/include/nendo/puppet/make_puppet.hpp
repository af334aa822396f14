#pragma once
// Generates a puppet file for a face model without one. It is a draft: the user checks it (`nendo
// puppet show --picture`) and corrects it in an editor.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::puppet {

// Landmarks of a face are found by the model's shape alone: the extremes of its profile, and the
// openings of mouth and eyes. The face must look along +z, with y up, and be symmetric about x = 0.

/// Landmarks of a mouth that can open: the path along the surface between its lips is much longer
/// than the straight one.
struct MouthPlaces {
  Eigen::Vector3d upper;  ///< the upper lip's foremost point on the midline
  Eigen::Vector3d slit;   ///< point between the lips
  Eigen::Vector3d lower;  ///< the lower lip's foremost point
  Eigen::Vector3d corner; ///< at x > 0
};

/// Landmarks of an open eye, at x > 0.
struct EyePlaces {
  /// Points on the lids' edges at a quarter, a half and three quarters of the eye's width, counted
  /// from the nose.
  std::array<Eigen::Vector3d, 3> upper;
  std::array<Eigen::Vector3d, 3> lower;
  double inner_x = 0.0;
  double outer_x = 0.0;
};

/// Points on the surface in model units; lateral ones are at x > 0.
struct FaceLandmarks {
  std::vector<bool> is_skin; ///< whether a vertex belongs to the part with the most vertices
  /// A length for scaling: from the eye line to the lip line on a human face.
  double unit = 1.0;
  Eigen::Vector3d nose;       ///< tip
  Eigen::Vector3d under_nose; ///< where the nose meets the upper lip
  Eigen::Vector3d chin;       ///< foremost point
  Eigen::Vector3d jaw;        ///< lower edge of the jaw
  Eigen::Vector3d jaw_side;
  Eigen::Vector3d cheek;
  Eigen::Vector3d brow_inner;
  Eigen::Vector3d brow_outer;
  std::optional<MouthPlaces> mouth;
  std::optional<EyePlaces> eye;
  std::optional<double> eyeball_front; ///< max z of the eyeball behind the lids

  std::size_t lone_vertices = 0; ///< no mirror image within 0.5 % of the diagonal
  double asymmetry = 1.0;        ///< median depth difference of the sides, as a multiple of `unit`
  bool is_symmetric() const noexcept { return asymmetry < 0.05; }
};

/// Error: bad_input (no faces, or no profile with a nose and a chin; the message says which).
/// Allocates.
NENDO_API Result<FaceLandmarks> find_face(const deform::Mesh& model);

struct MadePuppet {
  std::string text;               ///< the file's text, with comments that list the findings
  std::vector<std::string> found; ///< the findings, one per line
};

/// Places points on the face and adds the functions that these permit. Reduces functions that flip
/// triangles (RigCheck). `model_name` is the name of the model file, in the puppet file's folder.
/// Error: bad_input (find_face() finds no face, or points are too close). Takes about a second.
NENDO_API Result<MadePuppet> make_face_puppet(const deform::Mesh& model,
                                              std::string_view model_name);

} // namespace nendo::puppet
