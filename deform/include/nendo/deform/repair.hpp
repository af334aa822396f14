#pragma once
// Repairs nearly closed models: unmerged vertices, duplicate or flipped faces, holes, and surfaces
// that touch at a vertex or an edge.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

struct RepairOptions {
  /// Max distance of vertices at open edges that are merged, in model units; by default, 1e-5 of
  /// the diagonal of the model's box.
  std::optional<double> tolerance;
};

/// Parts that cannot be closed for the same reason, and are left out of the repaired model.
struct LeftOut {
  std::size_t parts = 0, faces = 0;
  std::string where;  ///< position of a vertex of the first part
  std::string why;    ///< text that follows "it"
  std::string remedy; ///< what to do in the modelling program
};

/// A repaired model, and counts of the repairs.
struct Repair {
  Mesh mesh;
  double tolerance = 0.0;          ///< applied tolerance, model units
  std::size_t joined = 0;          ///< vertices at open edges that were merged into others
  std::size_t dropped = 0;         ///< removed faces: duplicates, or fewer than three corners
  std::size_t repeated = 0;        ///< removed face corners that equalled the previous one
  std::size_t split = 0;           ///< vertices on an edge that were inserted into it
  std::size_t turned = 0;          ///< flipped faces
  std::size_t separated = 0;       ///< added vertices where surfaces only touched
  std::size_t filled = 0;          ///< filled holes
  std::size_t filled_crossing = 0; ///< filled holes whose caps intersect the model
  std::size_t stray = 0;           ///< removed vertices without a face
  std::vector<LeftOut> left_out;   ///< parts that cannot be closed, by reason
  /// True if there were too many open edges to search for vertices on them.
  bool skipped_junctions = false;
};

/// Repairs a model so that check_closed_manifold() finds no fault in it, and each part faces
/// outwards, except cavities: inward-facing parts inside another part. A model that needs no repair
/// is returned bit for bit. Remaining vertices keep their order and bits; new ones come last. A
/// hole is filled with triangles between its corners, with the appearance of an adjacent face.
/// Parts that cannot be closed, such as loose flaps, are left out, unless they have more area than
/// the rest. Allocates, blocks. Error: bad_input, with the remaining fault and its position, to be
/// appended to the model's name.
NENDO_API Result<Repair> repair(const Mesh& mesh, const RepairOptions& options = {});

/// Flips parts of negative volume, except cavities, which are inside another part; parts inside a
/// flipped part are flipped with it. The mesh must be closed. Returns the number of flipped faces.
/// Allocates.
NENDO_API std::size_t turn_outwards(Mesh& mesh);
/// Returns the number of faces that turn_outwards() would flip. Allocates.
NENDO_API std::size_t count_inward_faces(const Mesh& mesh);

/// Describes the repairs, one sentence per kind, to be appended to the model's name: "joined 12
/// vertices with others in the same place". Empty if nothing was repaired.
NENDO_API std::vector<std::string> lines_of(const Repair& repair);

} // namespace nendo::deform
