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
  /// Then no face is turned.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> one_sided;
  std::vector<std::uint32_t> one_sided_faces; ///< of all such surfaces
};

/// Turns faces so that each faces as its neighbours do, over all edges with two faces. Of faces
/// that hang together the fewer are turned. `place_of` has one entry for each corner, and keeps
/// being right. Allocates.
TurnedAlike turn_alike(Mesh& mesh, std::vector<std::uint32_t>& place_of);

} // namespace nendo::deform
