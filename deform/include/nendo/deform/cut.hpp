#pragma once
// Cuts a closed model apart: by a plane, by the surface that a wire sweeps, or by a knife that is
// drawn through. Both sides are closed by cut faces. CUTTING.md says how, and what is guaranteed.

#include <cstdint>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// A plane without end. The normal may have any length but zero.
struct CutPlane {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
};

/// The ends of a straight wire at one moment.
struct WirePlace {
  Eigen::Vector3d from, to;
};

/// What a wire sweeps from its first place to its last, between its ends.
struct CutWire {
  std::vector<WirePlace> places;
};

struct CutOptions {
  double edge = 0.0; ///< length of the cut faces' edges; 0: the mean where the blade crosses
  std::string material = "cut";                      ///< its name
  Eigen::Vector4f colour{0.45F, 0.06F, 0.05F, 1.0F}; ///< linear
  const Points* rest =
      nullptr; ///< its places decide about triangles (triangles.hpp); null: the mesh's
};

/// A vertex that the cut made: at a fraction between two vertices, both of which come before it.
/// Inside cut faces there are none, and both are no_index.
struct CutVertex {
  std::uint32_t from, to;
  double part;
};

/// A model in parts, still as one mesh. Its first vertices are those of the model, with their
/// numbers and bits. Faces that the blade does not cross are the same as before.
struct CutModel {
  Mesh mesh;
  std::vector<CutVertex> added;              ///< the vertices behind the model's
  std::vector<std::uint32_t> part_of_vertex; ///< from 0; no_index for those without faces
  std::uint32_t parts = 0;                   ///< those that the model had before included
  std::size_t first_cut_face = 0;            ///< from here on, faces close the cut
  std::uint32_t loops = 0;                   ///< rims that were cut and closed on both sides
  std::uint32_t uncut_loops = 0;             ///< rims at which the blade does not go through
  std::uint32_t attempts = 1;
  double give = 0.0; ///< how far the blade was displaced, in model units, at most 1e-6 of the
                     ///< diagonal in the first attempt and three times as much in each further one
};

/// Cuts a model that is closed and two-manifold. Every part is so, and no cut face meets
/// another face but at shared edges and corners. New corners get texture coordinates and colours
/// from the edges that they lie on; cut faces get a material of their own, and planar texture
/// coordinates if the model has any. The same call gives the same bits. Allocates. Errors, which go
/// behind the model's name: bad_input (not closed, numbers too large), usage (a blade without
/// extent), failed (the blade does not go through, or the surface passes through itself there).
NENDO_API Result<CutModel> cut_model(const Mesh& mesh, const CutPlane& plane,
                                     const CutOptions& options = {});
NENDO_API Result<CutModel> cut_model(const Mesh& mesh, const CutWire& wire,
                                     const CutOptions& options = {});

/// Returns the parts as meshes of their own, in the order of their first vertices. Vertices and
/// faces keep their order. Allocates.
NENDO_API std::vector<Mesh> separate(const CutModel& model);

/// Does the same with any mesh: two vertices are of one part if edges lead from the one to the
/// other.
NENDO_API std::vector<Mesh> separate(const Mesh& mesh);

/// Returns the volume that a closed surface encloses, in cubic model units; negative if its faces
/// face inwards. Faces are taken as triangles.hpp says. Allocates.
NENDO_API double volume_of(const Mesh& mesh);

} // namespace nendo::deform
