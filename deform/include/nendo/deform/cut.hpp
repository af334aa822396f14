#pragma once
// Cuts a closed model into parts: by a plane, by the surface that a wire sweeps, or by a knife
// stroke. Cut faces close both sides. CUTTING.md describes the algorithm and its guarantees.

#include <cstdint>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// An infinite plane. The normal may have any length except zero.
struct CutPlane {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
};

/// The end points of a straight wire at one time.
struct WirePlace {
  Eigen::Vector3d from, to;
};

/// The surface that a wire sweeps from its first position to its last.
struct CutWire {
  std::vector<WirePlace> places;
};

struct CutOptions {
  double edge = 0.0; ///< edge length in the cut faces; 0: mean length of the crossed edges
  std::string material = "cut";                      ///< name of the cut faces' material
  Eigen::Vector4f colour{0.45F, 0.06F, 0.05F, 1.0F}; ///< linear
  const Points* rest =
      nullptr; ///< positions that determine triangles (triangles.hpp); null: the mesh's
};

/// A vertex that the cut added: interpolated, by the fraction `part`, between two previous
/// vertices. For a vertex inside a cut face, both indices are no_index.
struct CutVertex {
  std::uint32_t from, to;
  double part;
};

/// A model cut into parts, still as one mesh. Its first vertices are those of the model, with their
/// indices and bits. Faces that the blade does not cross are unchanged.
struct CutModel {
  Mesh mesh;
  std::vector<CutVertex> added;              ///< the vertices after those of the model
  std::vector<std::uint32_t> part_of_vertex; ///< from 0; no_index: vertex without faces
  std::uint32_t parts = 0;                   ///< includes parts that were separate before the cut
  std::size_t first_cut_face = 0;            ///< index of the first face that closes the cut
  std::uint32_t loops = 0;       ///< intersection loops that were cut and closed on both sides
  std::uint32_t uncut_loops = 0; ///< intersection loops where the blade does not cut through
  std::uint32_t attempts = 1;
  /// Displacement of the blade, in model units: at most 1e-6 of the diagonal in the first attempt,
  /// and three times the previous limit in each further one.
  double blade_offset = 0.0;
};

/// Cuts a closed two-manifold model. Every part is closed and two-manifold, and cut faces touch
/// other faces only at shared edges and corners. New corners get interpolated texture coordinates
/// and colours of their edges; cut faces get their own material, and planar texture coordinates if
/// the model has any. Deterministic to the bit. Allocates. Errors, to be appended to the model's
/// name: bad_input (not closed, coordinates too large), usage (a blade without extent), failed (the
/// blade does not cut through, or the surface intersects itself there).
NENDO_API Result<CutModel> cut_model(const Mesh& mesh, const CutPlane& plane,
                                     const CutOptions& options = {});
NENDO_API Result<CutModel> cut_model(const Mesh& mesh, const CutWire& wire,
                                     const CutOptions& options = {});

/// Returns the parts as separate meshes, ordered by first vertex. Vertices and faces keep their
/// order. Allocates.
NENDO_API std::vector<Mesh> separate(const CutModel& model);

/// Does the same for any mesh. Its parts are its edge-connected components.
NENDO_API std::vector<Mesh> separate(const Mesh& mesh);

/// Returns the volume that a closed surface encloses, in cubic model units; negative if its faces
/// face inwards. Faces are triangulated as in triangles.hpp. Allocates.
NENDO_API double volume_of(const Mesh& mesh);

} // namespace nendo::deform
