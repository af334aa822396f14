#pragma once
// Closes models whose files are nearly closed: vertices that should be one, faces that are double
// or turned, holes, and surfaces that touch in a point or at an edge.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

struct RepairOptions {
  /// Vertices at open edges become one if they are no farther apart, in model units. Without it,
  /// 1e-5 of the diagonal of the model's box.
  std::optional<double> tolerance;
};

/// Parts of a model that cannot be closed, for one reason, and are left out of the repaired one.
struct LeftOut {
  std::size_t parts = 0, faces = 0;
  std::string where;  ///< a vertex of the first
  std::string why;    ///< the words follow "it"
  std::string remedy; ///< what to do where the model was made
};

/// A repaired model, and what was done to it.
struct Repair {
  Mesh mesh;
  double tolerance = 0.0;    ///< that was taken, model units
  std::size_t joined = 0;    ///< vertices at open edges that became one with another one
  std::size_t dropped = 0;   ///< faces with fewer than three corners, or that were there before
  std::size_t repeated = 0;  ///< corners of faces that were the same as the one before
  std::size_t split = 0;     ///< vertices that lay in an edge, and became a corner there
  std::size_t turned = 0;    ///< faces
  std::size_t separated = 0; ///< vertices that were added where surfaces only touched
  std::size_t filled = 0;    ///< holes
  std::size_t filled_crossing = 0; ///< filled holes whose lids go through the model
  std::size_t stray = 0;           ///< vertices without a face, which were dropped
  std::vector<LeftOut> left_out;   ///< parts that cannot be closed, by their reasons
  /// There were too many open edges to look for vertices that lie in them.
  bool skipped_junctions = false;
};

/// Repairs a model so that check_closed_manifold() finds no fault in it and each part faces
/// outwards, but those that lie in another one and face inwards: they are cavities. A model that is
/// so already comes back to the bit. Vertices that stay keep their order and their bits; new ones
/// come last. A hole is filled by triangles between its corners that look as the face beside it.
/// Parts that cannot be closed are left out, as a loose flap is, unless they have more surface than
/// the rest. Allocates, blocks. Error: bad_input, with what is still wrong and where; the words go
/// behind the model's name.
NENDO_API Result<Repair> repair(const Mesh& mesh, const RepairOptions& options = {});

/// Turns parts outwards whose own volume is negative, but not those that lie in another part, which
/// are cavities; what lies in a part that is turned is turned with it. The mesh must be closed.
/// Returns how many faces were turned. Allocates.
NENDO_API std::size_t turn_outwards(Mesh& mesh);
/// Returns how many faces turn_outwards() would turn. Allocates.
NENDO_API std::size_t count_inward_faces(const Mesh& mesh);

/// Returns what was done, one sentence for each kind, in words that go behind the model's name:
/// "joined 12 vertices with others in the same place". Empty if there was nothing to do.
NENDO_API std::vector<std::string> lines_of(const Repair& repair);

} // namespace nendo::deform
