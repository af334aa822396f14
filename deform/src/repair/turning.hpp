#pragma once
// Which way faces of a broken model face.

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Turns a face round: its corners go the other way, with all that belongs to them. The first
/// corner stays the first.
void turn_face(Mesh& mesh, std::size_t face);

/// What turn_alike() did.
struct TurnedAlike {
  std::size_t turned = 0;
  /// The places of an edge at which a surface comes back to itself turned, as a Möbius strip does.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> one_sided;
};

/// Turns faces so that each faces as its neighbours do, over all edges with two faces. Of faces
/// that hang together the fewer are turned. `place_of` has one entry for each corner, and keeps
/// being right. Allocates.
TurnedAlike turn_alike(Mesh& mesh, std::vector<std::uint32_t>& place_of);

/// Turns parts outwards whose own volume is negative, but not those that lie in another part, which
/// are cavities; what lies in a part that is turned is turned with it. The mesh must be closed.
/// Returns how many faces were turned. Allocates.
std::size_t turn_outwards(Mesh& mesh);

} // namespace nendo::deform
